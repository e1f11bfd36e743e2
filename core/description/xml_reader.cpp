// SPDX-License-Identifier: Apache-2.0
#include "core/description/xml_reader.h"

#include "core/base/file_bytes.h"
#include "core/base/find_file.h"
#include "core/description/legacy.h"
#include "core/description/overrides.h"
#include "core/description/property_reader.h"
#include "core/description/references.h"
#include "core/description/spectrum_plugin.h"
#include "core/description/values.h"

#include <fmt/format.h>

#include <charconv>
#include <system_error>

namespace lucerna {

namespace {

namespace fs = std::filesystem;

constexpr int newest_version = 3;

/// The first number of "3.0.0"; -1 if the text is no version.
int major_version(std::string_view text) {
    int major = -1;
    const char* position = text.data();
    const char* const end = position + text.size();
    for (int part = 0; part < 3; ++part) {
        int number = 0;
        const auto [stop, status] = std::from_chars(position, end, number);
        if (status != std::errc() || number < 0) return -1;
        if (part == 0) major = number;
        if (stop == end) return major;
        if (*stop != '.') return -1;
        position = stop + 1;
    }
    return -1;
}

class Reader {
public:
    Reader(const ReadOptions& options, Diagnostics& diagnostics)
        : limits_(options.limits),
          diagnostics_(diagnostics),
          main_(description_.sources.emplace_back()),
          definitions_(options.defines, options.limits.max_bytes, description_, diagnostics),
          properties_(definitions_, description_, diagnostics),
          references_(diagnostics) {}

    Description read(std::string path, std::string text, const ReadOptions& options) {
        const int errors_before = diagnostics_.error_count();
        main_.path = std::move(path);
        main_.text = std::move(text);
        description_.search_paths.push_back(folder_of(main_.path));
        Element& root = description_.elements.emplace_back();
        root.kind = "scene";
        root.where = {&main_, 0};
        description_.root = &root;
        read_source({}, main_, root);
        if (!references_.resolve(root, limits_.max_depth, limits_.max_errors)) {
            description_.buildable = false;
        }
        if (is_full()) {
            description_.buildable = false;
            diagnostics_.error({}, "too many errors; what follows was not read");
        } else if (description_.buildable) {
            // What was not read may use them.
            if (all_read_) definitions_.report_unused();
            apply_overrides(options.overrides, description_, diagnostics_);
        }
        if (diagnostics_.error_count() == errors_before) description_.hash = hash_of(description_);
        return std::move(description_);
    }

private:
    static std::string folder_of(const std::string& path) {
        const std::string folder = fs::path(path).parent_path().string();
        return folder.empty() ? "." : folder;
    }

    bool is_full() const { return diagnostics_.error_count() >= limits_.max_errors; }

    /// Reads the elements of one file into `into`. The root of the main file is a <scene>; that of
    /// an included one may be a single object as well.
    void read_source(ReadContext context, SourceFile& source, Element& into) {
        context.source = &source;
        bytes_ += context.source->text.size();
        if (bytes_ > limits_.max_bytes) {
            incomplete(into);
            return diagnostics_.error({context.source, 0}, fmt::format("the scene has more than {} "
                                                                       "bytes",
                                                                       limits_.max_bytes));
        }
        const int errors_before = diagnostics_.error_count();
        const XmlDocument document(*context.source, limits_, elements_, diagnostics_);
        const XmlElement root = document.root();
        if (!root) return incomplete(into);
        source.is_shown |= diagnostics_.error_count() == errors_before;
        const Tag tag = read_tag(root, context, definitions_);
        if (context.include_depth == 0) into.where = tag.where();
        if (tag.name == "scene") {
            if (!tag.complete || !read_version(tag, context)) return incomplete(into);
            if (context.include_depth == 0) description_.buildable = true;
            read_children(tag, context, into);
        } else if (context.include_depth > 0) {
            read_element(root, context, into);
        } else {
            diagnostics_.error(tag.where(), fmt::format("expected <scene version=\"3.0.0\">, not "
                                                        "<{}>",
                                                        tag.name));
        }
    }

    /// An included file without a version is of that of the including one.
    bool read_version(const Tag& scene, ReadContext& context) {
        AcceptedAttributes accepted{{"version"}, {}};
        if (context.include_depth > 0) std::swap(accepted.required, accepted.optional);
        if (!check_attributes(scene, accepted, diagnostics_)) return false;
        if (!scene.has("version")) return true;
        const int major = major_version(scene.value("version"));
        if (major < 0 || major > newest_version) {
            diagnostics_.error(scene.where("version"),
                               fmt::format("expected a version up to {}, like \"3.0.0\", not {}",
                                           newest_version, quote(scene.value("version"))));
            return false;
        }
        context.legacy = major < 2;
        description_.legacy = description_.legacy || context.legacy;
        return true;
    }

    void read_children(const Tag& parent, const ReadContext& context, Element& into) {
        if (++depth_ > limits_.max_depth) {
            incomplete(into);
            diagnostics_.error(parent.where(), fmt::format("elements are nested deeper than {}",
                                                           limits_.max_depth));
        } else {
            XmlElement child = parent.element.first_child();
            for (; child && !is_full(); child = child.next_sibling()) {
                read_element(child, context, into);
            }
        }
        --depth_;
    }

    /// Part of what belongs into the element was not read.
    void incomplete(Element& element) {
        element.incomplete = true;
        all_read_ = false;
    }

    void read_element(XmlElement element, const ReadContext& context, Element& into) {
        Tag tag = read_tag(element, context, definitions_);
        // Mitsuba's spectra are textures, and may be called so.
        if (tag.name == "texture" && tag.has("name") && tag.value("type") != "rawconstant" &&
            is_spectrum_plugin(tag.value("type"))) {
            tag.name = "spectrum";
        }
        if (is_object_kind(tag.name)) return read_object(tag, context, into);
        if (PropertyReader::is_property(tag.name)) return read_property(tag, context, into);
        const int errors_before = diagnostics_.error_count();
        if (tag.complete) read_structure(tag, context, into);
        if (!tag.complete || diagnostics_.error_count() > errors_before) incomplete(into);
    }

    /// What is neither an object nor a property.
    void read_structure(const Tag& tag, const ReadContext& context, Element& into) {
        struct Structure {
            std::string_view name;
            AcceptedAttributes attributes;
            void (Reader::*read)(const Tag&, const ReadContext&, Element&);
        };
        static const Structure structures[] = {
            {"ref", {{"id"}, {"name"}}, &Reader::read_reference},
            {"alias", {{"id", "as"}, {}}, &Reader::read_alias},
            {"default", {{"name", "value"}, {}}, &Reader::read_default},
            {"include", {{"filename"}, {}}, &Reader::read_include},
            {"path", {{"value"}, {}}, &Reader::read_path},
        };
        for (const Structure& structure : structures) {
            if (tag.name != structure.name) continue;
            if (!check_attributes(tag, structure.attributes, diagnostics_)) return;
            if (const XmlElement inner = tag.element.first_child()) {
                return diagnostics_.error({tag.source, inner.offset()},
                                          fmt::format("<{}> takes no elements", tag.name));
            }
            return (this->*structure.read)(tag, context, into);
        }
        report_unknown(tag);
    }

    void report_unknown(const Tag& tag) {
        if (PropertyReader::is_transform_step(tag.name)) {
            return diagnostics_.error(tag.where(),
                                      fmt::format("<{}> belongs into a <transform>", tag.name));
        }
        std::vector<std::string> names(object_kinds.begin(), object_kinds.end());
        for (const std::string& name : PropertyReader::tags()) names.push_back(name);
        for (const char* name : {"ref", "alias", "default", "include", "path"}) {
            names.emplace_back(name);
        }
        const std::string hint = did_you_mean(tag.name, names);
        diagnostics_.error(tag.where(),
                           fmt::format("there is no element <{}>{}", tag.name,
                                       hint.empty() ? "; there are " + join(names) : hint));
    }

    void read_object(const Tag& tag, const ReadContext& context, Element& into) {
        static const AcceptedAttributes accepted{{"type"}, {"id", "name"}};
        const bool valid = check_attributes(tag, accepted, diagnostics_);
        Element& element = description_.elements.emplace_back();
        element.kind = tag.name;
        element.type = context.legacy ? legacy_type(tag.value("type")) : tag.value("type");
        element.id = tag.value("id");
        element.where = tag.where();
        element.incomplete = !valid || !tag.complete;
        if (tag.has("type") && element.type.empty() && tag.complete) {
            diagnostics_.error(tag.where("type"), "expected a type");
            element.incomplete = true;
        }
        into.children.push_back({name_of(tag, context), &element, tag.where()});
        if (!element.id.empty()) references_.add_id(element.id, element, tag.where("id"));
        reserve(tag.element, element);
        ReadContext inner = context;
        // As in Mitsuba, not what is nested deeper: textures do not know what they are for.
        inner.in_emitter = element.kind == "emitter";
        inner.in_quantity = PropertyReader::is_quantity(into.children.back().name);
        read_children(tag, inner, element);
        if (context.legacy) upgrade_legacy(element, diagnostics_);
        check_names(element);
    }

    /// Properties are large: growing step by step would copy them often.
    static void reserve(XmlElement xml, Element& element) {
        constexpr std::size_t most = 8;
        std::size_t count = 0;
        for (XmlElement c = xml.first_child(); c && count < most; c = c.next_sibling()) ++count;
        element.properties.reserve(count);
    }

    static std::string name_of(const Tag& tag, const ReadContext& context) {
        const std::string_view name = tag.value("name");
        return context.legacy ? legacy_name(name) : std::string(name);
    }

    /// No two properties and named children of an element have the same name.
    void check_names(const Element& element) {
        std::vector<std::pair<std::string_view, Location>> names;
        names.reserve(element.properties.size() + element.children.size());
        for (const Property& p : element.properties) names.emplace_back(p.name, p.where);
        for (const Child& c : element.children) {
            if (!c.name.empty()) names.emplace_back(c.name, c.where);
        }
        std::stable_sort(names.begin(), names.end(),
                         [](const auto& a, const auto& b) { return a.first < b.first; });
        for (std::size_t i = 1; i < names.size() && !is_full(); ++i) {
            if (names[i].first != names[i - 1].first) continue;
            const bool in_order = names[i].second.file != names[i - 1].second.file ||
                                  names[i].second.offset > names[i - 1].second.offset;
            diagnostics_.error(names[in_order ? i : i - 1].second,
                               fmt::format("\"{}\" is given twice; first at {}", names[i].first,
                                           place_text(names[in_order ? i - 1 : i].second)));
        }
    }

    void read_property(const Tag& tag, const ReadContext& context, Element& into) {
        std::optional<PropertyValue> value;
        if (tag.complete) value = properties_.read(tag, context);
        std::string name = name_of(tag, context);
        if (!value) {
            into.incomplete = true;
            all_read_ = all_read_ && !tag.element.first_child();
            if (name.empty()) return;
            value = Unreadable{};
        }
        if (name.empty()) return diagnostics_.error(tag.where("name"), "expected a name");
        into.properties.push_back({std::move(name), std::move(*value), tag.where()});
    }

    void read_reference(const Tag& tag, const ReadContext& context, Element& into) {
        references_.add_reference(into, name_of(tag, context), std::string(tag.value("id")),
                                  tag.where());
    }

    void read_alias(const Tag& tag, const ReadContext&, Element&) {
        references_.add_alias(std::string(tag.value("as")), std::string(tag.value("id")),
                              tag.where("as"));
    }

    void read_default(const Tag& tag, const ReadContext&, Element&) {
        const std::string_view name = tag.value("name");
        if (name.empty() || name.find_first_of("{}=") != std::string_view::npos) {
            return diagnostics_.error(tag.where("name"),
                                      fmt::format("{} is no name of a parameter", quote(name)));
        }
        definitions_.set_default(name, tag.value("value"), tag.where());
    }

    void read_path(const Tag& tag, const ReadContext&, Element&) {
        try {
            const fs::path folder = find_folder(tag.value("value"), description_.search_paths);
            description_.search_paths.insert(description_.search_paths.begin(), folder.string());
            description_.found_files.push_back({tag.where("value"), folder.string()});
        } catch (const TransientFileError&) {
            throw;  // no fault of the scene
        } catch (const Error& error) {
            diagnostics_.error(tag.where("value"), error.what());
        }
    }

    void read_include(const Tag& tag, const ReadContext& context, Element& into) {
        const Location where = tag.where("filename");
        if (context.include_depth >= limits_.max_include_depth) {
            return diagnostics_.error(where, fmt::format("files include each other deeper than {}",
                                                         limits_.max_include_depth));
        }
        std::vector<std::string> folders = description_.search_paths;
        folders.insert(folders.begin(), folder_of(context.source->path));
        try {
            const fs::path path = find_file(tag.value("filename"), folders);
            for (const SourceFile* open : open_files_) {
                std::error_code ignored;  // files that cannot be compared differ
                if (fs::equivalent(open->path, path, ignored)) throw Error(include_cycle(path));
            }
            if (fs::file_size(path) > limits_.max_bytes - std::min(bytes_, limits_.max_bytes)) {
                throw Error(fmt::format("the scene has more than {} bytes", limits_.max_bytes));
            }
            const std::vector<std::uint8_t> bytes = read_file_bytes(path);
            SourceFile& source = description_.sources.emplace_back(
                SourceFile{path.string(), {bytes.begin(), bytes.end()}, false});
            description_.found_files.push_back({where, source.path, &source});
            open_files_.push_back(&source);
            add_search_path(folder_of(source.path));
            ReadContext inner = context;
            ++inner.include_depth;
            read_source(inner, source, into);
            open_files_.pop_back();
        } catch (const TransientFileError&) {
            throw;  // no fault of the scene
        } catch (const Error& error) {
            diagnostics_.error(where, error.what());
        } catch (const fs::filesystem_error& error) {
            diagnostics_.error(where, error.what());
        }
    }

    std::string include_cycle(const fs::path& path) const {
        std::string chain;
        for (const SourceFile* open : open_files_) chain += open->path + " -> ";
        return "this file includes itself: " + chain + path.string();
    }

    /// Files that an included file names lie beside it.
    void add_search_path(const std::string& folder) {
        std::vector<std::string>& paths = description_.search_paths;
        if (std::find(paths.begin(), paths.end(), folder) == paths.end()) paths.push_back(folder);
    }

    const ReadLimits limits_;
    Diagnostics& diagnostics_;
    Description description_;
    SourceFile& main_;
    Definitions definitions_;
    PropertyReader properties_;
    References references_;
    std::vector<const SourceFile*> open_files_{&main_};
    std::size_t bytes_ = 0, elements_ = 0;
    int depth_ = 0;
    bool all_read_ = true;
};

}  // namespace

Description read_scene(const fs::path& file, const ReadOptions& options, Diagnostics& diagnostics) {
    std::string text;
    try {
        std::error_code ignored;  // reading says what is wrong
        const std::uintmax_t size = fs::file_size(file, ignored);
        if (!ignored && size > options.limits.max_bytes) {
            throw Error(fmt::format("{}: the scene has more than {} bytes", file.string(),
                                    options.limits.max_bytes));
        }
        const std::vector<std::uint8_t> bytes = read_file_bytes(file);
        text.assign(bytes.begin(), bytes.end());
    } catch (const TransientFileError&) {
        throw;  // no fault of the scene
    } catch (const Error& error) {
        diagnostics.error({}, error.what());
        return {};
    }
    return read_scene_text(std::move(text), file.string(), options, diagnostics);
}

Description read_scene_text(std::string text, std::string name, const ReadOptions& options,
                            Diagnostics& diagnostics) {
    return Reader(options, diagnostics).read(std::move(name), std::move(text), options);
}

}  // namespace lucerna
