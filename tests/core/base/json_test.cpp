// SPDX-License-Identifier: Apache-2.0
/// JSON that is written is JSON that others can read.
#include "core/base/json.h"

#include <gtest/gtest.h>

#include <limits>

namespace lucerna {
namespace {

TEST(Json, values) {
    EXPECT_EQ(Json().text(), "null\n");
    EXPECT_EQ(Json(true).text(), "true\n");
    EXPECT_EQ(Json(0.1).text(), "0.1\n");
    EXPECT_EQ(Json(-3).text(), "-3\n");
    EXPECT_EQ(Json(std::numeric_limits<std::uint64_t>::max()).text(), "18446744073709551615\n");
    EXPECT_EQ(Json(std::numeric_limits<std::int64_t>::min()).text(), "-9223372036854775808\n");
    EXPECT_EQ(Json("a \"b\"\n").text(), "\"a \\\"b\\\"\\n\"\n");
    EXPECT_EQ(Json(std::optional<double>()).text(), "null\n");
}

TEST(Json, numbers_that_it_cannot_hold_are_null) {
    EXPECT_EQ(Json(std::numeric_limits<double>::quiet_NaN()).text(), "null\n");
    EXPECT_EQ(Json(std::numeric_limits<double>::infinity()).text(), "null\n");
}

TEST(Json, text_that_is_not_utf8_does_not_lose_the_rest) {
    EXPECT_NE(Json("a\xff").text().find('a'), std::string::npos);
}

TEST(Json, objects_keep_their_order) {
    Json json = Json::object();
    json.set("z", 1).set("a", std::vector<std::string>{"x", "y"});
    const Json copy = json;
    json.set("later", true);
    EXPECT_EQ(copy.text(), "{\n  \"z\": 1,\n  \"a\": [\n    \"x\",\n    \"y\"\n  ]\n}\n");
}

}  // namespace
}  // namespace lucerna
