// SPDX-License-Identifier: Apache-2.0
#include "core/base/atomic_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <ctime>
#include <string>
#include <system_error>
#include <utility>

#include "core/base/error.h"
#include "core/base/system_error.h"

namespace lucerna {

namespace {

namespace fs = std::filesystem;

std::string remedy(int error) {
    switch (error) {
        case ENOSPC:
        case EDQUOT:
            return "free some space, or write to another disk";
        case EFBIG:
            return "raise the limit on the size of files (ulimit -f)";
        case EACCES:
        case EPERM:
        case EROFS:
            return "write to a place where you may write";
        case ENOENT:
        case ENOTDIR:
            return "create the directory first";
        case ENAMETOOLONG:
            return "choose a shorter name";
        default:
            return "try again, or write to another place";
    }
}

[[noreturn]] void fail(const fs::path& path, std::string_view doing, int error) {
    const std::string message = fmt::format("{}: {} failed: {}; {}", path.string(), doing,
                                            std::generic_category().message(error), remedy(error));
    if (may_pass(error)) throw TransientFileError(message);
    throw FileError(message);
}

constexpr std::string_view temporary_prefix = ".lucerna-", temporary_suffix = ".tmp";

/// Removes a temporary file of a writer that was killed. Writers hold a lock until the file has its
/// name; a new file may not have its lock yet. What cannot be locked stays.
void remove_if_abandoned(const fs::path& path) {
    constexpr std::time_t age = 60;  // [s]
    const int descriptor = ::open(path.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW);
    if (descriptor < 0) return;
    struct stat status {};
    if (::fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode) &&
        status.st_mtime + age < std::time(nullptr) && ::flock(descriptor, LOCK_EX | LOCK_NB) == 0) {
        ::unlink(path.c_str());
    }
    ::close(descriptor);
}

void remove_abandoned_files(const fs::path& directory) {
    std::error_code code;
    for (fs::directory_iterator entry(directory, code), end; !code && entry != end;
         entry.increment(code)) {
        const std::string name = entry->path().filename().string();
        if (name.starts_with(temporary_prefix) && name.ends_with(temporary_suffix)) {
            remove_if_abandoned(entry->path());
        }
    }
}

/// Closes and, unless kept, removes the file when something throws.
class TemporaryFile {
public:
    /// Creates a file of a new name beside `target`, which errors speak of.
    explicit TemporaryFile(const fs::path& target) : target_(target) {
        static std::atomic<unsigned> counter{0};
        const fs::path directory = target.has_parent_path() ? target.parent_path() : ".";
        remove_abandoned_files(directory);
        do {
            path_ = directory / fmt::format("{}{}-{}{}", temporary_prefix, ::getpid(), counter++,
                                            temporary_suffix);
            descriptor_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        } while (descriptor_ < 0 && errno == EEXIST);
        if (descriptor_ < 0) fail(target_, "creating a file in its directory", errno);
        lock_ = ::fcntl(descriptor_, F_DUPFD_CLOEXEC, 0);
        if (lock_ >= 0) ::flock(lock_, LOCK_EX | LOCK_NB);
    }
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;
    ~TemporaryFile() {
        if (descriptor_ >= 0) ::close(descriptor_);
        if (!path_.empty()) ::unlink(path_.c_str());
        if (lock_ >= 0) ::close(lock_);
    }

    int descriptor() const { return descriptor_; }

    void close() {
        const int result = ::close(std::exchange(descriptor_, -1));
        if (result != 0) fail(target_, "closing", errno);
    }

    /// What is on the disk, not what was handed over.
    void verify_size(std::size_t size) const {
        struct stat status {};
        if (::stat(path_.c_str(), &status) != 0) fail(target_, "verifying", errno);
        if (static_cast<std::size_t>(status.st_size) != size) {
            throw TransientFileError(fmt::format("{}: {} of {} bytes arrived on the disk; {}",
                                                 target_.string(), status.st_size, size,
                                                 remedy(ENOSPC)));
        }
    }

    void rename_to_target() {
        if (::rename(path_.c_str(), target_.c_str()) != 0) fail(target_, "renaming to it", errno);
        path_.clear();
    }

private:
    fs::path target_, path_;
    int descriptor_ = -1;
    int lock_ = -1;  ///< keeps the lock when descriptor_ is closed; -1: none
};

void write_all(const fs::path& path, int descriptor, std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) fail(path, "writing", written < 0 ? errno : ENOSPC);
        bytes.remove_prefix(static_cast<std::size_t>(written));
    }
}

/// Makes a rename in this directory survive a power cut. Some file systems cannot, and need not.
void sync_directory(const fs::path& path) {
    const fs::path directory = path.has_parent_path() ? path.parent_path() : ".";
    const int descriptor = ::open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor < 0) return;
    const int result = ::fsync(descriptor);
    const int error = errno;
    ::close(descriptor);
    if (result != 0 && error != EINVAL && error != EROFS)
        fail(path, "syncing its directory", error);
}

/// Devices and pipes have no old content to protect, and cannot be renamed over.
void write_directly(const fs::path& path, std::string_view bytes) {
    const int descriptor = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
    if (descriptor < 0) fail(path, "opening", errno);
    try {
        write_all(path, descriptor, bytes);
    } catch (...) {
        ::close(descriptor);
        throw;
    }
    if (::close(descriptor) != 0) fail(path, "closing", errno);
}

enum class Target { nothing, regular, special };

/// What `path` names after following links; throws for a directory.
Target classify(const fs::path& path, mode_t& mode) {
    struct stat status {};
    if (::stat(path.c_str(), &status) != 0) {
        if (errno != ENOENT) fail(path, "looking at it", errno);
        return Target::nothing;
    }
    if (S_ISDIR(status.st_mode)) {
        throw FileError(fmt::format("{}: is a directory; name a file in it", path.string()));
    }
    mode = status.st_mode & 07777;
    return S_ISREG(status.st_mode) ? Target::regular : Target::special;
}

/// The file a link stands for, so that the link survives; also where it leads nowhere yet.
fs::path follow_links(const fs::path& path) {
    std::error_code code;
    const fs::path real = fs::weakly_canonical(path, code);
    if (code || !fs::is_symlink(fs::symlink_status(real, code))) return code ? path : real;
    const fs::path next = fs::read_symlink(real, code);
    return code ? real : real.parent_path() / next;
}

}  // namespace

void write_file_atomically(const fs::path& path, std::string_view bytes) {
    if (path.empty()) throw FileError("the name of the file to be written is empty");
    mode_t mode = 0;
    const Target kind = classify(path, mode);
    if (kind == Target::special) return write_directly(path, bytes);

    const fs::path target = follow_links(path);
    TemporaryFile file(target);
    write_all(target, file.descriptor(), bytes);
    if (kind == Target::regular && ::fchmod(file.descriptor(), mode) != 0 && errno != EPERM) {
        fail(target, "keeping its permissions", errno);
    }
    if (::fsync(file.descriptor()) != 0) fail(target, "writing it to the disk", errno);
    file.close();
    file.verify_size(bytes.size());
    file.rename_to_target();
    sync_directory(target);
}

void check_writable(const fs::path& path) {
    if (path.empty()) throw FileError("the name of the file to be written is empty");
    mode_t mode = 0;
    const Target kind = classify(path, mode);
    if (kind != Target::nothing && ::access(path.c_str(), W_OK) != 0) {
        fail(path, "opening it for writing", errno);
    }
    if (kind == Target::special) return;
    const fs::path target = follow_links(path);
    const TemporaryFile probe(target);
}

}  // namespace lucerna
