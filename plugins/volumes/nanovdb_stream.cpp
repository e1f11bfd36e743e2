// SPDX-License-Identifier: Apache-2.0
#include "plugins/volumes/nanovdb_stream.h"

#include <blosc.h>
#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <new>

namespace lucerna {

namespace {

constexpr std::uint64_t piece = 1 << 16;  ///< what is read at once [bytes]

}  // namespace

class GridDecoder {
public:
    virtual ~GridDecoder() = default;
    /// Appends the next bytes, at least one; asked only where the grid has more.
    virtual void append(std::vector<std::uint8_t>& bytes) = 0;

protected:
    /// The new end of `bytes`.
    static std::span<std::uint8_t> grow(std::vector<std::uint8_t>& bytes, std::uint64_t count) {
        bytes.resize(bytes.size() + count);
        return std::span(bytes).last(count);
    }
};

namespace {

class PlainDecoder final : public GridDecoder {
public:
    PlainDecoder(const VdbBytes& file, const StoredGrid& grid)
        : file_(file), offset_(grid.offset), left_(grid.size) {}

    void append(std::vector<std::uint8_t>& bytes) override {
        const std::uint64_t count = std::min(left_, piece);
        file_.read(offset_, grow(bytes, count));
        offset_ += count;
        left_ -= count;
    }

private:
    const VdbBytes& file_;
    std::uint64_t offset_, left_;
};

/// One stream of zlib's, with its size before it.
class ZipDecoder final : public GridDecoder {
public:
    ZipDecoder(const VdbBytes& file, const StoredGrid& grid)
        : file_(file),
          offset_(grid.offset + sizeof(std::uint64_t)),
          stored_(file.value<std::uint64_t>(grid.offset)),
          left_(grid.size) {
        file.check(offset_, stored_);
        if (inflateInit(&zlib_) != Z_OK) throw std::bad_alloc();
    }
    ~ZipDecoder() override { inflateEnd(&zlib_); }
    ZipDecoder(const ZipDecoder&) = delete;
    ZipDecoder& operator=(const ZipDecoder&) = delete;

    void append(std::vector<std::uint8_t>& bytes) override {
        const std::span<std::uint8_t> to = grow(bytes, std::min(left_, piece));
        zlib_.next_out = to.data();
        zlib_.avail_out = static_cast<uInt>(to.size());
        left_ -= to.size();
        int result = Z_OK;
        // After the last byte there is a checksum.
        while (result == Z_OK && (zlib_.avail_out > 0 || left_ == 0)) result = inflate_more();
        if (zlib_.avail_out > 0 || (left_ == 0 && result != Z_STREAM_END)) {
            file_.fail("its compressed (zip) grid is damaged");
        }
    }

private:
    int inflate_more() {
        if (zlib_.avail_in == 0) {
            const std::uint64_t count = std::min(stored_, piece);
            file_.read(offset_, std::span(input_).first(count));
            offset_ += count;
            stored_ -= count;
            zlib_.next_in = input_.data();
            zlib_.avail_in = static_cast<uInt>(count);
        }
        return inflate(&zlib_, Z_NO_FLUSH);
    }

    const VdbBytes& file_;
    std::uint64_t offset_, stored_;  ///< of what is yet to be read
    std::uint64_t left_;             ///< yet to be decoded
    std::vector<std::uint8_t> input_ = std::vector<std::uint8_t>(piece);
    z_stream zlib_{};
};

/// Chunks of blosc's, one for each GiB, with a size before each. A chunk is a header, the places of
/// its blocks, and these; they are decoded one by one, each as a chunk of its own.
class BloscDecoder final : public GridDecoder {
public:
    BloscDecoder(const VdbBytes& file, const StoredGrid& grid)
        : file_(file), next_chunk_(grid.offset), left_(grid.size) {}

    void append(std::vector<std::uint8_t>& bytes) override {
        if (decoded_ == header_.size) begin_chunk();
        const std::uint32_t index = decoded_ / header_.block_size;
        const std::span<std::uint8_t> to =
            grow(bytes, std::min(header_.block_size, header_.size - decoded_));
        if (header_.flags & BLOSC_MEMCPYED) {
            file_.read(chunk_ + sizeof header_ + decoded_, to);
        } else {
            decode_block(index, to);
        }
        decoded_ += static_cast<std::uint32_t>(to.size());
    }

private:
    struct Header {
        std::uint8_t version, codec_version, flags, type_size;
        std::uint32_t size, block_size, stored_size;
    };
    static_assert(sizeof(Header) == BLOSC_MIN_HEADER_LENGTH);

    [[noreturn]] void fail() const { file_.fail("its compressed (blosc) grid is damaged"); }

    void begin_chunk() {
        const auto stored_size = file_.value<std::uint64_t>(next_chunk_);
        const std::uint64_t begin = next_chunk_ + sizeof stored_size;
        file_.check(begin, stored_size);
        if (stored_size < sizeof(Header)) fail();
        const auto header = file_.value<Header>(begin);
        std::size_t size, stored, block;  // zeros if it is no header
        blosc_cbuffer_sizes(&header, &size, &stored, &block);
        constexpr std::uint64_t largest = 1 << 30;
        if (size == 0 || size != std::min(left_, largest) || stored != stored_size || block == 0 ||
            block > size || (header.flags & BLOSC_MEMCPYED && stored != sizeof header + size)) {
            fail();
        }
        header_ = header;
        chunk_ = begin;
        decoded_ = 0;
        next_chunk_ = begin + stored;
        left_ -= size;
    }

    void decode_block(std::uint32_t index, std::span<std::uint8_t> to) {
        const std::uint64_t places = sizeof header_, size = header_.stored_size;
        if (places + sizeof(std::uint32_t) * (std::uint64_t{index} + 1) > size) fail();
        const auto place =
            file_.value<std::uint32_t>(chunk_ + places + sizeof(std::uint32_t) * index);
        if (place > size) fail();
        // A block has no end, but is at most its bytes, in parts, each with a length.
        const std::uint64_t longest = to.size() + sizeof(std::uint32_t) * BLOSC_MAX_TYPESIZE;
        const std::uint64_t count = std::min(size - place, longest);
        constexpr std::uint32_t begin = sizeof header_ + sizeof(std::uint32_t);
        Header header = header_;
        constexpr std::uint8_t not_split = 0x10;  // into parts: as a shorter last block
        if (to.size() < header.block_size) header.flags |= not_split;
        header.size = header.block_size = static_cast<std::uint32_t>(to.size());
        header.stored_size = static_cast<std::uint32_t>(begin + count);
        single_.resize(header.stored_size);
        std::memcpy(single_.data(), &header, sizeof header);
        std::memcpy(single_.data() + sizeof header, &begin, sizeof begin);
        file_.read(chunk_ + place, std::span(single_).subspan(begin));
        std::size_t decoded = 0;
        const bool valid = blosc_cbuffer_validate(single_.data(), single_.size(), &decoded) == 0 &&
                           decoded == to.size() &&
                           blosc_decompress_ctx(single_.data(), to.data(), to.size(), 1) ==
                               static_cast<int>(to.size());
        if (!valid) fail();
    }

    const VdbBytes& file_;
    std::uint64_t chunk_ = 0, next_chunk_;  ///< offsets
    std::uint64_t left_;                    ///< yet to be decoded, beyond this chunk
    Header header_{};                       ///< of this chunk
    std::uint32_t decoded_ = 0;             ///< of this chunk
    std::vector<std::uint8_t> single_;      ///< a chunk of one block
};

std::unique_ptr<GridDecoder> make_decoder(const VdbBytes& file, const StoredGrid& grid) {
    switch (grid.codec) {
        case StoredGrid::Codec::zip:
            return std::make_unique<ZipDecoder>(file, grid);
        case StoredGrid::Codec::blosc:
            return std::make_unique<BloscDecoder>(file, grid);
        case StoredGrid::Codec::none:
            break;
    }
    return std::make_unique<PlainDecoder>(file, grid);
}

}  // namespace

GridStream::GridStream(const VdbBytes& file, const StoredGrid& grid)
    : file_(file), grid_(grid), decoder_(make_decoder(file, grid)) {}

GridStream::~GridStream() = default;

std::span<const std::uint8_t> GridStream::read(std::uint64_t offset, std::uint64_t count) {
    if (offset < begin_) {
        window_.clear();
        begin_ = 0;
        decoder_ = make_decoder(file_, grid_);
    }
    while (begin_ + window_.size() < offset + count) {
        skip(std::min(offset - begin_, std::uint64_t{window_.size()}));
        decoder_->append(window_);
    }
    return std::span(window_).subspan(offset - begin_, count);
}

void GridStream::finish() {
    while (begin_ + window_.size() < grid_.size) {
        skip(window_.size());
        decoder_->append(window_);
    }
}

void GridStream::skip(std::uint64_t count) {
    window_.erase(window_.begin(), window_.begin() + static_cast<std::ptrdiff_t>(count));
    begin_ += count;
}

}  // namespace lucerna
