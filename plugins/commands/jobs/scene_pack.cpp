// SPDX-License-Identifier: Apache-2.0
#include "plugins/commands/jobs/scene_pack.h"

#include "core/base/error.h"
#include "core/base/find_file.h"
#include "core/description/xml_text.h"
#include "core/scene/builder.h"
#include "plugins/commands/jobs/file_store.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

namespace lucerna {

namespace {

class ScenePack {
public:
    ScenePack(const Session& session, const SessionSettings& settings,
              const std::filesystem::path& folder)
        : description_(session.description()),
          registry_(session.registry()),
          files_(folder / "scene") {
        for (const Element& element : description_.elements) add_files(element, description_);
        add_found_files();
        const SourceFile& main = description_.sources.front();
        result_.name = files_.add_text(std::filesystem::path(main.path).filename().string(),
                                       with_defaults(rewritten(main), settings.defines));
        for (const std::string& text : settings.overrides) {
            result_.overrides.push_back(result_.renamed(text));
        }
        copy_plugins(session.registry(), folder / "plugins");
    }

    /// Packs what the overrides of a variant add.
    void add_variant(const Session& variant, const std::filesystem::path& folder) {
        for (const Element& element : variant.description().elements) {
            add_files(element, variant.description());
        }
        copy_plugins(variant.registry(), folder / "plugins");
    }

    PackedScene result() && { return std::move(result_); }

private:
    /// The files that the plugin of an element reads.
    void add_files(const Element& element, const Description& description) {
        if (!is_object_kind(element.kind)) return;
        const std::vector<std::string>& parameters = file_parameters(element);
        for (const Property& property : element.properties) {
            if (std::find(parameters.begin(), parameters.end(), property.name) ==
                parameters.end()) {
                continue;
            }
            if (const auto* untyped = std::get_if<UntypedText>(&property.value)) {
                const std::string& text = property.where.file->text;
                result_.renamed_settings[text] =
                    text.substr(0, text.find('=') + 1) + add_file(untyped->text, description);
            } else if (const auto* name = std::get_if<std::string>(&property.value);
                       name && &description == &description_) {
                const Location where = property.where;
                const std::size_t offset =
                    attribute_value_offset(where.file->text, where.offset, "value");
                new_values_[where.file][offset] = add_file(*name, description);
            }
        }
    }

    std::string add_file(const std::string& name, const Description& description) {
        return files_.add_file(find_file(name, description.search_paths));
    }

    /// Names of the parameters that are files.
    const std::vector<std::string>& file_parameters(const Element& element) {
        const auto [known, is_new] = file_parameters_.try_emplace({element.kind, element.type});
        if (is_new) {
            for (const ParameterInfo& p :
                 describe_parameters(registry_, element.kind, element.type)) {
                if (p.type == "file") known->second.push_back(p.name);
            }
        }
        return known->second;
    }

    /// What the reader found. An included file comes before all that it includes itself; it is
    /// written after those, whose names it contains.
    void add_found_files() {
        const std::vector<FoundFile>& found = description_.found_files;
        for (auto file = found.rbegin(); file != found.rend(); ++file) {
            std::string& value = new_values_[file->where.file][file->where.offset];
            if (file->included) {
                value = files_.add_text(std::filesystem::path(file->path).filename().string(),
                                        rewritten(*file->included));
            } else if (std::filesystem::is_directory(file->path)) {
                value = ".";
            } else {
                value = files_.add_file(file->path);
            }
        }
    }

    /// The text with the new values of attributes.
    std::string rewritten(const SourceFile& source) {
        std::string text;
        std::size_t copied = 0;
        for (const auto& [offset, value] : new_values_[&source]) {
            text.append(source.text, copied, offset - copied).append(value);
            copied = source.text.find(source.text[offset - 1], offset);  // the closing quote
        }
        return text.append(source.text, copied);
    }

    /// Defaults right behind the start tag of <scene>; the first default of a name counts.
    std::string with_defaults(
        std::string text, const std::vector<std::pair<std::string, std::string>>& defines) const {
        std::string defaults;
        for (const auto& [name, value] : defines) {
            if (value.find('$') != std::string::npos) {
                throw Error(
                    fmt::format("-D {}={}: a value with \"$\" cannot become a default of "
                                "the packed scene; write it into the scene",
                                name, value));
            }
            // The last definition of a name counts, the first default.
            defaults =
                fmt::format("<default name=\"{}\" value=\"{}\"/>", name, escaped(value)) + defaults;
        }
        std::size_t position = after_name(text, description_.root->where.offset);
        RawAttribute attribute{};
        while (next_attribute(text, position, attribute)) {
        }
        return text.insert(text.find('>', position) + 1, defaults);
    }

    static std::string escaped(const std::string& value) {
        std::string text;
        for (const char c : value) {
            switch (c) {
                case '&':
                    text += "&amp;";
                    break;
                case '<':
                    text += "&lt;";
                    break;
                case '"':
                    text += "&quot;";
                    break;
                default:
                    text += c;
            }
        }
        return text;
    }

    void copy_plugins(const Registry& registry, const std::filesystem::path& folder) {
        const std::filesystem::path own = registry.folders().back();
        for (const std::string& name : registry.opened()) {
            for (const std::filesystem::path& place : registry.folders()) {
                const std::filesystem::path library = place / (name + ".so");
                if (!std::filesystem::exists(library)) continue;
                if (place == own) break;
                const std::filesystem::path copy = folder / (name + ".so");
                make_folder(copy.parent_path());
                put_copy(library, copy);
                result_.has_plugins = true;
                break;
            }
        }
    }

    const Description& description_;
    Registry registry_;
    FileStore files_;
    PackedScene result_;
    std::map<std::pair<std::string, std::string>, std::vector<std::string>> file_parameters_;
    /// By source and the offset of the value that they replace.
    std::map<const SourceFile*, std::map<std::size_t, std::string>> new_values_;
};

}  // namespace

std::string PackedScene::renamed(const std::string& setting) const {
    const auto found = renamed_settings.find(setting);
    return found == renamed_settings.end() ? setting : found->second;
}

PackedScene pack_scene(
    const Session& session, const SessionSettings& settings, const std::filesystem::path& folder,
    const std::vector<SessionSettings>& variants,
    const std::function<void(std::size_t index, const Session& variant)>& built) {
    ScenePack pack(session, settings, folder);
    for (std::size_t i = 0; i < variants.size(); ++i) {
        const Session variant(variants[i]);
        if (built) built(i, variant);
        pack.add_variant(variant, folder);
    }
    return std::move(pack).result();
}

}  // namespace lucerna
