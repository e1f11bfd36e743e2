// SPDX-License-Identifier: Apache-2.0
#include "core/base/atomic_file.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <sstream>

#include "tests/core/image/damage.h"
#include "tests/paths.h"

namespace lucerna {
namespace {

namespace fs = std::filesystem;

std::string content_of(const fs::path& path) {
    std::ostringstream text;
    text << std::ifstream(path, std::ios::binary).rdbuf();
    return text.str();
}

int count_files(const TemporaryFolder& folder) {
    int count = 0;
    for ([[maybe_unused]] const auto& entry : fs::directory_iterator(folder.path())) ++count;
    return count;
}

TEST(AtomicFile, CreatesAndReplaces) {
    const TemporaryFolder folder;
    write_file_atomically(folder / "a", "old");
    EXPECT_EQ(content_of(folder / "a"), "old");
    const std::string longer(1 << 20, 'x');
    write_file_atomically(folder / "a", longer);
    EXPECT_EQ(content_of(folder / "a"), longer);
    write_file_atomically(folder / "a", "");
    EXPECT_EQ(content_of(folder / "a"), "");
    EXPECT_EQ(count_files(folder), 1);
}

TEST(AtomicFile, KeepsPermissions) {
    const TemporaryFolder folder;
    write_file_atomically(folder / "a", "old");
    fs::permissions(folder / "a", fs::perms(0640));
    write_file_atomically(folder / "a", "new");
    EXPECT_EQ(fs::status(folder / "a").permissions(), fs::perms(0640));
}

TEST(AtomicFile, FollowsLinks) {
    const TemporaryFolder folder;
    fs::create_directory(folder / "elsewhere");
    fs::create_symlink("elsewhere/target", folder / "link");
    write_file_atomically(folder / "link", "through a link that led nowhere");
    EXPECT_TRUE(fs::is_symlink(folder / "link"));
    EXPECT_EQ(content_of(folder / "elsewhere/target"), "through a link that led nowhere");
    write_file_atomically(folder / "link", "again");
    EXPECT_TRUE(fs::is_symlink(folder / "link"));
    EXPECT_EQ(content_of(folder / "elsewhere/target"), "again");
}

TEST(AtomicFile, DevicesAreWrittenDirectly) {
    EXPECT_NO_THROW(write_file_atomically("/dev/null", "nothing"));
    EXPECT_TRUE(fs::is_character_file("/dev/null"));
    const std::string full = file_error([] { write_file_atomically("/dev/full", "8 x 8"); });
    EXPECT_NE(full.find("No space left on device"), std::string::npos) << full;
    EXPECT_NE(full.find("free some space"), std::string::npos) << full;
}

TEST(AtomicFile, SaysWhatToDo) {
    const TemporaryFolder folder;
    const auto message = [](const fs::path& path) {
        const std::string check = file_error([&] { check_writable(path); });
        EXPECT_EQ(check.substr(0, 20),
                  file_error([&] { write_file_atomically(path, "x"); }).substr(0, 20));
        return check;
    };
    EXPECT_NE(message(folder / "no/such/a").find("create the directory"), std::string::npos);
    EXPECT_NE(message(folder.path()).find("is a directory"), std::string::npos);
    EXPECT_NE(message("").find("empty"), std::string::npos);
    EXPECT_NE(message(folder / std::string(300, 'n')).find("shorter name"), std::string::npos);
    EXPECT_EQ(count_files(folder), 0);
}

TEST(AtomicFile, CheckLeavesNothingBehind) {
    const TemporaryFolder folder;
    check_writable(folder / "new");
    EXPECT_EQ(count_files(folder), 0);
    write_file_atomically(folder / "old", "content");
    check_writable(folder / "old");
    EXPECT_EQ(content_of(folder / "old"), "content");
    EXPECT_EQ(count_files(folder), 1);
    EXPECT_NO_THROW(check_writable("/dev/null"));
}

/// Runs `action` in a child process and returns its exit status.
template <typename F>
int in_child(const F& action) {
    const pid_t child = fork();
    if (child == 0) _exit(action());
    int status = 0;
    waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(AtomicFile, OldFileSurvivesAFullDisk) {
    const TemporaryFolder folder;
    write_file_atomically(folder / "a", "old");
    const int status = in_child([&] {
        std::signal(SIGXFSZ, SIG_IGN);
        const rlimit limit{1 << 16, 1 << 16};
        setrlimit(RLIMIT_FSIZE, &limit);
        try {
            write_file_atomically(folder / "a", std::string(1 << 18, 'x'));
        } catch (const FileError& error) {
            return std::string_view(error.what()).find("ulimit -f") == std::string::npos ? 2 : 0;
        }
        return 1;
    });
    EXPECT_EQ(status, 0);
    EXPECT_EQ(content_of(folder / "a"), "old");
    EXPECT_EQ(count_files(folder), 1);
}

TEST(AtomicFile, RemovesWhatKilledWritersLeft) {
    const TemporaryFolder folder;
    const auto make = [&](const char* name, std::chrono::seconds age) {
        std::ofstream(folder / name) << "a part";
        fs::last_write_time(folder / name, fs::file_time_type::clock::now() - age);
    };
    using std::chrono::seconds;
    make(".lucerna-1-0.tmp", seconds(120));
    make(".lucerna-2-0.tmp", seconds(120));
    make(".lucerna-3-0.tmp", seconds(0));
    make("lucerna-4-0.tmp", seconds(120));
    const int locked = open((folder / ".lucerna-2-0.tmp").c_str(), O_RDWR | O_CLOEXEC);
    ASSERT_EQ(flock(locked, LOCK_EX), 0);  // as by a writer that is still there
    write_file_atomically(folder / "a", "new");
    close(locked);
    EXPECT_FALSE(fs::exists(folder / ".lucerna-1-0.tmp"));
    EXPECT_TRUE(fs::exists(folder / ".lucerna-2-0.tmp"));
    EXPECT_TRUE(fs::exists(folder / ".lucerna-3-0.tmp"));
    EXPECT_TRUE(fs::exists(folder / "lucerna-4-0.tmp"));
    EXPECT_EQ(content_of(folder / "a"), "new");
}

TEST(AtomicFile, KilledAtAnyTimeLeavesAWholeFile) {
    const TemporaryFolder folder;
    const std::string a(300000, 'a'), b(200000, 'b');
    write_file_atomically(folder / "f", a);
    int other_content = 0;
    for (int i = 0; i < 40; ++i) {
        const std::string before = content_of(folder / "f");
        const pid_t child = fork();
        if (child == 0) {
            for (bool first = before[0] == 'b';; first = !first) {
                write_file_atomically(folder / "f", first ? a : b);
            }
        }
        usleep(static_cast<useconds_t>(500 + 397 * i));
        kill(child, SIGKILL);
        waitpid(child, nullptr, 0);
        const std::string after = content_of(folder / "f");
        ASSERT_TRUE(after == a || after == b) << after.size() << " bytes";
        other_content += after != before ? 1 : 0;
    }
    EXPECT_GT(other_content, 0) << "no child ever wrote: nothing was tested";
}

}  // namespace
}  // namespace lucerna
