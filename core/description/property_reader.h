// SPDX-License-Identifier: Apache-2.0
/// Properties of scene elements: `<float name="radius" value="2"/>` and its kin, spectra turned
/// into colours, transforms put together.
#pragma once

#include "core/description/tag.h"

#include <optional>

namespace lucerna {

class PropertyReader {
public:
    /// Files of spectra are looked for in the search paths of `description`, and noted there.
    PropertyReader(Definitions& definitions, Description& description, Diagnostics& diagnostics)
        : definitions_(definitions), description_(description), diagnostics_(diagnostics) {}

    /// True for the tags of properties: "float", "rgb", "transform".
    static bool is_property(std::string_view tag);
    /// All tags of properties.
    static std::vector<std::string> tags();
    /// True for the steps of a transform: "translate", "lookat".
    static bool is_transform_step(std::string_view tag);

    /// True for names of quantities whose spectra may exceed 1; those of others are reflectances.
    static bool is_quantity(std::string_view name);

    /// The value of a property; empty if it is wrong, which is reported.
    std::optional<PropertyValue> read(const Tag& tag, const ReadContext& context);

private:
    /// Reports attributes that are wrong; true if there are none.
    bool check_property(const Tag& tag, const ReadContext& context);
    std::optional<Rgb> read_spectrum_tag(const Tag& tag, const ReadContext& context);
    std::optional<PropertyValue> read_spectrum_object(const Tag& tag, const ReadContext& context);
    std::optional<Rgb> read_blackbody(const Tag& tag);
    std::optional<Transform> read_transform(const Tag& tag, const ReadContext& context);
    std::optional<Transform> read_step(const Tag& tag);
    std::optional<Transform> read_rotation(const Tag& tag);
    std::optional<Transform> read_look_at(const Tag& tag);
    /// From `value` or from x, y, z, of which those that are absent are `absent`.
    std::optional<Vector3d> read_triple(const Tag& tag, double absent);

    /// The result of `parse`; what it throws is reported at the attribute.
    template <typename Parse>
    auto attempt(const Tag& tag, std::string_view attribute, Parse parse)
        -> std::optional<decltype(parse())>;

    Definitions& definitions_;
    Description& description_;
    Diagnostics& diagnostics_;
};

}  // namespace lucerna
