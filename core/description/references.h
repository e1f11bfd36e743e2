// SPDX-License-Identifier: Apache-2.0
/// Ids, references and aliases of a scene. A reference may stand before what it refers to.
#pragma once

#include "core/description/description.h"

#include <string>
#include <unordered_map>
#include <vector>

namespace lucerna {

/// "scene.xml:12:5"
std::string place_text(Location where);

class References {
public:
    explicit References(Diagnostics& diagnostics) : diagnostics_(diagnostics) {}

    /// An id that is taken is reported with the place of the first.
    void add_id(const std::string& id, Element& element, Location where);
    /// `<alias id="target" as="id"/>`
    void add_alias(const std::string& id, const std::string& target, Location where);
    /// Appends a child to `owner` whose element `resolve` will fill in.
    void add_reference(Element& owner, std::string name, const std::string& id, Location where);

    /// Points all references to their elements. Reports those that lead nowhere, in a circle, or
    /// deeper than `max_depth`; no child without an element is left. False if there is a circle, or
    /// too much depth, so that what refers to what cannot be followed.
    bool resolve(Element& root, int max_depth, int max_errors);

private:
    struct Entry {
        Element* element = nullptr;  ///< null for an alias that is not resolved
        std::string alias_of;
        Location where;
    };
    struct Reference {
        Element* owner;
        std::size_t child;
        std::string id;
    };
    bool add(const std::string& id, Entry entry);
    void resolve_alias(Entry& entry);
    void report_unknown(const std::string& id, Location where);
    bool check_cycles(Element& root, std::size_t max_depth);

    Diagnostics& diagnostics_;
    std::unordered_map<std::string, Entry> entries_;
    std::vector<std::string> aliases_;
    std::vector<Reference> references_;
};

}  // namespace lucerna
