// SPDX-License-Identifier: Apache-2.0
#include "core/image/file_bytes.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>

#include "tests/core/image/damage.h"
#include "tests/paths.h"

namespace lucerna {
namespace {

TEST(FileBytes, ReadsEveryByte) {
    const TemporaryFolder folder;
    const std::string content("a\0\r\n\xff", 5);
    std::ofstream(folder / "data", std::ios::binary) << content;
    EXPECT_EQ(read_file_bytes(folder / "data"), bytes_of(content));
    std::ofstream(folder / "empty");
    EXPECT_TRUE(read_file_bytes(folder / "empty").empty());
}

TEST(FileBytes, SaysWhatIsInPlaceOfTheFile) {
    const TemporaryFolder folder;
    const auto message = [](const std::filesystem::path& path) {
        return file_error([&] { read_file_bytes(path); });
    };
    EXPECT_NE(message(folder / "missing").find("no such file"), std::string::npos);
    EXPECT_NE(message(folder.path()).find("is a directory"), std::string::npos);
    EXPECT_NE(message("/dev/zero").find("pipe or a device"), std::string::npos);
    // Would wait for ever if it were opened.
    ASSERT_EQ(mkfifo((folder / "pipe").c_str(), 0600), 0);
    EXPECT_NE(message(folder / "pipe").find("pipe or a device"), std::string::npos);
}

}  // namespace
}  // namespace lucerna
