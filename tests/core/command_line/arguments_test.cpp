// SPDX-License-Identifier: Apache-2.0
/// Command lines: values, ranges, and messages for what is wrong.
#include "core/command_line/arguments.h"

#include "core/interfaces/command.h"

#include <gtest/gtest.h>

namespace lucerna {
namespace {

/// A command with an argument of each kind.
class ArgumentsTest : public testing::Test {
protected:
    std::optional<int> parse(const std::vector<std::string>& words) {
        Arguments arguments("try", "Tries all kinds of arguments.");
        arguments.positional("SCENE", scene, "a scene");
        arguments.option("-o,--output", "FILE", output, "where to");
        arguments.option("-D,--define", "NAME=VALUE", defines, "values");
        arguments.option("--set", "PATH=VALUE", sets, "changes");
        arguments.option("--exposure", "EV", exposure, any_value, "brightness");
        arguments.option("--time", "SECONDS", time, positive, "limit");
        arguments.option("--seed", "N", seed, non_negative, "noise");
        arguments.option("--threads", "N", threads, {.min = 0, .max = 4096}, "threads");
        arguments.option("--resolution", "WxH", resolution, 'x', 2, {.min = 1}, "size");
        arguments.flag("-q,--quiet", quiet, "no words");
        testing::internal::CaptureStderr();
        testing::internal::CaptureStdout();
        const std::optional<int> code = arguments.parse(words);
        errors = testing::internal::GetCapturedStderr();
        std::fflush(stdout);
        printed = testing::internal::GetCapturedStdout();
        return code;
    }

    void expect_usage_error(const std::vector<std::string>& words, const std::string& message) {
        EXPECT_EQ(parse(words), exit_code::usage);
        EXPECT_NE(errors.find(message), std::string::npos) << errors;
        EXPECT_EQ(printed, "");
    }

    std::string scene, output, errors, printed;
    std::vector<std::pair<std::string, std::string>> defines;
    std::vector<std::string> sets;
    std::vector<int> resolution;
    double exposure = 0;
    std::optional<double> time;
    std::uint64_t seed = 0;
    int threads = 0;
    bool quiet = false;
};

TEST_F(ArgumentsTest, fill_values) {
    EXPECT_EQ(parse({"--set", "a.b=1", "scene.xml", "-D", "x=1", "--set", "c=a=b", "-Dy=", "-q",
                     "--exposure", "-1.5", "--time=1e3", "--resolution", "640x480", "--seed", "7"}),
              std::nullopt);
    EXPECT_EQ(scene, "scene.xml");
    EXPECT_EQ(sets, (std::vector<std::string>{"a.b=1", "c=a=b"}));
    ASSERT_EQ(defines.size(), 2u);
    EXPECT_EQ(defines[0], std::pair(std::string("x"), std::string("1")));
    EXPECT_EQ(defines[1], std::pair(std::string("y"), std::string()));
    EXPECT_EQ(exposure, -1.5);
    EXPECT_EQ(*time, 1000);
    EXPECT_EQ(resolution, (std::vector<int>{640, 480}));
    EXPECT_EQ(seed, 7u);
    EXPECT_TRUE(quiet);
}

TEST_F(ArgumentsTest, leave_what_is_not_given) {
    EXPECT_EQ(parse({"scene.xml"}), std::nullopt);
    EXPECT_FALSE(time);
    EXPECT_TRUE(output.empty() && defines.empty() && resolution.empty() && !quiet);
}

TEST_F(ArgumentsTest, help_lists_everything_within_the_width) {
    EXPECT_EQ(parse({"--help"}), exit_code::success);
    for (const char* word : {"SCENE", "--output FILE", "--resolution WxH", "-q,--quiet"}) {
        EXPECT_NE(printed.find(word), std::string::npos) << word;
    }
    EXPECT_EQ(errors, "");
}

TEST_F(ArgumentsTest, unknown_options_are_answered) {
    expect_usage_error({"scene.xml", "--tiem", "3"}, "did you mean \"--time\"?");
    expect_usage_error({"scene.xml", "other.xml"}, "unexpected argument \"other.xml\"");
}

TEST_F(ArgumentsTest, wrong_values_are_usage_errors) {
    expect_usage_error({}, "SCENE is required");
    expect_usage_error({"s", "--time", "0"}, "--time: 0 is not in the range > 0");
    expect_usage_error({"s", "--time", "nan"}, "--time");
    expect_usage_error({"s", "--time", "1,5"}, "--time");
    expect_usage_error({"s", "--time"}, "--time");
    expect_usage_error({"s", "--seed", "-1"}, "--seed: -1 is negative");
    expect_usage_error({"s", "--seed", "1.5"}, "--seed");
    expect_usage_error({"s", "--seed", "1", "--seed", "2"}, "--seed: given more than once");
    expect_usage_error({"s", "--threads", "99999999999"}, "--threads");
    expect_usage_error({"s", "--resolution", "640"}, "--resolution");
    expect_usage_error({"s", "--resolution", "640x480x3"}, "--resolution");
    expect_usage_error({"s", "--resolution", "640x0"}, "--resolution");
    expect_usage_error({"s", "-D", "x"}, "expected NAME=VALUE, not \"x\"");
    expect_usage_error({"s", "-D", "=1"}, "expected NAME=VALUE");
}

TEST(ShellText, a_shell_reads_the_same_words_again) {
    EXPECT_EQ(shell_text("render", {"a.xml", "--set", "x.y=1"}),
              "lucerna render a.xml --set x.y=1");
    EXPECT_EQ(shell_text("render", {"it's", "", "a b", "$x"}),
              "lucerna render 'it'\\''s' '' 'a b' '$x'");
}

}  // namespace
}  // namespace lucerna
