// SPDX-License-Identifier: Apache-2.0
#include "core/base/file_bytes.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>
#include <set>

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

TEST(FileBytes, HashTellsContentsAndSizesApart) {
    const TemporaryFolder folder;
    const auto hash = [&](const std::string& content) {
        std::ofstream(folder / "data", std::ios::binary) << content;
        return hash_of_file(folder / "data");
    };
    EXPECT_EQ(hash("a mesh"), hash("a mesh"));
    // Zeros at the end, blocks of which the last is not full, and every single byte count.
    std::set<std::uint64_t> hashes;
    std::size_t count = 0;
    for (const std::size_t size :
         {0u, 1u, 2u, 31u, 32u, 33u, (1u << 18) - 1, 1u << 18, (1u << 18) + 1}) {
        hashes.insert(hash(std::string(size, '\0')));
        ++count;
    }
    for (std::size_t i = 0; i < 80; ++i) {
        std::string content(80, 'x');
        content[i] = 'y';
        hashes.insert(hash(content));
        ++count;
    }
    EXPECT_EQ(hashes.size(), count);
    EXPECT_NE(file_error([&] { hash_of_file(folder / "missing"); }).find("no such file"),
              std::string::npos);
}

}  // namespace
}  // namespace lucerna
