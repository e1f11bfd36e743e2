// SPDX-License-Identifier: Apache-2.0
/// Vertices of a mesh from positions and what corners of faces add to them: corners that agree in
/// both share a vertex.
#pragma once

#include <cstdint>
#include <vector>

namespace lucerna {

template <typename Key>
class VertexJoin {
public:
    struct Found {
        std::uint32_t vertex;
        bool is_new;  ///< vertices are numbered in the order in which they are found
    };

    /// Positions are added in their order, before any corner of theirs.
    void add_position() { newest_.push_back(none); }

    /// The vertex of a corner. Of the vertices of a position only the newest are compared: without
    /// that limit, a position with very many would take very long.
    Found find(std::uint32_t position, const Key& key) {
        constexpr int most = 64;
        int compared = 0;
        for (std::uint32_t i = newest_[position]; i != none && compared < most; ++compared) {
            if (vertices_[i].key == key) return {i, false};
            i = vertices_[i].older;
        }
        const auto added = static_cast<std::uint32_t>(vertices_.size());
        vertices_.push_back({key, newest_[position]});
        newest_[position] = added;
        return {added, true};
    }

private:
    static constexpr std::uint32_t none = 0xffffffff;

    struct Vertex {
        Key key;
        std::uint32_t older;  ///< of the same position
    };
    std::vector<std::uint32_t> newest_;  ///< of each position
    std::vector<Vertex> vertices_;
};

}  // namespace lucerna
