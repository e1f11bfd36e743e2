// SPDX-License-Identifier: Apache-2.0
/// The hash of a scene, and names of property types for messages.
#include "core/description/description.h"

#include <bit>
#include <unordered_map>

namespace lucerna {

const char* type_name(const PropertyValue& value) {
    constexpr std::array<const char*, std::variant_size_v<PropertyValue>> names = {
        "boolean",   "integer", "float",
        "string",    "point",   "rgb",
        "transform", "text",    "nothing that can be read"};
    return names[value.index()];
}

namespace {

/// Chains 64-bit words by the finalizer of SplitMix64 (Steele, Lea, Flood 2014).
class Hasher {
public:
    explicit Hasher(std::size_t elements) { numbers_.reserve(elements); }

    void add(std::uint64_t word) {
        value_ ^= word;
        value_ = (value_ ^ value_ >> 30) * 0xbf58476d1ce4e5b9u;
        value_ = (value_ ^ value_ >> 27) * 0x94d049bb133111ebu;
        value_ ^= value_ >> 31;
    }
    void add(std::int64_t number) { add(static_cast<std::uint64_t>(number)); }
    void add(bool flag) { add(std::uint64_t{flag}); }
    void add(double number) { add(std::bit_cast<std::uint64_t>(number + 0.0)); }  // -0 equals 0
    void add(Vector3d v) {
        for (int i = 0; i < 3; ++i) add(v[i]);
    }
    /// With its length, so that neighbours cannot run into each other.
    void add(std::string_view text) {
        add(std::uint64_t{text.size()});
        while (!text.empty()) {
            std::uint64_t word = 0;
            for (std::size_t i = 0; i < std::min<std::size_t>(text.size(), 8); ++i) {
                word |= std::uint64_t{static_cast<unsigned char>(text[i])} << (8 * i);
            }
            add(word);
            text.remove_prefix(std::min<std::size_t>(text.size(), 8));
        }
    }
    void add(const std::string& text) { add(std::string_view(text)); }
    void add(const UntypedText& text) { add(text.text); }
    void add(Unreadable) {}
    void add(const Triple& triple) { add(triple.value); }
    void add(const Rgb& rgb) { add(rgb.value); }
    void add(const Transform& transform) {
        for (int column = 0; column < 4; ++column) {
            for (int row = 0; row < 4; ++row) add(transform.matrix()[column][row]);
        }
    }

    void add(const Element& element) {
        // What several elements refer to is hashed where it is met first, and numbered after that.
        const auto [entry, is_new] = numbers_.try_emplace(&element, numbers_.size());
        add(std::uint64_t{entry->second});
        if (!is_new) return;
        add(element.kind);
        add(element.type);
        std::vector<const Property*> properties;
        for (const Property& property : element.properties) properties.push_back(&property);
        std::sort(properties.begin(), properties.end(),
                  [](const Property* a, const Property* b) { return a->name < b->name; });
        add(std::uint64_t{properties.size()});
        for (const Property* property : properties) {
            add(property->name);
            add(std::uint64_t{property->value.index()});
            std::visit([this](const auto& value) { add(value); }, property->value);
        }
        add(std::uint64_t{element.children.size()});
        for (const Child& child : element.children) {
            add(child.name);
            add(*child.element);
        }
    }

    std::uint64_t value() const { return value_; }

private:
    std::uint64_t value_ = 0;
    std::unordered_map<const Element*, std::size_t> numbers_;
};

}  // namespace

std::uint64_t hash_of(const Description& description) {
    Hasher hasher(description.elements.size());
    if (description.root) hasher.add(*description.root);
    return hasher.value();
}

}  // namespace lucerna
