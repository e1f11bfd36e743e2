// SPDX-License-Identifier: Apache-2.0
/// `lucerna compare` as users run it: figures, files, reference, and what it refuses.
#include "core/interfaces/command.h"
#include "plugins/commands/compare/bias.h"
#include "plugins/commands/compare/picture_text.h"
#include "plugins/commands/compare/statistics.h"
#include "tests/commands/process.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <random>

namespace lucerna {
namespace {

namespace fs = std::filesystem;
using Report = nlohmann::json;

class CompareCommandTest : public testing::Test {
protected:
    /// Runs `lucerna compare` on a tiny Cornell box, checks the exit code, returns what it printed.
    std::string compare(std::vector<std::string> words, int expected = exit_code::success) {
        const fs::path scene = tests_folder().parent_path() / "scenes/cornell-box/scene.xml";
        words.insert(words.begin(), {"compare", scene.string()});
        Process process(folder.path(), words);
        EXPECT_EQ(process.wait(), expected) << process.errors();
        errors = process.errors();
        return process.output();
    }
    void refuses(std::vector<std::string> words, const std::string& message,
                 int expected = exit_code::usage) {
        words.insert(words.end(), {"-o", "refused", "--resolution", "16x16"});
        compare(words, expected);
        EXPECT_NE(errors.find(message), std::string::npos) << errors;
        EXPECT_FALSE(fs::exists(folder / "refused/report.json"));
    }
    Report report() const { return Report::parse(read_whole(folder / "out/report.json")); }

    TemporaryFolder folder;
    std::string errors;
    const std::vector<std::string> twins = {
        "--vary",       "integrator.light_sampler=uniform,uniform,power",
        "--spp",        "4",
        "--repeats",    "4",
        "--seed",       "1",
        "--resolution", "24x20",
        "-o",           "out"};
};

/// Every number is finite: JSON has null for others.
void expect_no_null(const Report& json, const std::string& path) {
    if (path == "/budget") return;
    EXPECT_FALSE(json.is_null()) << path;
    if (!json.is_structured()) return;
    for (const auto& [key, value] : json.items()) expect_no_null(value, path + "/" + key);
}

TEST_F(CompareCommandTest, MeasuresAndReports) {
    const std::string text = compare(twins);
    EXPECT_NE(text.find("uniform (2)"), std::string::npos) << text;
    EXPECT_NE(text.find("out/index.html"), std::string::npos) << text;

    const Report json = report();
    EXPECT_EQ(json["schema"], 1);
    expect_no_null(json, "");
    ASSERT_EQ(json["variants"].size(), 3);
    EXPECT_EQ(json["reference"]["samples_per_pixel"], 256);
    std::vector<std::string> seeds;
    for (const Report& variant : json["variants"]) {
        const Report& error = variant["relative_mse"];
        EXPECT_GT(error["value"], 0);
        EXPECT_LT(error["low"], error["value"]);
        EXPECT_GT(error["high"], error["value"]);
        EXPECT_FALSE(variant["bias"]["biased"]) << variant["bias"];
        ASSERT_EQ(variant["runs"].size(), 4);
        for (const Report& run : variant["runs"]) {
            seeds.push_back(run["seed"]);
            EXPECT_EQ(run["samples_per_pixel"], 4);
            EXPECT_EQ(run["curve"].size(), 3);  // 1, 2 and 4 samples
            EXPECT_GT(run["render_seconds"], 0);
            EXPECT_LT(run["relative_mse"], run["measured_relative_mse"]);
        }
    }
    std::sort(seeds.begin(), seeds.end());
    EXPECT_EQ(std::unique(seeds.begin(), seeds.end()), seeds.end());

    const std::string csv = read_whole(folder / "out/results.csv");
    EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 13);
    const std::string page = read_whole(folder / "out/index.html");
    EXPECT_NE(page.find("id=\"picture-3\""), std::string::npos);
    EXPECT_EQ(page.find("src=\"http"), std::string::npos);
    EXPECT_EQ(page.find("<!-- data -->"), std::string::npos);
}

/// Errors are functions of the seeds, so this compares errors, not times.
TEST_F(CompareCommandTest, TwinsAreEquallyGood) {
    compare(twins);
    const Report json = report();
    const Report &a = json["variants"][0], &b = json["variants"][1];
    std::vector<double> errors_a, errors_b;
    for (const Report& run : a["runs"]) errors_a.push_back(run["relative_mse"]);
    for (const Report& run : b["runs"]) errors_b.push_back(run["relative_mse"]);
    const Interval ratio = ratio_of_means(errors_a, errors_b);
    EXPECT_LT(ratio.low, 1);
    EXPECT_GT(ratio.high, 1);
    EXPECT_GT(ratio.low, 0.1);
    EXPECT_LT(ratio.high, 10);
    EXPECT_EQ(a["efficiency"]["value"], 1);
    EXPECT_LT(b["efficiency"]["low"], b["efficiency"]["high"]);
}

TEST_F(CompareCommandTest, OracleJudgesTheLightSamplers) {
    std::vector<std::string> words = twins;
    words.insert(words.end(), {"--oracle", "--oracle-points", "30"});
    const std::string text = compare(words);
    EXPECT_NE(text.find(" points seen by the camera"), std::string::npos) << text;
    const Report json = report();
    expect_no_null(json, "");
    ASSERT_EQ(json["oracle"]["sections"].size(), 2);
    for (const Report& section : json["oracle"]["sections"]) {
        EXPECT_GT(section["bound"]["mean"], 0);
        ASSERT_EQ(section["variants"].size(), 3);
        const Report& variants = section["variants"];
        EXPECT_EQ(variants[0]["mean"], variants[1]["mean"]);  // twins
        for (const Report& variant : variants) {
            EXPECT_GE(variant["mean"], 0.999999 * section["bound"]["mean"].get<double>());
            EXPECT_EQ(variant["blind_points"], 0);
        }
    }
    refuses({"--vary", "integrator.max_depth=1,2", "--spp", "1", "--oracle"},
            "--oracle judges light samplers in one scene; integrator.max_depth cannot be varied");
}

TEST_F(CompareCommandTest, TellsHowManyShadowRaysWereBlocked) {
    compare(twins);
    for (const Report& variant : report()["variants"]) {
        EXPECT_GT(variant["visible"], 0);
        EXPECT_LT(variant["visible"], 1);
        for (const Report& run : variant["runs"]) {
            EXPECT_GT(run["blocked"], 0);
            EXPECT_LT(run["blocked"], run["occlusions"]);
        }
    }
}

TEST_F(CompareCommandTest, ReferenceIsKeptRefinedAndRefused) {
    compare(twins);
    const std::string kept = read_whole(folder / "out/reference.exr");
    const Report first = report();
    compare(twins);
    EXPECT_EQ(errors.find("the reference"), std::string::npos) << errors;
    EXPECT_EQ(read_whole(folder / "out/reference.exr"), kept);
    const auto error = [](const Report& json) { return json["variants"][2]["relative_mse"]; };
    EXPECT_EQ(error(report()), error(first));  // also with other numbers of threads

    std::vector<std::string> more = twins;
    more.insert(more.end(), {"--reference-spp", "300"});
    compare(more);
    EXPECT_NE(errors.find("refining the reference"), std::string::npos) << errors;
    EXPECT_EQ(report()["reference"]["samples_per_pixel"], 300);

    std::vector<std::string> other = twins;
    other.insert(other.end(), {"--set", "integrator.max_depth=3"});
    compare(other);
    EXPECT_NE(errors.find("rendering the reference"), std::string::npos) << errors;
}

TEST_F(CompareCommandTest, FindsBias) {
    compare({"--vary", "integrator.max_depth=8,2", "--spp", "8", "--repeats", "4", "--resolution",
             "24x20", "-o", "out"});
    const Report json = report();
    EXPECT_FALSE(json["variants"][0]["bias"]["biased"]) << json["variants"][0]["bias"];
    EXPECT_TRUE(json["variants"][1]["bias"]["biased"]) << json["variants"][1]["bias"];
    EXPECT_LT(json["variants"][1]["bias"]["brightness"]["high"], 0);
}

TEST_F(CompareCommandTest, TakesAReferenceFromAFile) {
    compare(twins);
    fs::rename(folder / "out/reference.exr", folder / "known.exr");
    std::vector<std::string> words = twins;
    words.insert(words.end(), {"--reference", "known.exr"});
    compare(words);
    EXPECT_TRUE(report()["reference"]["noise_known"]);
    words[9] = "32x20";
    compare(words, exit_code::failure);
    EXPECT_NE(errors.find("24 x 20"), std::string::npos) << errors;
}

TEST_F(CompareCommandTest, VariesTwoThings) {
    compare({"--vary", "integrator.light_sampler=uniform,power", "--vary",
             "integrator.max_depth=2,3", "--spp", "1", "--repeats", "2", "--resolution", "16x16",
             "-o", "out", "--quiet"});
    const Report json = report();
    ASSERT_EQ(json["variants"].size(), 4);
    EXPECT_EQ(json["variants"][2]["name"], "light_sampler=power, max_depth=2");
}

TEST_F(CompareCommandTest, RefusesNonsense) {
    const std::string vary = "integrator.light_sampler=uniform,power";
    refuses({"--spp", "1"}, "nothing is varied");
    refuses({"--spp", "1", "--vary", "integrator.light_sampler=power"}, "only one variant");
    refuses({"--spp", "1", "--vary", "integrator.light_sampler=power,"}, "empty value");
    refuses({"--spp", "1", "--vary", vary, "--vary", vary}, "given twice");
    refuses({"--spp", "1", "--vary", vary, "--set", "integrator.light_sampler=all"}, "also --set");
    refuses({"--vary", vary}, "one of --time, --spp and --error");
    refuses({"--vary", vary, "--spp", "1", "--time", "1"}, "one of --time, --spp and --error");
    refuses({"--vary", vary, "--spp", "1", "--repeats", "1"}, "--repeats");
    refuses({"--vary", vary, "--spp", "1", "--reference", "a.exr", "--reference-spp", "9"},
            "--reference-spp");
    refuses({"--vary", vary, "--spp", "1", "--reference", "a.exr"}, "a.exr", exit_code::file);
    refuses({"--vary", "integrator.light_sampler=uniform,bogus", "--spp", "1"}, "bogus",
            exit_code::scene);
    refuses({"--vary", "sensor.film.width=16,24", "--spp", "1", "--set", "sensor.film.height=16"},
            "pixels", exit_code::failure);
}

TEST(ComparisonStatistics, StudentsQuantiles) {
    EXPECT_NEAR(student_quantile(0.95, 1), 12.706, 1e-3);
    EXPECT_NEAR(student_quantile(0.95, 4), 2.7764, 1e-4);
    EXPECT_NEAR(student_quantile(0.99, 7), 3.4995, 1e-4);
    EXPECT_NEAR(student_quantile(0.95, 1e9), 1.9623, 1e-4);
}

/// The interval for the ratio of two log-normal populations covers the truth as often as it says.
TEST(ComparisonStatistics, RatioIntervalsCover) {
    std::mt19937_64 random(1);
    std::normal_distribution<double> normal;
    int covered = 0;
    constexpr int trials = 2000;
    for (int trial = 0; trial < trials; ++trial) {
        std::vector<double> a, b;
        for (int i = 0; i < 5; ++i) a.push_back(3 * std::exp(0.2 * normal(random)));
        for (int i = 0; i < 5; ++i) b.push_back(std::exp(0.05 * normal(random)));
        const Interval ratio = ratio_of_means(a, b);
        covered += ratio.low < 3 && 3 < ratio.high;
    }
    EXPECT_NEAR(double(covered) / trials, 0.955, 0.015);
}

Image noisy_image(std::mt19937_64& random, double bias) {
    std::normal_distribution<float> normal(0, 0.3f);
    Image image(64, 64);
    for (int y = 0; y < 64; ++y) {
        for (int x = 0; x < 64; ++x) {
            const float truth = 1 + float(x) / 64;
            const float local = x < 32 && y < 32 ? float(bias) : 0;
            image.set_rgb(x, y, Color(truth + local) + Color(normal(random)));
        }
    }
    return image;
}

TEST(ComparisonStatistics, BiasTestSeesAQuarterAndNoGhosts) {
    std::mt19937_64 random(2);
    int alarms = 0, found = 0;
    constexpr int trials = 100;
    for (int trial = 0; trial < trials; ++trial) {
        const Image a = noisy_image(random, 0), b = noisy_image(random, 0);
        Image mean = a;
        for (std::size_t i = 0; i < mean.pixels.size(); ++i) {
            mean.pixels[i] = (a.pixels[i] + b.pixels[i]) / 2;
        }
        const Blocks reference(mean);
        const auto variances = block_variances({a, b}, reference.means().size());
        BlockRuns fair, biased;
        for (int i = 0; i < 5; ++i) {
            fair.emplace_back(noisy_image(random, 0));
            biased.emplace_back(noisy_image(random, 0.15));
        }
        alarms += test_bias(fair, reference, variances).biased;
        found += test_bias(biased, reference, variances).biased;
    }
    EXPECT_LE(alarms, 5);
    EXPECT_GE(found, 90);
}

TEST(ComparisonPage, HalvesAndBase64) {
    EXPECT_EQ(half_bits(1.0f), 0x3c00);
    EXPECT_EQ(half_bits(-2.0f), 0xc000);
    EXPECT_EQ(half_bits(1e6f), 0x7bff);
    EXPECT_EQ(half_bits(0.0f), 0);
    EXPECT_EQ(half_bits(5.9604645e-8f), 1);        // the smallest half
    EXPECT_EQ(half_bits(6.097555e-5f), 0x03ff);    // the largest subnormal one
    EXPECT_EQ(half_bits(1.00048828125f), 0x3c00);  // a tie goes to even
    EXPECT_EQ(half_bits(1.00146484375f), 0x3c02);
    EXPECT_EQ(base64(""), "");
    EXPECT_EQ(base64("f"), "Zg==");
    EXPECT_EQ(base64("fo"), "Zm8=");
    EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
}

}  // namespace
}  // namespace lucerna
