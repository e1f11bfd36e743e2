// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"

#include <gtest/gtest.h>

namespace lucerna {
namespace {

std::string message_of(const std::string& message) {
    Diagnostics diagnostics;
    diagnostics.error({}, message);
    return diagnostics.all().at(0).message;
}

TEST(Diagnostics, LongLinesLoseTheirMiddle) {
    const std::string name(100'000'000, 'x');
    EXPECT_EQ(message_of("there is no \"" + name + "\";\n  there are: a, b"),
              "there is no \"" + std::string(287, 'x') + " ... " + std::string(598, 'x') +
                  "\";\n  there are: a, b");
    const std::string line(1000, 'y');
    EXPECT_EQ(message_of(line + "\n" + line), line + "\n" + line);
    EXPECT_EQ(message_of("a\n\nb\n"), "a\n\nb\n");
}

TEST(Diagnostics, CharactersAreNotCut) {
    std::string text;
    for (int i = 0; i < 600; ++i) text += "\u00e4";
    for (const char* before : {"", "a"}) {
        const std::string message = message_of(before + text);
        const std::size_t gap = message.find(" ... ");
        ASSERT_NE(gap, std::string::npos);
        EXPECT_EQ(message[gap - 1], '\xa4');
        EXPECT_EQ(message[gap + 5], '\xc3');
    }
    EXPECT_EQ(quote("a" + text), "\"a" + text.substr(0, 58) + "...\"");
}

TEST(Diagnostics, LinesOfHiddenFilesAreNotShown) {
    SourceFile file{"notes.txt", "one\nsecret", false};
    Diagnostics diagnostics;
    diagnostics.error({&file, 6}, "wrong");
    EXPECT_EQ(diagnostics.all().at(0).text(), "notes.txt:2:3: error: wrong");
    file.is_shown = true;
    diagnostics.error({&file, 6}, "wrong");
    EXPECT_EQ(diagnostics.all().at(1).text(), "notes.txt:2:3: error: wrong\n  secret\n    ^");
}

TEST(DidYouMean, VeryLongWordsAreComparedWithNothing) {
    EXPECT_EQ(nearest("spher", {"sphere"}), "sphere");
    EXPECT_EQ(nearest(std::string(10'000'000, 'x'), {"sphere"}), "");
}

}  // namespace
}  // namespace lucerna
