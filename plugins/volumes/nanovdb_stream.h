// SPDX-License-Identifier: Apache-2.0
/// The bytes of one grid of a NanoVDB file, decoded from its begin on, so that it need not fit
/// into memory.
#pragma once

#include "plugins/volumes/vdb_bytes.h"

#include <memory>
#include <vector>

namespace lucerna {

/// Where a grid lies in its file.
struct StoredGrid {
    enum class Codec : std::uint16_t { none, zip, blosc };
    Codec codec;
    std::uint64_t offset, stored_size, size;  ///< in the file, in the file, decoded [bytes]
};

class GridDecoder;

/// Throws Error for a compressed grid that is damaged.
class GridStream {
public:
    /// Both are kept by reference.
    GridStream(const VdbBytes& file, const StoredGrid& grid);
    ~GridStream();

    std::uint64_t size() const { return grid_.size; }
    /// Bytes of the grid, which must have them; valid until the next call. What lies before
    /// the bytes that are still held is decoded anew.
    std::span<const std::uint8_t> read(std::uint64_t offset, std::uint64_t count);
    /// Decodes the rest: damage may show only at the end.
    void finish();

private:
    const VdbBytes& file_;
    const StoredGrid& grid_;
    std::unique_ptr<GridDecoder> decoder_;
    std::vector<std::uint8_t> window_;  ///< what was decoded last
    std::uint64_t begin_ = 0;           ///< offset of the window

    void skip(std::uint64_t count);
};

}  // namespace lucerna
