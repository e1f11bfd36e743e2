// SPDX-License-Identifier: Apache-2.0
/// A scene as it is written: a tree of elements with typed properties and their places in the
/// source. What lies between reading (which knows XML and no plugin) and building (which knows
/// contracts and no XML).
#pragma once

#include "core/base/error.h"
#include "core/math/transform.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace lucerna {

/// What can stand in a scene and is made by a plugin: the element names and the plugin kinds.
inline constexpr std::array<std::string_view, 13> object_kinds = {
    "integrator", "light_sampler", "shape",  "bsdf", "emitter", "texture", "medium",
    "phase",      "volume",        "sensor", "film", "sampler", "rfilter"};

inline bool is_object_kind(std::string_view name) {
    return std::find(object_kinds.begin(), object_kinds.end(), name) != object_kinds.end();
}

/// A value given on the command line (`--set`), whose type the reader of the parameter decides.
struct UntypedText {
    std::string text;
};

/// A value that could not be read, which has been reported: not absent, but of no use.
struct Unreadable {};

/// A point or a vector.
struct Triple {
    Vector3d value;
};

/// A colour in linear Rec.709; spectra, sRGB triplets and blackbodies are converted by the reader.
struct Rgb {
    ColorD value;
};

using PropertyValue = std::variant<bool, std::int64_t, double, std::string, Triple, Rgb, Transform,
                                   UntypedText, Unreadable>;

/// "boolean", "integer", "float", "string", "point", "rgb", "transform" or "text".
const char* type_name(const PropertyValue& value);

/// `<float name="radius" value="2"/>`
struct Property {
    std::string name;
    PropertyValue value;
    Location where;
};

struct Element;

/// A nested object, or a reference to one. `name` is empty if the scene gives none.
struct Child {
    std::string name;
    Element* element = nullptr;
    Location where;  ///< of the nested element or of the `<ref>`
};

/// Something a plugin will be made of: `<bsdf type="diffuse" id="white">…</bsdf>`. The root has
/// kind "scene" and no type.
struct Element {
    std::string kind;
    std::string type;
    std::string id;
    std::vector<Property> properties;
    std::vector<Child> children;
    Location where;
    /// The type was replaced by `--set`: parameters that the new type does not know are dropped
    /// with a warning, not refused.
    bool type_overridden = false;
    /// Something in it could not be read, which has been reported: what seems to be missing may
    /// have been given.
    bool incomplete = false;
};

/// A file or folder that the reader itself looked for, for `<include>`, `<path>` or `<spectrum>`.
/// Files that plugins read are properties instead.
struct FoundFile {
    Location where;  ///< of the name
    std::string path;
    const SourceFile* included = nullptr;  ///< what `<include>` read
};

/// A whole scene. Addresses of sources and elements are stable, also when it is moved.
struct Description {
    Description() = default;
    Description(Description&&) = default;
    Description& operator=(Description&&) = default;

    std::deque<SourceFile> sources;  ///< the main file first
    std::deque<Element> elements;
    Element* root = nullptr;
    /// Written for Mitsuba before 2.0 (camelCase): unknown parameters are warnings.
    bool legacy = false;
    /// False if reading failed in such a way that building would only find errors that follow.
    bool buildable = false;
    /// Folders in which relative file names are looked for, in order.
    std::vector<std::string> search_paths;
    std::vector<FoundFile> found_files;
    /// Hash of everything that was read, after overrides: equal hashes mean equal scenes.
    std::uint64_t hash = 0;
};

/// Hash of kinds, types, names, values and structure, in an order that does not depend on how the
/// properties are ordered. Ids and places do not count; of files that plugins will read only the
/// names count here, the contents are added when they are found (Scene::hash). The same on every
/// machine.
std::uint64_t hash_of(const Description& description);

}  // namespace lucerna
