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
#include <set>

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
    const Interval ratio = paired_ratio(errors_a, errors_b);
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
    refuses({"--spp", "1", "--vary", vary, "--set", "integrator.light_sampler=bvh"}, "also --set");
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

/// A comparison as a job of parts.
class CompareByPartsTest : public CompareCommandTest {
protected:
    /// Four rounds, and the reference in five parts.
    std::vector<std::string> with_reference(const std::string& output) const {
        std::vector<std::string> words = twins;
        words.back() = output;
        words.insert(words.end(), {"--reference-spp", "60"});
        return words;
    }
    void pack() {
        std::vector<std::string> words = with_reference("job");
        words.insert(words.end(), {"--parts", "--quiet"});
        compare(words);
    }
    int run(const std::vector<std::string>& words) {
        Process process(folder.path(), words);
        const int code = process.wait();
        errors = process.errors();
        return code;
    }
    /// What merge.sh says.
    std::string log() const { return read_whole(folder / "job/logs/merge.txt"); }
};

/// All that does not depend on time: errors, samples, seeds, the reference, the pictures.
Report timeless(const Report& json) {
    Report kept;
    for (const Report& variant : json["variants"]) {
        Report v = {variant["name"], variant["relative_mse"], variant["mse"],
                    variant["bias"], variant["flip"],         variant["settings"]};
        for (const Report& run : variant["runs"]) {
            v.push_back({run["seed"], run["measured_relative_mse"], run["intersections"],
                         run["samples_per_pixel"], run["curve"].size()});
        }
        kept.push_back(v);
    }
    kept.push_back(json["reference"]["relative_mse"]);
    return kept;
}

std::set<std::string> keys(const Report& json) {
    std::set<std::string> names;
    for (const auto& [name, value] : json.items()) names.insert(name);
    return names;
}

TEST_F(CompareByPartsTest, TellsTheSameAsOnOneMachine) {
    compare(with_reference("out"));
    const Report plain = report();
    const std::string page = read_whole(folder / "out/index.html");
    pack();
    ASSERT_EQ(run({"farm", "job", "--local", "2", "-q"}), exit_code::success) << log();
    const Report parts = Report::parse(read_whole(folder / "job/report.json"));
    expect_no_null(parts, "");
    EXPECT_EQ(timeless(parts), timeless(plain));
    EXPECT_EQ(keys(parts), keys(plain));
    EXPECT_EQ(keys(parts["variants"][1]["runs"][0]), keys(plain["variants"][1]["runs"][0]));
    const std::string page_of_parts = read_whole(folder / "job/index.html");
    const std::size_t pictures = page.find("<script type=\"text/plain\" id=\"picture-0\">");
    ASSERT_NE(pictures, std::string::npos);
    const std::string encoded =
        page.substr(pictures, page.find("\"use strict\"", pictures) - pictures);
    EXPECT_NE(page_of_parts.find(encoded), std::string::npos) << "the pictures differ";
    const std::string csv = read_whole(folder / "job/results.csv");
    EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 13);
}

TEST_F(CompareByPartsTest, EachRoundNamesItsMachine) {
    pack();
    ASSERT_EQ(run({"farm", "job", "--local", "1", "-q"}), exit_code::success) << log();
    const Report json = Report::parse(read_whole(folder / "job/report.json"));
    ASSERT_EQ(json["rounds"].size(), 4);
    double product = 1;
    for (const Report& round : json["rounds"]) {
        EXPECT_NE(round["node"], "");
        EXPECT_GE(round["cores"], round["threads"]);
        EXPECT_GE(round["other_load"], 0);
        EXPECT_LE(round["other_load"], 1);
        product *= round["relative_speed"].get<double>();
    }
    EXPECT_NEAR(product, 1, 1e-6);
    EXPECT_TRUE(json["by_parts"]);
    EXPECT_NE(log().find("node, processor"), std::string::npos) << log();
}

TEST_F(CompareByPartsTest, FilesOfVariantsArePacked) {
    fs::create_directory(folder / "in");
    std::ofstream(folder / "in/a b.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    std::ofstream(folder / "in/c.obj") << "v 0 0 0\nv 2 0 0\nv 0 2 0\nf 1 2 3\n";
    std::ofstream(folder / "in/scene.xml") << R"(<scene version="3.0.0">
        <integrator type="path"/><sensor type="perspective">
        <transform name="to_world"><lookat origin="0, 0, 4" target="0, 0, 0" up="0, 1, 0"/>
        </transform><film type="hdrfilm"><integer name="width" value="16"/>
        <integer name="height" value="16"/></film></sensor><emitter type="constant"/>
        <shape type="obj" id="thing"><string name="filename" value="c.obj"/></shape></scene>)";
    ASSERT_EQ(run({"compare", "in/scene.xml", "--vary", "thing.filename=a b.obj,c.obj", "--spp",
                   "2", "--repeats", "2", "--reference-spp", "8", "--parts", "-o", "job", "-q"}),
              exit_code::success)
        << errors;
    fs::rename(folder / "in", folder / "gone");
    ASSERT_EQ(run({"farm", "job", "--local", "1", "-q"}), exit_code::success) << log();
    EXPECT_TRUE(fs::exists(folder / "job/scene/a_b.obj"));
}

TEST_F(CompareByPartsTest, MissingAndWrongPartsAreToldByName) {
    pack();
    ASSERT_EQ(run({"farm", "job", "--local", "2", "-q"}), exit_code::success) << log();
    fs::remove(folder / "job/index.html");
    const auto collect = [&](const std::string& message) {
        fs::remove(folder / "job/logs/merge.txt");
        EXPECT_EQ(run({"farm", "job", "--local", "1", "-q"}), exit_code::failure);
        EXPECT_NE(log().find(message), std::string::npos) << log();
        EXPECT_FALSE(fs::exists(folder / "job/index.html"));
    };
    const fs::path second = folder / "job/parts/2.exr", kept = folder / "kept.exr";
    fs::rename(second, kept);
    fs::copy(folder / "job/parts/1.exr", second);
    collect("./parts/2.exr does not belong here: it is round 1");
    fs::copy(folder / "job/parts/5.exr", second, fs::copy_options::overwrite_existing);
    fs::remove(folder / "job/logs/merge.txt");
    EXPECT_EQ(run({"farm", "job", "--local", "1", "-q"}), exit_code::file);
    EXPECT_NE(log().find("./parts/2.exr is damaged, or no round of a comparison"),
              std::string::npos);
    fs::remove(second);
    Process process(
        folder / "job",
        {"compare", "scene/scene.xml", "--vary", "integrator.light_sampler=uniform,power", "--spp",
         "3", "--repeats", "4", "--seed", "1", "--round", "2", "-o", "parts/2.exr", "-q"});
    ASSERT_EQ(process.wait(), exit_code::success) << process.errors();
    collect("./parts/2.exr is a round of another comparison:");
    fs::remove(second);
    ASSERT_EQ(run({"farm", "job", "--status"}), exit_code::success);
    Process alone(
        folder / "job",
        {"compare", "scene/scene.xml", "--vary", "integrator.light_sampler=uniform,uniform,power",
         "--spp", "4", "--repeats", "4", "--reference-spp", "60", "--collect", "-o", "."});
    EXPECT_EQ(alone.wait(), exit_code::failure);
    EXPECT_NE(alone.errors().find("parts of the comparison are missing: parts/2.exr (round 2)"),
              std::string::npos)
        << alone.errors();
}

TEST_F(CompareByPartsTest, RefusesNonsense) {
    const std::string vary = "integrator.light_sampler=uniform,power";
    const auto no = [&](std::vector<std::string> words, const std::string& message) {
        words.insert(words.end(), {"--vary", vary});
        refuses(words, message);
    };
    no({"--time", "1", "--parts"}, "--parts needs --reference-spp N or --reference FILE");
    no({"--spp", "1", "--parts", "--collect"}, "give only one of --parts, --round and --collect");
    no({"--spp", "1", "--submit"}, "--submit and --slurm are for --parts");
    no({"--spp", "1", "--parts", "--slurm", "long"}, "is no option of sbatch");
    no({"--spp", "1", "--repeats", "3", "--round", "4"}, "there are only rounds 1 to 3");
    no({"--spp", "1", "--parts", "--json"}, "--json is for the report");
    pack();
    std::vector<std::string> again = twins;
    again.back() = "job";
    again.push_back("--parts");
    compare(again, exit_code::failure);
    EXPECT_NE(errors.find("job is the folder of a job already"), std::string::npos) << errors;
}

/// On machines whose speeds differ by factors, the interval of a paired ratio stays narrow, and
/// covers the truth as often as it says.
TEST(ComparisonStatistics, PairedRatiosKnowNoMachines) {
    std::mt19937_64 random(3);
    std::normal_distribution<double> normal;
    int covered = 0, narrow = 0;
    constexpr int trials = 2000;
    for (int trial = 0; trial < trials; ++trial) {
        std::vector<double> a, b;
        for (int i = 0; i < 5; ++i) {
            const double machine = std::exp(normal(random));
            a.push_back(3 * machine * std::exp(0.2 * normal(random)));
            b.push_back(machine * std::exp(0.05 * normal(random)));
        }
        const Interval ratio = paired_ratio(a, b);
        covered += ratio.low < 3 && 3 < ratio.high;
        narrow += ratio.high / ratio.low < 3;
    }
    // Standard error of the share: 0.005.
    EXPECT_NEAR(double(covered) / trials, 0.955, 0.015);
    EXPECT_GT(narrow, trials * 99 / 100);
}

TEST(ComparisonStatistics, StudentsQuantiles) {
    EXPECT_NEAR(student_quantile(0.95, 1), 12.706, 1e-3);
    EXPECT_NEAR(student_quantile(0.95, 4), 2.7764, 1e-4);
    EXPECT_NEAR(student_quantile(0.99, 7), 3.4995, 1e-4);
    EXPECT_NEAR(student_quantile(0.95, 1e9), 1.9623, 1e-4);
}

TEST(ComparisonStatistics, RanksHoldTheMedian) {
    EXPECT_EQ(median_rank(1), 1u);
    EXPECT_EQ(median_rank(4), 1u);
    EXPECT_EQ(median_rank(8), 2u);    // 93.0 %
    EXPECT_EQ(median_rank(16), 5u);   // 92.3 %
    EXPECT_EQ(median_rank(32), 11u);  // 95.0 %
}

/// The error of a picture that has so many fireflies on average.
double firefly_error(std::mt19937_64& random, double fireflies) {
    std::poisson_distribution<int> count(fireflies);
    std::exponential_distribution<double> size;
    double sum = 1 + 0.02 * size(random);
    for (int n = count(random); n > 0; --n) sum += 40 * size(random);
    return sum;
}

/// The mean of errors of pixels whose tail is Pareto's. Up to 1 there is no expected error.
double pareto_error(std::mt19937_64& random, double tail) {
    std::uniform_real_distribution<double> uniform(1e-16, 1);
    double sum = 0;
    for (int pixel = 0; pixel < 100; ++pixel) sum += std::pow(uniform(random), -1 / tail);
    return sum;
}

/// The share of the intervals of so many repeats that hold the median of all errors [%].
template <typename Error>
double coverage(const Error& error, std::size_t repeats) {
    std::mt19937_64 random(5);
    std::vector<double> all(5001);
    for (double& x : all) x = error(random);
    const double truth = median(all);
    constexpr int trials = 1000;
    int covered = 0;
    for (int trial = 0; trial < trials; ++trial) {
        std::vector<double> errors(repeats);
        for (double& x : errors) x = error(random);
        const Interval interval = geometric_mean(errors);
        EXPECT_TRUE(interval.low <= interval.value && interval.value <= interval.high);
        covered += interval.low <= truth && truth <= interval.high;
    }
    return 100.0 * covered / trials;
}

/// Intervals stay right whatever the tail; docs/comparing.md cites these figures. Three repeats may
/// all have met no firefly, or all have met one, and then cannot know.
TEST(ComparisonStatistics, IntervalsOfHeavyTailsCover) {
    for (const std::size_t repeats : {3u, 5u, 8u, 16u, 32u}) {
        const double least = repeats < 5 ? 78 : 92;
        for (const double fireflies : {0.0, 0.2, 0.5, 0.7, 1.0, 2.0, 4.0, 8.0}) {
            const auto error = [&](auto& random) { return firefly_error(random, fireflies); };
            EXPECT_GT(coverage(error, repeats), least) << fireflies << " " << repeats;
        }
        for (const double tail : {0.8, 1.05, 1.5, 2.5}) {
            const auto error = [&](auto& random) { return pareto_error(random, tail); };
            EXPECT_GT(coverage(error, repeats), 92) << tail << " " << repeats;
        }
    }
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
