// SPDX-License-Identifier: Apache-2.0
#include "core/plugin/registry.h"

#include "core/description/kinds.h"
#include "core/plugin/build_context.h"
#include "core/plugin/former_names.h"
#include "core/plugin/library.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <set>

namespace lucerna {

namespace fs = std::filesystem;

namespace {

struct Alias {
    std::string_view kind, alias, name;
};

/// Names of other versions of the scene format.
constexpr std::array aliases{
    Alias{"bsdf", "disney", "principled"},
    Alias{"film", "ldrfilm", "hdrfilm"},
    Alias{"integrator", "photonmapper", "photonmap"},
    Alias{"integrator", "volpathmis", "volpath"},
    Alias{"sampler", "bose", "orthogonal"},
    Alias{"sampler", "bush", "orthogonal"},
    Alias{"sampler", "ldsampler", "sobol"},
};

constexpr std::size_t longest_name = 100;

/// Only such names become the names of files: no other can lead out of the folders of plugins.
bool is_plain_name(std::string_view name) {
    return !name.empty() && name.size() <= longest_name &&
           std::all_of(name.begin(), name.end(), [](char c) {
               return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                      c == '_' || c == '-';
           });
}

}  // namespace

const char* core_version() { return lucerna_version; }

std::string plugin_folder(std::string_view kind) {
    const Kind* found = find_kind(kind);
    return found ? std::string(found->folder) : std::string(kind) + "s";
}

const std::vector<std::string>& plugin_kinds() {
    static const std::vector<std::string> names = [] {
        std::vector<std::string> result;
        for (const Kind& kind : kinds) result.emplace_back(kind.name);
        return result;
    }();
    return names;
}

std::string_view default_plugin(std::string_view kind) { return default_type(kind); }

std::string_view plugin_alias(std::string_view kind, std::string_view name) {
    for (const Alias& alias : aliases) {
        if (alias.kind == kind && alias.alias == name) return alias.name;
    }
    return name;
}

Registry::Registry(std::vector<fs::path> folders) : folders_(std::move(folders)) {
    if (const char* variable = std::getenv("LUCERNA_PLUGINS")) {
        std::string_view list = variable;
        while (!list.empty()) {
            const std::size_t colon = std::min(list.find(':'), list.size());
            if (colon > 0) folders_.emplace_back(list.substr(0, colon));
            list.remove_prefix(std::min(colon + 1, list.size()));
        }
    }
    folders_.push_back(core_library_folder() / "lucerna" / "plugins");
}

fs::path Registry::path(std::string_view kind, std::string_view name) const {
    if (!is_plain_name(name)) return {};
    for (const fs::path& folder : folders_) {
        fs::path candidate = folder / plugin_folder(kind) / (std::string(name) + ".so");
        std::error_code ignored;
        if (fs::exists(candidate, ignored)) return candidate;
    }
    return {};
}

std::vector<std::string> Registry::names(std::string_view kind) const {
    std::set<std::string> found;
    for (const fs::path& folder : folders_) {
        std::error_code failed;
        for (const auto& entry : fs::directory_iterator(folder / plugin_folder(kind), failed)) {
            if (entry.path().extension() == ".so") found.insert(entry.path().stem().string());
        }
    }
    return {found.begin(), found.end()};
}

std::vector<std::string> Registry::opened() const {
    std::vector<std::string> result;
    for (const auto& [key, info] : opened_) {
        result.push_back(plugin_folder(key.first) + "/" + key.second);
    }
    return result;
}

void Registry::add(std::string_view name, const PluginInfo& info) {
    opened_.insert_or_assign({std::string(info.kind), std::string(name)}, &info);
}

const PluginInfo& Registry::find(std::string_view kind, std::string_view asked) {
    const std::string name(plugin_alias(kind, asked));
    const std::pair key{std::string(kind), name};
    if (const auto known = opened_.find(key); known != opened_.end()) return *known->second;

    const fs::path library = path(kind, name);
    if (library.empty()) {
        const std::vector<std::string> there_are = names(kind);
        const std::string former = advice_for_former(former_plugins, kind, asked);
        std::string message = fmt::format("there is no {} {}{}", kind, quote(asked),
                                          former.empty() ? did_you_mean(asked, there_are) : former);
        if (!is_plain_name(name)) {
            message += fmt::format(
                "\n  names of plugins are letters, digits, \"_\" and \"-\", {} at the most",
                longest_name);
        }
        for (const fs::path& folder : folders_) {
            if (!is_plain_name(name)) break;
            message += fmt::format("\n  looked for {}",
                                   (folder / plugin_folder(kind) / (name + ".so")).string());
        }
        message += "\n  there are: " + (there_are.empty() ? "none" : join(there_are));
        throw Error(message);
    }
    const PluginInfo& info = open_plugin(library, kind);
    opened_.emplace(key, &info);
    return info;
}

}  // namespace lucerna
