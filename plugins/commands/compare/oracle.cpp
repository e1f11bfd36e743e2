// SPDX-License-Identifier: Apache-2.0
#include "plugins/commands/compare/oracle.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace lucerna {

std::string oracle_contradiction(const std::vector<Variant>& variants) {
    for (const Variant& variant : variants) {
        for (const std::string& setting : variant.overrides) {
            const std::string path = setting.substr(0, setting.find('='));
            if (path.find("light_sampler") != std::string::npos) continue;
            return fmt::format(
                "--oracle judges light samplers in one scene; {} cannot be varied "
                "beside them",
                path);
        }
    }
    return "";
}

OracleReport ask_oracle(const SessionSettings& settings,
                        const std::vector<SessionSettings>& variants, std::uint32_t points,
                        std::uint64_t seed) {
    const Session base(settings);
    const Scene& scene = base.scene();
    OracleReport report{.options = OracleOptions::for_lights(scene.lights().size(), points),
                        .lights = scene.lights().size()};
    report.options.seed = seed;
    std::vector<OracleKind> kinds;
    for (const auto& [name, bounces] :
         {std::pair{"seen by the camera", 0}, {"after a bounce", 1}}) {
        const auto chosen = oracle_points(scene, bounces, report.options.points, seed);
        const OracleKind kind(evaluate_all(scene, report.options, chosen));
        report.sections.push_back({.name = name,
                                   .points = kind.moments().size(),
                                   .dark = kind.dark(),
                                   .bound = kind.bound(),
                                   .unoccluded = kind.unoccluded()});
        kinds.push_back(kind);
    }
    for (const SessionSettings& variant : variants) {
        const Session session(variant);
        const LightSampler* sampler = session.scene().light_sampler();
        if (!sampler) throw Error("--oracle: the integrator of the scene has no light sampler");
        for (std::size_t i = 0; i < kinds.size(); ++i) {
            report.sections[i].variants.push_back(kinds[i].judge(*sampler));
        }
    }
    return report;
}

Json to_json(const OracleFigures& figures) {
    Json json = Json::object();
    json.set("mean", figures.mean).set("median", figures.median).set("upper", figures.upper);
    json.set("largest", figures.largest).set("blind_points", figures.blind);
    return json.set("lost", figures.lost);
}

Json to_json(const OracleReport& report, const ComparisonResult& result) {
    Json json = Json::object(), sections = Json::array();
    json.set("lights", report.lights).set("points", report.options.points);
    json.set("samples", report.options.samples);
    json.set("tested", std::min<std::size_t>(report.options.tested, report.lights));
    for (const OracleSection& section : report.sections) {
        Json entry = Json::object(), variants = Json::array();
        entry.set("name", section.name).set("points", section.points).set("dark", section.dark);
        entry.set("bound", to_json(section.bound));
        entry.set("unoccluded", to_json(section.unoccluded));
        for (std::size_t i = 0; i < section.variants.size(); ++i) {
            Json figures = to_json(section.variants[i]);
            figures.set("name", result.variants[i].variant.name);
            variants.append(figures);
        }
        sections.append(entry.set("variants", variants));
    }
    return json.set("sections", sections);
}

namespace {

/// "200 points, 4 samples on each of 5001 lights"
std::string oracle_effort(const OracleReport& report) {
    std::string text =
        fmt::format("{} samples on each of {} lights", report.options.samples, report.lights);
    if (report.lights > report.options.tested) {
        text += fmt::format(", about {} of them tested for shadows at each point",
                            report.options.tested);
    }
    return text;
}

}  // namespace

std::string oracle_table(const OracleReport& report, const ComparisonResult& result) {
    std::size_t width = 16;
    for (const VariantRuns& v : result.variants) width = std::max(width, v.variant.name.size());
    std::string text = "\nVariance of one choice of a light, " + oracle_effort(report) + "\n";
    for (const OracleSection& section : report.sections) {
        const std::string title = fmt::format("{} points {}", section.points, section.name);
        text += fmt::format("\n{:{}}  {:>9} {:>9} {:>9} {:>9} {:>9}  {}\n", title, width, "mean",
                            "median", "90 %", "largest", "to bound", "never drawn");
        const auto line = [&](const std::string& name, const OracleFigures& f) {
            const std::string distance =
                section.bound.mean > 0 ? fmt::format("×{:.3g}", f.mean / section.bound.mean) : "";
            const std::string blind =
                f.blind == 0
                    ? ""
                    : fmt::format("at {} points, {:.2g} % of the light", f.blind, 100 * f.lost);
            text += fmt::format("{:{}}  {:>9.3g} {:>9.3g} {:>9.3g} {:>9.3g} {:>9}  {}\n", name,
                                width, f.mean, f.median, f.upper, f.largest, distance, blind);
        };
        line("(the bound)", section.bound);
        line("(no shadows)", section.unoccluded);
        for (std::size_t i = 0; i < section.variants.size(); ++i) {
            line(result.variants[i].variant.name, section.variants[i]);
        }
    }
    return text;
}

}  // namespace lucerna
