// SPDX-License-Identifier: Apache-2.0
/// The parameters of one object: the only way in which a plugin sees its scene element.
///
/// A parameter is declared once, where it is read: name, default, range, one sentence. From that
/// one place come the value, its validation, `lucerna plugins bsdf/mirror` and the reference
/// manual. What is wrong is recorded and the default returned, so that one run reports everything;
/// what the scene gave and nobody read is an error that lists what is accepted.
///
/// A constructor reads all its parameters before it opens a file or computes: the list of
/// parameters is found by constructing the plugin with nothing.
#pragma once

#include "core/base/error.h"
#include "core/math/transform.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace lucerna {

class Object;
class BuildContext;
struct Element;
struct Property;
struct Child;
struct ColorInput;
struct FloatInput;
struct VolumeInput;

/// Closed interval of accepted values, open at an end if so marked.
struct Range {
    double min = -std::numeric_limits<double>::infinity();
    double max = std::numeric_limits<double>::infinity();
    bool open_min = false;
    bool open_max = false;

    bool contains(double x) const;
    std::string text() const;  ///< "[0, 1]", "> 0", "" if everything is accepted
};

inline constexpr Range any_value{};
inline constexpr Range positive{.min = 0, .open_min = true};
inline constexpr Range non_negative{.min = 0};
inline constexpr Range unit_interval{.min = 0, .max = 1};

/// What a parameter is, for humans.
struct ParameterInfo {
    std::string name;
    std::string type;
    std::string default_value;  ///< empty if the parameter is required
    std::string range;
    std::string doc;
};

class Params {
public:
    bool boolean(std::string_view name, bool default_value, std::string_view doc) const;
    std::int64_t integer(std::string_view name, std::int64_t default_value, Range range,
                         std::string_view doc) const;
    /// As `integer`, for values that are kept as int; the range is cut to what an int holds.
    int int32(std::string_view name, int default_value, Range range, std::string_view doc) const;
    float real(std::string_view name, double default_value, Range range,
               std::string_view doc) const;
    std::string string(std::string_view name, std::string_view default_value,
                       std::string_view doc) const;
    /// A position, in double: it may be far from the origin.
    Vector3d point(std::string_view name, Vector3d default_value, std::string_view doc) const;
    Vector3 vector(std::string_view name, Vector3 default_value, std::string_view doc) const;
    /// A vector, or one number that stands for three; no colours, which may be converted. Required.
    Vector3 numbers(std::string_view name, std::string_view doc) const;
    /// Three numbers, a grey value, or a spectrum; the range holds for each channel.
    Color rgb(std::string_view name, Color default_value, Range range, std::string_view doc) const;
    Transform transform(std::string_view name, std::string_view doc) const;

    /// A file that exists, looked for beside the scene and on its search paths. Required.
    std::filesystem::path file(std::string_view name, std::string_view doc) const;

    /// One word of several: `choice("distribution", Type::beckmann, {{"ggx", Type::ggx}, …}, …)`.
    template <typename T>
    T choice(std::string_view name, T default_value,
             const std::vector<std::pair<std::string, T>>& words, std::string_view doc) const {
        std::vector<std::string> names;
        std::size_t chosen = 0;
        for (const auto& [word, value] : words) {
            if (value == default_value && words[chosen].second != default_value) {
                chosen = names.size();
            }
            names.push_back(word);
        }
        return words[choose(name, chosen, names, doc)].second;
    }

    /// A colour that may be a texture: an rgb, a float, a spectrum or a nested `<texture>`.
    ColorInput color_input(std::string_view name, Color default_value, Range range,
                           std::string_view doc) const;
    /// A number that may be a texture (the luminance of its colour).
    FloatInput float_input(std::string_view name, float default_value, Range range,
                           std::string_view doc) const;
    /// A colour that may vary in space: an rgb, a float, a spectrum or a nested `<volume>`.
    VolumeInput volume_input(std::string_view name, Color default_value, Range range,
                             std::string_view doc) const;

    /// The nested object of kind T (`T::kind`) with this name. Null if there is none.
    template <typename T>
    const T* child(std::string_view name, std::string_view doc) const {
        return static_cast<const T*>(named_child(T::kind, name, doc));
    }
    /// The one nested object of kind T, whatever its name. Null if there is none.
    template <typename T>
    const T* nested(std::string_view doc) const {
        return static_cast<const T*>(single_child(T::kind, "", doc));
    }
    /// The one nested object of kind T; if there is none, a `default_type` with its defaults.
    template <typename T>
    const T& nested_or(std::string_view default_type, std::string_view doc) const {
        return static_cast<const T&>(*single_child(T::kind, default_type, doc));
    }
    /// All nested objects of kind T that nobody has asked for yet, in the order of the scene.
    /// An error unless their number is in the range.
    template <typename T>
    std::vector<const T*> all_nested(Range count, std::string_view doc) const {
        std::vector<const T*> result;
        for (const Object* o : remaining_children(T::kind, count, doc)) {
            result.push_back(static_cast<const T*>(o));
        }
        return result;
    }

    /// The names of the nested objects of a kind, in the order of the scene; empty for those
    /// without. Does not declare them.
    std::vector<std::string> child_names(std::string_view kind) const;

    /// True if the scene gives this parameter. Does not declare it.
    bool has(std::string_view name) const;
    /// True if the scene gives this parameter as a string that is not a number: for those that are
    /// either, as an index of refraction or the name of a substance. Does not declare it.
    bool is_word(std::string_view name) const;
    /// Records an error at the parameter (at the element if the scene does not give it). Of several
    /// about one parameter only the first counts: the others follow from it.
    void error(std::string_view name, std::string message) const;
    /// Records a warning at the parameter (at the element if the scene does not give it).
    void warning(std::string_view name, std::string message) const;
    /// Accepts a parameter of other renderers that means nothing here, and says so in a warning
    /// when the scene gives it: nothing is ignored in silence.
    void no_effect(std::string_view name, std::string_view why) const;

    /// "diffuse" in `<bsdf type="diffuse" id="white">`; the name by which the scene asked.
    const std::string& type() const;
    /// The id of the element, or empty.
    const std::string& id() const;

    Params(const Element& element, BuildContext& context);
    Params(const Params&) = delete;
    Params& operator=(const Params&) = delete;
    ~Params();

    /// For the builder: reports what nobody read; if the plugin `stopped` half way, only what it
    /// would not have read either.
    void report_unused(bool stopped,
                       const std::function<std::vector<ParameterInfo>()>& accepted) const;
    /// For the builder: true if something was handed out in place of a nested object or a file that
    /// is wrong. What the plugin throws may follow from that.
    bool made_up() const { return made_up_; }
    /// For the builder: what was asked for, in order. Only kept while describing.
    const std::vector<ParameterInfo>& asked() const { return asked_; }

private:
    const Property* find(std::string_view name) const;
    const Child* find_child(std::string_view name) const;
    void declare(std::string_view name, std::string_view type, std::string default_value,
                 Range range, std::string_view doc) const;
    void wrong_type(const Property& property, std::string_view expected) const;
    void error(const Property& property, std::string message) const;
    const Object* object(const Child& child) const;
    Vector3d triple(std::string_view name, Vector3d default_value) const;
    double number(const Property& property, double default_value, Range range) const;
    ColorD color(const Property& property, ColorD default_value, Range range) const;
    /// A colour, or the nested object of a kind in its place; null if there is none.
    std::pair<Color, const Object*> color_or_child(std::string_view kind, std::string_view name,
                                                   Color default_value, Range range,
                                                   std::string_view doc) const;
    std::size_t choose(std::string_view name, std::size_t default_index,
                       const std::vector<std::string>& words, std::string_view doc) const;
    const Object* named_child(std::string_view kind, std::string_view name,
                              std::string_view doc) const;
    const Object* single_child(std::string_view kind, std::string_view default_type,
                               std::string_view doc) const;
    std::vector<const Object*> remaining_children(std::string_view kind, Range count,
                                                  std::string_view doc) const;

    const Element& element_;
    BuildContext& context_;
    mutable std::vector<bool> property_read_, child_read_;
    mutable std::vector<ParameterInfo> asked_;
    mutable std::set<std::string, std::less<>> wrong_;  ///< parameters with an error
    mutable bool made_up_ = false;
};

}  // namespace lucerna
