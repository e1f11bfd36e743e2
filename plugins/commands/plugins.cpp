// SPDX-License-Identifier: Apache-2.0
/// plugins: lists all plugins, or tells everything about one: `lucerna plugins bsdf/diffuse`.
///
/// The parameters are those that the plugin itself asks for when it is constructed.
#include "core/base/json.h"
#include "core/command_line/arguments.h"
#include "core/interfaces/command.h"
#include "core/plugin/registry.h"
#include "core/scene/builder.h"

#include <fmt/format.h>

#include <algorithm>

namespace lucerna {

namespace {

/// What can be told about a plugin: its summary, or why it cannot be used.
struct Entry {
    std::string kind, name, library, summary, broken;
    std::vector<ParameterInfo> parameters;

    std::string title() const { return kind + "/" + name; }
};

Entry describe_plugin(Registry& registry, const std::string& kind, const std::string& name) {
    Entry entry;
    entry.kind = kind;
    entry.name = name;
    entry.library = registry.path(kind, name).string();
    try {
        entry.summary = registry.find(kind, name).summary;
        entry.parameters = describe_parameters(registry, kind, name);
    } catch (const Error& e) {
        entry.broken = e.what();
    }
    return entry;
}

/// A kind in the singular or the plural, or empty.
std::string find_kind(const std::string& word) {
    for (const std::string& kind : plugin_kinds()) {
        if (word == kind || word == plugin_folder(kind)) return kind;
    }
    return {};
}

/// All plugins that a word of the command line means: "bsdf", "bsdf/diffuse" or "diffuse".
/// Throws Error if there are none.
std::vector<Entry> find_plugins(Registry& registry, const std::string& word) {
    const std::size_t slash = word.find('/');
    const std::string kind = find_kind(word.substr(0, slash));
    std::vector<Entry> entries;
    if (slash != std::string::npos && !kind.empty()) {
        const std::string name(plugin_alias(kind, word.substr(slash + 1)));
        if (registry.path(kind, name).empty()) registry.find(kind, name);  // throws: it lists all
        entries.push_back(describe_plugin(registry, kind, name));
        return entries;
    }
    std::vector<std::string> known = plugin_kinds();
    for (const std::string& k : plugin_kinds()) {
        for (const std::string& name : registry.names(k)) {
            known.push_back(name);
            const bool meant = slash == std::string::npos && (kind == k || name == word);
            if (meant) entries.push_back(describe_plugin(registry, k, name));
        }
    }
    if (!entries.empty() || !kind.empty()) return entries;
    throw Error(fmt::format("there is no plugin and no kind of plugin \"{}\"{}\n  kinds are {}",
                            word, did_you_mean(word.substr(0, slash), known),
                            join(plugin_kinds())));
}

std::vector<Entry> all_plugins(Registry& registry) {
    std::vector<Entry> entries;
    for (const std::string& kind : plugin_kinds()) {
        for (const std::string& name : registry.names(kind)) {
            entries.push_back(describe_plugin(registry, kind, name));
        }
    }
    return entries;
}

void print_list(const std::vector<Entry>& entries) {
    std::size_t width = 0;
    for (const Entry& entry : entries) width = std::max(width, entry.name.size());
    std::string kind;
    for (const Entry& entry : entries) {
        if (entry.kind != kind) fmt::print("{}{}\n", kind.empty() ? "" : "\n", entry.kind);
        kind = entry.kind;
        const std::string text =
            entry.broken.empty() ? entry.summary : "CANNOT BE LOADED: " + entry.broken;
        fmt::print("  {:{}}  {}\n", entry.name, width, text);
    }
}

std::string parameter_line(const ParameterInfo& parameter) {
    std::string line = parameter.type;
    line += parameter.default_value.empty() ? ", required" : ", default " + parameter.default_value;
    if (!parameter.range.empty()) line += ", " + parameter.range;
    return line;
}

void print_in_full(const Entry& entry) {
    fmt::print("{}: {}\n  {}\n", entry.title(), entry.summary, entry.library);
    if (!entry.broken.empty()) {
        fmt::print("  CANNOT BE LOADED: {}\n", entry.broken);
        return;
    }
    if (entry.parameters.empty()) fmt::print("\n  It has no parameters.\n");
    for (const ParameterInfo& parameter : entry.parameters) {
        const std::string name = parameter.name.empty() ? "(nested)" : parameter.name;
        fmt::print("\n  {} ({})\n", name, parameter_line(parameter));
        if (!parameter.doc.empty()) fmt::print("      {}\n", parameter.doc);
    }
}

Json to_json(const ParameterInfo& parameter) {
    Json json = Json::object();
    json.set("name", parameter.name).set("type", parameter.type);
    json.set("required", parameter.default_value.empty());
    if (!parameter.default_value.empty()) json.set("default", parameter.default_value);
    if (!parameter.range.empty()) json.set("range", parameter.range);
    return json.set("doc", parameter.doc);
}

Json to_json(const std::vector<Entry>& entries) {
    Json list = Json::array();
    for (const Entry& entry : entries) {
        Json json = Json::object();
        json.set("kind", entry.kind).set("name", entry.name).set("library", entry.library);
        if (entry.broken.empty()) {
            Json parameters = Json::array();
            for (const ParameterInfo& p : entry.parameters) parameters.append(to_json(p));
            json.set("summary", entry.summary).set("parameters", parameters);
        } else {
            json.set("broken", entry.broken);
        }
        list.append(json);
    }
    return Json::object().set("schema", 1).set("plugins", list);
}

class PluginsCommand final : public Command {
public:
    explicit PluginsCommand(const Params&) {}

    int run(const std::vector<std::string>& words) const override {
        std::vector<std::string> asked, folders;
        bool json = false;
        Arguments arguments("plugins", "Lists plugins, or tells everything about some.");
        arguments.option("--plugins", "DIR", folders,
                         "looks for plugins in DIR first; may be repeated");
        arguments.flag("--json", json, "prints JSON, always in full");
        arguments.positional("PLUGIN", asked,
                             "a kind (bsdf), a plugin (diffuse), or both (bsdf/diffuse)");
        if (const std::optional<int> code = arguments.parse(words)) return *code;

        Registry registry({folders.begin(), folders.end()});
        if (asked.empty()) return print(all_plugins(registry), false, json);
        std::vector<Entry> entries;
        bool in_full = false;
        for (const std::string& word : asked) {
            try {
                const std::vector<Entry> found = find_plugins(registry, word);
                entries.insert(entries.end(), found.begin(), found.end());
            } catch (const Error& e) {
                fmt::print(stderr, "lucerna plugins: {}\n", e.what());
                return exit_code::usage;
            }
            in_full |= find_kind(word).empty();
        }
        return print(entries, in_full, json);
    }

private:
    static int print(const std::vector<Entry>& entries, bool in_full, bool json) {
        if (json) {
            fmt::print("{}", to_json(entries).text());
        } else if (!in_full) {
            print_list(entries);
        } else {
            for (std::size_t i = 0; i < entries.size(); ++i) {
                if (i > 0) fmt::print("\n");
                print_in_full(entries[i]);
            }
        }
        const bool broken = std::any_of(entries.begin(), entries.end(),
                                        [](const Entry& entry) { return !entry.broken.empty(); });
        return broken && in_full ? exit_code::plugin : exit_code::success;
    }
};

}  // namespace

const PluginInfo plugin = describe<PluginsCommand>("lists plugins and their parameters");

}  // namespace lucerna
