// SPDX-License-Identifier: Apache-2.0
/// check: tries the contracts of its kind on a plugin: `lucerna check bsdf/toon bands=5`.
#include "core/command_line/arguments.h"
#include "core/interfaces/command.h"
#include "core/render/interrupt.h"
#include "plugins/commands/check/contracts_of.h"
#include "plugins/commands/check/pictures.h"

#include <fmt/format.h>

namespace lucerna {

namespace {

struct CheckOptions {
    SubjectRequest subject;
    std::vector<std::string> folders;
    Effort effort;
    double level = 1e-3;
    std::string picture;
};

const char* word_for(Keeping keeping) {
    switch (keeping) {
        case Keeping::kept:
            return "kept";
        case Keeping::broken:
            return "BROKEN";
        case Keeping::unusual:
            return "unusual";
        default:
            return "nothing to try";
    }
}

/// The table, and how many contracts are broken.
int print(const Subject& subject, const CheckOptions& options,
          const std::vector<Finding>& findings) {
    std::string title = subject.kind() + "/" + subject.type();
    for (const std::string& setting : options.subject.settings) title += " " + setting;
    fmt::print("{}\n\n  {:54} {:>9}  {:>4}  {}\n", title, "contract", "p-value", "seed", "verdict");
    int broken = 0, statistical = 0;
    for (const Finding& finding : findings) {
        const std::string p = finding.p ? fmt::format("{:.2g}", *finding.p) : "exact";
        // fmt counts characters of UTF-8 by their width.
        fmt::print("  {:54} {:>9}  {:>4}  {}\n", finding.contract, p, options.effort.seed,
                   word_for(finding.keeping));
        const bool kept = finding.keeping == Keeping::kept;
        if (!kept && !finding.figures.empty()) fmt::print("      {}\n", finding.figures);
        broken += finding.keeping == Keeping::broken;
        statistical += finding.p.has_value();
    }
    fmt::print("\n{} of {} contracts are broken.", broken, findings.size());
    if (statistical > 0) {
        fmt::print(
            " A correct plugin is blamed with probability {:g}:\nthe {} statistical tests share "
            "it (Šidák), and each fails below p = {:.2g}.",
            options.level, statistical, sidak(options.level, statistical));
    }
    fmt::print("\n");
    return broken;
}

class CheckCommand final : public Command {
public:
    explicit CheckCommand(const Params&) {}

    int run(const std::vector<std::string>& words) const override {
        CheckOptions options;
        if (const std::optional<int> code = parse(words, options)) return *code;
        ignore_write_signals();
        Registry registry({options.folders.begin(), options.folders.end()});
        try {
            return check(options, registry);
        } catch (const SceneError&) {
            throw;
        } catch (const PluginError&) {
            throw;
        } catch (const FileError&) {
            throw;
        } catch (const Error& e) {
            fmt::print(stderr, "lucerna check: {}\n", e.what());
            return exit_code::usage;
        }
    }

private:
    static int check(const CheckOptions& options, Registry& registry) {
        Subject subject(options.subject, registry);
        const std::vector<Finding> findings =
            judge(contracts_of(subject, options.effort), options.level);
        for (const Diagnostic& warning : subject.warnings()) {
            fmt::print(stderr, "{}\n", warning.text());
        }
        const int broken = print(subject, options, findings);
        if (!options.picture.empty()) {
            draw_picture(subject, options.effort, options.picture);
            fmt::print("{}\n", options.picture);
        }
        return broken == 0 ? exit_code::success : exit_code::failure;
    }

    static std::optional<int> parse(const std::vector<std::string>& words, CheckOptions& options) {
        Arguments arguments("check", "Tries the contracts of its kind on a plugin.");
        arguments.positional("PLUGIN", options.subject.plugin,
                             "kind and name, like bsdf/toon; with --scene, an id");
        arguments.option("--inside", "XML", options.subject.inside,
                         "what stands inside of its element, for nested objects");
        arguments.option("--scene", "FILE", options.subject.scene,
                         "takes the element with the id PLUGIN from a scene");
        arguments.option("--samples", "N", options.effort.samples, {.min = 1000, .max = 1e9},
                         "to a statistical test, 200000 unless given: more find smaller faults");
        arguments.option("--seed", "N", options.effort.seed, {.min = 0},
                         "of all random numbers, 1 unless given");
        arguments.option("--level", "P", options.level, {.min = 1e-12, .max = 0.5},
                         "probability that a correct plugin is blamed, 0.001 unless given");
        arguments.option("--picture", "FILE", options.picture,
                         "draws what is sampled beside what should be, as a PNG");
        arguments.option("--plugins", "DIR", options.folders,
                         "looks for plugins in DIR first; may be repeated");
        arguments.positional("NAME=VALUE", options.subject.settings,
                             "parameters, as in a scene; bsdf=diffuse makes a nested object");
        arguments.footer(
            "Exit code 0: all contracts are kept; 1: some are broken. \"Unusual\" is allowed, but "
            "rarely meant: reflection that is not reciprocal, for instance. The same seed finds "
            "the same.");
        return arguments.parse(words);
    }
};

}  // namespace

const PluginInfo plugin = describe<CheckCommand>("tries the contracts of its kind on a plugin");

}  // namespace lucerna
