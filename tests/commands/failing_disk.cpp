// SPDX-License-Identifier: Apache-2.0
/// A disk that fails: preloaded (LD_PRELOAD), it lets calls of the system fail as they do on a full
/// disk or on a network file system whose server has forgotten a file.
///
/// $LUCERNA_FAILING says which: "CALL ERRNO WORD", for files with WORD in their path. CALL is one
/// of stat, open (for reading), pread, write and fsync.
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <climits>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

namespace {

/// The function of the C library that is replaced here.
template <typename Function>
Function* original(const char* name, Function*) {
    return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

/// Sets errno if the call is to fail.
bool fails(const char* call, const char* path) {
    const char* const rule = std::getenv("LUCERNA_FAILING");
    std::array<char, 16> which{};
    std::array<char, 64> word{};
    int error = 0;
    if (!rule || std::sscanf(rule, "%15s %d %63s", which.data(), &error, word.data()) != 3) {
        return false;
    }
    if (std::strcmp(which.data(), call) != 0 || !std::strstr(path, word.data())) return false;
    errno = error;
    return true;
}

bool fails(const char* call, int descriptor) {
    const std::string link = "/proc/self/fd/" + std::to_string(descriptor);
    std::array<char, PATH_MAX> path{};
    return readlink(link.c_str(), path.data(), path.size() - 1) > 0 && fails(call, path.data());
}

}  // namespace

#pragma GCC visibility push(default)
extern "C" {

int stat(const char* path, struct stat* status) {
    return fails("stat", path) ? -1 : original("stat", stat)(path, status);
}

int open(const char* path, int flags, ...) {
    va_list arguments;
    va_start(arguments, flags);
    const mode_t mode = flags & O_CREAT ? va_arg(arguments, mode_t) : 0;
    va_end(arguments);
    if ((flags & O_ACCMODE) == O_RDONLY && fails("open", path)) return -1;
    return original("open", open)(path, flags, mode);
}

ssize_t pread(int descriptor, void* bytes, size_t count, off_t offset) {
    if (fails("pread", descriptor)) return -1;
    return original("pread", pread)(descriptor, bytes, count, offset);
}

ssize_t write(int descriptor, const void* bytes, size_t count) {
    return fails("write", descriptor) ? -1 : original("write", write)(descriptor, bytes, count);
}

int fsync(int descriptor) {
    return fails("fsync", descriptor) ? -1 : original("fsync", fsync)(descriptor);
}

}  // extern "C"
#pragma GCC visibility pop
