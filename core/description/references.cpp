// SPDX-License-Identifier: Apache-2.0
#include "core/description/references.h"

#include <fmt/format.h>

namespace lucerna {

std::string place_text(Location where) {
    if (!where.file) return "the command line";
    const std::string_view text = where.file->text;
    const std::string_view head = text.substr(0, std::min(where.offset, text.size()));
    const std::size_t newline = head.rfind('\n');
    const std::size_t start = newline == std::string_view::npos ? 0 : newline + 1;
    return fmt::format("{}:{}:{}", where.file->path, 1 + std::count(head.begin(), head.end(), '\n'),
                       1 + head.size() - start);
}

void References::add_id(const std::string& id, Element& element, Location where) {
    add(id, {&element, {}, where});
}

void References::add_alias(const std::string& id, const std::string& target, Location where) {
    if (add(id, {nullptr, target, where})) aliases_.push_back(id);
}

bool References::add(const std::string& id, Entry entry) {
    const Location where = entry.where;
    const auto [present, is_new] = entries_.try_emplace(id, std::move(entry));
    if (!is_new) {
        diagnostics_.error(where, fmt::format("the id \"{}\" is used already, at {}", id,
                                              place_text(present->second.where)));
    }
    return is_new;
}

void References::add_reference(Element& owner, std::string name, const std::string& id,
                               Location where) {
    references_.push_back({&owner, owner.children.size(), id});
    owner.children.push_back({std::move(name), nullptr, where});
}

bool References::resolve(Element& root, int max_depth, int max_errors) {
    const auto full = [&] { return diagnostics_.error_count() >= max_errors; };
    for (const std::string& alias : aliases_) {
        if (!full()) resolve_alias(entries_.at(alias));
    }
    bool complete = true;
    for (const Reference& reference : references_) {
        Child& child = reference.owner->children[reference.child];
        const auto entry = entries_.find(reference.id);
        if (entry != entries_.end()) child.element = entry->second.element;
        if (entry == entries_.end() && !full()) report_unknown(reference.id, child.where);
        complete = complete && child.element;
    }
    if (!complete) {
        for (const Reference& reference : references_) {
            const auto without = [](const Child& c) { return !c.element; };
            if (std::erase_if(reference.owner->children, without) > 0) {
                reference.owner->incomplete = true;
            }
        }
    }
    return references_.empty() || check_cycles(root, static_cast<std::size_t>(max_depth));
}

void References::resolve_alias(Entry& entry) {
    constexpr int max_steps = 64;
    const std::string* target = &entry.alias_of;
    for (int step = 0; step < max_steps; ++step) {
        const auto next = entries_.find(*target);
        if (next == entries_.end()) return report_unknown(*target, entry.where);
        entry.element = next->second.element;
        if (entry.element) return;
        target = &next->second.alias_of;
    }
    diagnostics_.error(entry.where, "this alias leads back to itself");
}

void References::report_unknown(const std::string& id, Location where) {
    std::vector<std::string> ids;
    for (const auto& [known, entry] : entries_) ids.push_back(known);
    std::sort(ids.begin(), ids.end());
    constexpr std::size_t shown = 20;
    std::string list = "no element has an id";
    if (!ids.empty()) {
        const std::size_t count = std::min(shown, ids.size());
        list = "there are " + join({ids.begin(), ids.begin() + static_cast<std::ptrdiff_t>(count)});
        if (count < ids.size()) list += fmt::format(" and {} more", ids.size() - count);
    }
    diagnostics_.error(
        where, fmt::format("no element has the id \"{}\"; {}{}", id, list, did_you_mean(id, ids)));
}

namespace {

std::string describe(const Element& element) {
    if (!element.id.empty()) return fmt::format("\"{}\"", element.id);
    return fmt::format("<{} type=\"{}\">", element.kind, element.type);
}

/// An element on the way from the root, while its children are visited.
struct Visit {
    Element* element;
    std::size_t next_child = 0;
    std::size_t height = 0;  ///< of what is below, as far as visited
};

}  // namespace

bool References::check_cycles(Element& root, std::size_t max_depth) {
    constexpr std::size_t in_progress = 0;
    std::unordered_map<const Element*, std::size_t> heights{{&root, in_progress}};
    for (std::vector<Visit> path{{&root}}; !path.empty();) {
        Visit& visit = path.back();
        if (visit.next_child == visit.element->children.size()) {
            const std::size_t height = visit.height + 1;
            heights[visit.element] = height;
            if (height > max_depth) {
                const std::string message =
                    fmt::format("elements refer to each other deeper than {}", max_depth);
                diagnostics_.error(visit.element->where, message);
                return false;
            }
            path.pop_back();
            if (!path.empty()) path.back().height = std::max(path.back().height, height);
            continue;
        }
        const Child& child = visit.element->children[visit.next_child++];
        const auto [known, is_new] = heights.try_emplace(child.element, in_progress);
        if (is_new) {
            path.push_back({child.element});
        } else if (known->second != in_progress) {
            visit.height = std::max(visit.height, known->second);
        } else {
            const auto start = std::find_if(path.begin(), path.end(), [&](const Visit& v) {
                return v.element == child.element;
            });
            std::string cycle;
            for (auto v = start; v != path.end(); ++v) cycle += describe(*v->element) + " -> ";
            diagnostics_.error(child.where, "this reference leads in a circle: " + cycle +
                                                describe(*child.element));
            return false;
        }
    }
    return true;
}

}  // namespace lucerna
