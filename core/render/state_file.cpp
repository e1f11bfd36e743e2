// SPDX-License-Identifier: Apache-2.0
#include "core/render/state_file.h"

#include "core/base/atomic_file.h"
#include "core/base/parallel.h"
#include "core/image/exr.h"
#include "core/math/sequences.h"
#include "core/plugin/registry.h"
#include "core/render/packed_sums.h"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <charconv>
#include <cstddef>
#include <cstring>
#include <optional>

namespace lucerna {

namespace fs = std::filesystem;

namespace {

static_assert(std::endian::native == std::endian::little, "the order of bytes in a state file");

constexpr int state_format = 6;
constexpr int rows_of_band = 16;
constexpr std::size_t alpha_channel = 3;

/// The end of a state file.
struct StateTrailer {
    std::uint64_t picture_size = 0;  ///< of the OpenEXR file at the beginning [bytes]
    std::uint64_t band_count = 0;
    std::uint64_t hash = 0;  ///< of the picture and of the index
    std::uint64_t magic = 0;
};
constexpr std::uint64_t state_magic = 0x4554415453435554;  // "TUCSTATE"

/// What the index says of a band.
struct BandEntry {
    std::uint64_t size = 0, hash = 0;
};

std::span<const std::uint8_t> as_bytes(const std::string& text) {
    return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

template <typename T>
std::span<std::uint8_t> as_bytes_of(T* first, std::size_t count) {
    return {reinterpret_cast<std::uint8_t*>(first), count * sizeof(T)};
}

std::uint64_t hash_of_index(std::span<const std::uint8_t> picture, std::span<BandEntry> index) {
    return hash64({hash_of_bytes(picture), hash_of_bytes(as_bytes_of(index.data(), index.size()))});
}

/// Pixels begin … end − 1 of those that are sampled.
struct PixelRange {
    std::size_t begin, end;
    std::size_t size() const { return end - begin; }
};

std::size_t band_count_of(const FilmLayout& layout) {
    return static_cast<std::size_t>((layout.sampled().size.y + rows_of_band - 1) / rows_of_band);
}

PixelRange pixels_of_band(const FilmLayout& layout, std::size_t band) {
    const Vector2i size = layout.sampled().size;
    const int first = static_cast<int>(band) * rows_of_band;
    const int end = std::min(first + rows_of_band, size.y);
    const auto index = [&](int row) {
        return static_cast<std::size_t>(row) * static_cast<std::size_t>(size.x);
    };
    return {.begin = index(first), .end = index(end)};
}

/// An integer as the sum of two doubles, exactly.
ExactSum sum_of(std::int64_t x) {
    const auto high = static_cast<double>(x);
    return {.high = high, .low = static_cast<double>(x - static_cast<std::int64_t>(high))};
}

/// Every second number, every fourth, …: as the film keeps those of its bins.
template <typename Integer>
std::vector<ExactSum> sums_of(std::span<const Integer> numbers, PixelRange pixels,
                              std::size_t stride, std::size_t first) {
    std::vector<ExactSum> sums;
    sums.reserve(pixels.size());
    for (std::size_t i = pixels.begin; i < pixels.end; ++i) {
        sums.push_back(sum_of(static_cast<std::int64_t>(numbers[i * stride + first])));
    }
    return sums;
}

void pack(const std::vector<ExactSum>& sums, std::string& bytes) {
    pack_sums({.first = sums.data(), .count = sums.size()}, bytes);
}

/// Alpha times weight is mostly the weight itself.
enum class AlphaSums : char { packed = 0, weights = 1 };

/// The sums of some pixels, in the order in which BandAdder takes them.
std::string packed_band(const FilmState& film, PixelRange pixels) {
    std::string bytes;
    pack(sums_of(film.dropped(), pixels, 1, 0), bytes);
    for (const std::size_t half : {0u, 1u}) {
        pack(sums_of(film.counts(), pixels, 2, half), bytes);
    }
    pack_sums({.first = &film.squares()[pixels.begin], .count = pixels.size()}, bytes);
    const std::size_t bins = film.bin_count(), channels = film.sum_count();
    for (std::size_t bin = 0; bin < bins; ++bin) {
        const std::vector<ExactSum> weights = sums_of(film.weights(), pixels, bins, bin);
        pack(weights, bytes);
        for (std::size_t c = 0; c < channels; ++c) {
            const SumsOf<const ExactSum> sums = {
                .first = &film.sums()[(pixels.begin * bins + bin) * channels + c],
                .count = pixels.size(),
                .stride = bins * channels};
            if (c == alpha_channel) {
                bool same = true;
                for (std::size_t i = 0; i < sums.count && same; ++i) {
                    same = sums[i].high == weights[i].high && sums[i].low == weights[i].low;
                }
                bytes += static_cast<char>(same ? AlphaSums::weights : AlphaSums::packed);
                if (same) continue;
            }
            pack_sums(sums, bytes);
        }
    }
    return bytes;
}

/// Adds the packed sums of some pixels to a film.
///
/// Sums lie channel by channel in the bytes, and pixel by pixel in the film. So the beginning of
/// each channel is looked for first; then all channels of a few pixels are added while these pixels
/// are in the processor's nearest cache.
class BandAdder {
public:
    BandAdder(std::span<const std::uint8_t> bytes, PixelRange pixels, FilmState& film)
        : packed_(bytes), pixels_(pixels), film_(film) {}

    /// Returns false if the bytes are not what packed_band makes.
    [[nodiscard]] bool add() {
        if (!find_channels()) return false;
        for (std::size_t begin = pixels_.begin; begin < pixels_.end; begin += most_in_block) {
            const PixelRange block = {.begin = begin,
                                      .end = std::min(begin + most_in_block, pixels_.end)};
            if (!add_block(block)) return false;
        }
        return true;
    }

private:
    /// A multiple of the size of groups: sums are packed in whole ones.
    static constexpr std::size_t most_in_block = 512;
    using Numbers = std::array<ExactSum, most_in_block>;

    bool find_channels() {
        const std::size_t bins = film_.bin_count(), channels = film_.sum_count();
        for (int i = 0; i < 4; ++i) {  // dropped, counts of both halves, squares
            if (!find(numbers_)) return false;
        }
        for (std::size_t i = 0; i < bins; ++i) {
            if (!find(weights_)) return false;
            for (std::size_t c = 0; c < channels; ++c) {
                if (c == alpha_channel) {
                    const std::optional<std::uint8_t> alpha = packed_.take_byte();
                    if (!alpha) return false;
                    if (*alpha == static_cast<std::uint8_t>(AlphaSums::weights)) {
                        sums_.emplace_back();
                        continue;
                    }
                }
                if (!find(sums_)) return false;
            }
        }
        return packed_.at_end();
    }

    template <typename List>
    bool find(List& list) {
        const std::optional<PackedSums> channel = packed_.take(pixels_.size());
        if (channel) list.push_back(*channel);
        return channel.has_value();
    }

    bool add_block(PixelRange block) {
        bool right = add_numbers(numbers_[0], block, film_.dropped(), 1, 0);
        for (const std::size_t half : {0u, 1u}) {
            right = right && add_numbers(numbers_[1 + half], block, film_.counts(), 2, half);
        }
        right = right &&
                numbers_[3].add_to({.first = &film_.squares()[block.begin], .count = block.size()});
        for (std::size_t bin = 0; bin < film_.bin_count() && right; ++bin) {
            right = add_bin(block, bin);
        }
        return right;
    }

    template <typename Integer>
    bool add_numbers(PackedSums& packed, PixelRange block, std::span<Integer> numbers,
                     std::size_t stride, std::size_t first) {
        std::fill_n(block_numbers_.begin(), block.size(), ExactSum());
        if (!packed.add_to({.first = block_numbers_.data(), .count = block.size()})) return false;
        for (std::size_t i = 0; i < block.size(); ++i) {
            numbers[(block.begin + i) * stride + first] +=
                static_cast<Integer>(static_cast<std::int64_t>(block_numbers_[i].high) +
                                     static_cast<std::int64_t>(block_numbers_[i].low));
        }
        return true;
    }

    bool add_bin(PixelRange block, std::size_t bin) {
        const std::size_t bins = film_.bin_count(), channels = film_.sum_count();
        if (!add_numbers(weights_[bin], block, film_.weights(), bins, bin)) return false;
        for (std::size_t c = 0; c < channels; ++c) {
            const SumsOf<ExactSum> sums = {
                .first = &film_.sums()[(block.begin * bins + bin) * channels + c],
                .count = block.size(),
                .stride = bins * channels};
            std::optional<PackedSums>& packed = sums_[bin * channels + c];
            if (!packed) {
                add_sums(block_numbers_.data(), sums);
            } else if (!packed->add_to(sums)) {
                return false;
            }
        }
        return true;
    }

    PackedSums packed_;
    PixelRange pixels_;
    FilmState& film_;
    std::vector<PackedSums> numbers_, weights_;    ///< the latter for each bin
    std::vector<std::optional<PackedSums>> sums_;  ///< bins · channels; nothing: as the weights
    Numbers block_numbers_;
};

std::string hex(std::uint64_t value) { return fmt::format("{:016x}", value); }

std::vector<std::string> split(const std::string& text) {
    std::vector<std::string> words;
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = std::min(text.find(',', begin), text.size());
        words.push_back(text.substr(begin, end - begin));
        begin = end + 1;
    }
    return words;
}

class MetadataReader {
public:
    MetadataReader(const Metadata& metadata, const fs::path& path)
        : metadata_(metadata), path_(path) {}

    template <typename T>
    T value(const char* name) const {
        const auto found = metadata_.find(name);
        const T* value = found == metadata_.end() ? nullptr : std::get_if<T>(&found->second);
        if (!value) fail();
        return *value;
    }

    std::uint64_t number(const char* name, int base) const {
        return number_of(value<std::string>(name), base);
    }

    /// Numbers between commas; none in an empty text.
    std::set<std::uint64_t> numbers(const char* name, int base) const {
        std::set<std::uint64_t> result;
        for (const std::string& text : split(value<std::string>(name))) {
            result.insert(number_of(text, base));
        }
        return result;
    }

    [[noreturn]] void fail() const {
        throw FileError(
            fmt::format("{} is not the state of a render; give a file that "
                        "`lucerna render --checkpoint` or `--part` wrote",
                        path_.string()));
    }

private:
    std::uint64_t number_of(const std::string& text, int base) const {
        std::uint64_t result = 0;
        const char* end = text.data() + text.size();
        const auto [stop, error] = std::from_chars(text.data(), end, result, base);
        if (error != std::errc() || stop != end) fail();
        return result;
    }

    const Metadata& metadata_;
    const fs::path& path_;
};

PartRecord read_part(const MetadataReader& reader) {
    const auto ranges = [&](const char* name) {
        const std::optional<SampleRanges> set =
            SampleRanges::parse(reader.value<std::string>(name));
        if (!set) reader.fail();
        return *set;
    };
    return {.samples = ranges("lucerna:samples"),
            .uneven = reader.value<int>("lucerna:uneven") != 0,
            .planned = ranges("lucerna:planned_samples"),
            .all_samples = reader.number("lucerna:all_samples", 10),
            .time_limit = reader.value<double>("lucerna:time_limit"),
            .parts = reader.value<int>("lucerna:parts"),
            .begin = reader.value<double>("lucerna:begin_time"),
            .end = reader.value<double>("lucerna:end_time"),
            .scene = reader.value<std::string>("lucerna:scene"),
            .integrator = reader.value<std::string>("lucerna:integrator"),
            .light_sampler = reader.value<std::string>("lucerna:light_sampler"),
            .film = reader.value<std::string>("lucerna:film"),
            .roundings = reader.numbers("lucerna:roundings", 16)};
}

void write_part(const PartRecord& part, Metadata& metadata) {
    metadata["lucerna:samples"] = part.samples.text();
    metadata["lucerna:uneven"] = part.uneven ? 1 : 0;
    metadata["lucerna:planned_samples"] = part.planned.text();
    metadata["lucerna:all_samples"] = std::to_string(part.all_samples);
    metadata["lucerna:time_limit"] = part.time_limit;
    metadata["lucerna:parts"] = part.parts;
    metadata["lucerna:begin_time"] = part.begin;
    metadata["lucerna:end_time"] = part.end;
    metadata["lucerna:scene"] = part.scene;
    metadata["lucerna:integrator"] = part.integrator;
    metadata["lucerna:light_sampler"] = part.light_sampler;
    metadata["lucerna:film"] = part.film;
    std::vector<std::string> roundings;
    for (const std::uint64_t rounding : part.roundings) roundings.push_back(hex(rounding));
    metadata["lucerna:roundings"] = join(roundings, ",");
}

void write_layout(const FilmLayout& layout, Metadata& metadata) {
    metadata["lucerna:layers"] = join(layout.layers, ",");
    metadata["lucerna:crop_x"] = layout.crop.offset.x;
    metadata["lucerna:crop_y"] = layout.crop.offset.y;
    metadata["lucerna:crop_width"] = layout.crop.size.x;
    metadata["lucerna:crop_height"] = layout.crop.size.y;
    metadata["lucerna:unfiltered"] = layout.unfiltered ? 1 : 0;
    metadata["lucerna:block"] = layout.block;
    metadata["lucerna:filter_reach"] = layout.reach;
    metadata["lucerna:negative_weight"] = layout.negative_weight;
    metadata["lucerna:noise_correlation"] = layout.noise_correlation;
    metadata["lucerna:chance_luminance"] = layout.chance_luminance;
}

/// Layout of a file whose picture has this size and place.
FilmLayout read_layout(const MetadataReader& reader, const ImageFile& file) {
    const FilmLayout layout = {
        .full_size = {file.full_width, file.full_height},
        .crop = {.offset = {reader.value<int>("lucerna:crop_x"),
                            reader.value<int>("lucerna:crop_y")},
                 .size = {reader.value<int>("lucerna:crop_width"),
                          reader.value<int>("lucerna:crop_height")}},
        .layers = split(reader.value<std::string>("lucerna:layers")),
        .unfiltered = reader.value<int>("lucerna:unfiltered") != 0,
        .block = reader.value<int>("lucerna:block"),
        .reach = reader.value<int>("lucerna:filter_reach"),
        .negative_weight = reader.value<double>("lucerna:negative_weight"),
        .noise_correlation = reader.value<double>("lucerna:noise_correlation"),
        .chance_luminance = reader.value<double>("lucerna:chance_luminance")};
    if (layout.block < 1 || layout.block > 16) reader.fail();
    const auto inside = [](Vector2i begin, Vector2i size, Vector2i full) {
        return begin.x >= 0 && begin.y >= 0 && size.x > 0 && size.y > 0 &&
               size.x <= full.x - begin.x && size.y <= full.y - begin.y;
    };
    if (!(layout.reach >= 0 && layout.reach < 1 << 16) ||
        !inside(layout.crop.offset, layout.crop.size, layout.full_size)) {
        reader.fail();
    }
    const CropWindow sampled = layout.sampled();
    if (sampled.offset != Vector2i(file.x, file.y) ||
        sampled.size != Vector2i(file.width, file.height)) {
        reader.fail();
    }
    return layout;
}

/// Before all else: other versions may have written other things.
void check_version(const MetadataReader& reader, const fs::path& path) {
    const int format = reader.value<int>("lucerna:state");
    const auto version = reader.value<std::string>("lucerna:version");
    if (format == state_format && version == core_version()) return;
    throw VersionError(
        fmt::format("{} was written by Lucerna {} with version {} of its states; this is Lucerna "
                    "{} with version {}, which cannot continue it; render it again",
                    path.string(), version, format, core_version(), state_format));
}

/// The OpenEXR file, with all that is known of the state.
std::string picture_of(const FilmState& film, const RenderIdentity& identity, double seconds,
                       PartRecord part) {
    const std::uint64_t complete = film.complete_samples();
    if (part.samples.empty()) {
        const std::uint64_t first = film.first_sample();
        part.samples = SampleRanges({.begin = first, .end = first + complete});
    }
    part.uneven = film.most_samples() != complete;
    ImageFile file = film.resolve(film.layout().sampled());
    Metadata& metadata = file.metadata;
    metadata["lucerna:state"] = state_format;
    metadata["lucerna:version"] = core_version();
    metadata["lucerna:scene_hash"] = hex(identity.scene_hash);
    metadata["lucerna:seed"] = std::to_string(identity.seed);
    metadata["lucerna:first_sample"] = std::to_string(film.first_sample());
    metadata["lucerna:render_seconds"] = seconds;
    write_layout(film.layout(), metadata);
    write_part(part, metadata);
    return encode_exr(file);
}

}  // namespace

VersionError::~VersionError() = default;

void write_state(const fs::path& path, const FilmState& film, const RenderIdentity& identity,
                 double seconds, const PartRecord& part) {
    std::vector<std::string> bands(band_count_of(film.layout()));
    std::vector<BandEntry> index(bands.size());
    Workers().run(std::ssize(bands), [&](std::int64_t i) {
        const auto band = static_cast<std::size_t>(i);
        bands[band] = packed_band(film, pixels_of_band(film.layout(), band));
        index[band] = {.size = bands[band].size(), .hash = hash_of_bytes(as_bytes(bands[band]))};
    });
    std::string file = picture_of(film, identity, seconds, part);
    const StateTrailer trailer = {.picture_size = file.size(),
                                  .band_count = index.size(),
                                  .hash = hash_of_index(as_bytes(file), index),
                                  .magic = state_magic};
    for (std::string& band : bands) {
        file += band;
        band = std::string();
    }
    file.append(reinterpret_cast<const char*>(index.data()), index.size() * sizeof(BandEntry));
    file.append(reinterpret_cast<const char*>(&trailer), sizeof trailer);
    write_file_atomically(path, file);
}

StateFile::StateFile(const fs::path& path) : path_(path), file_(path) {
    StateTrailer trailer;
    if (file_.size() > sizeof trailer) {
        file_.read(file_.size() - sizeof trailer, as_bytes_of(&trailer, 1));
    }
    const std::uint64_t rest = file_.size() - std::min(file_.size(), sizeof trailer);
    const bool has_trailer =
        trailer.magic == state_magic && trailer.picture_size <= rest &&
        trailer.band_count <= (rest - trailer.picture_size) / sizeof(BandEntry);
    std::vector<std::uint8_t> picture(has_trailer ? trailer.picture_size : file_.size());
    file_.read(0, picture);
    read_header(picture);
    if (!has_trailer || trailer.band_count != band_count_of(layout_)) fail_damaged();
    std::vector<BandEntry> index(trailer.band_count);
    const std::uint64_t index_begin = rest - index.size() * sizeof(BandEntry);
    file_.read(index_begin, as_bytes_of(index.data(), index.size()));
    if (hash_of_index(picture, index) != trailer.hash) fail_damaged();
    std::uint64_t offset = trailer.picture_size;
    for (const BandEntry& band : index) {
        bands_.push_back({.offset = offset, .size = band.size, .hash = band.hash});
        offset += band.size;
    }
    if (offset != index_begin) fail_damaged();
}

void StateFile::read_header(std::span<const std::uint8_t> picture) {
    const ImageFile file = decode_exr_header(picture, path_.string());
    const MetadataReader reader(file.metadata, path_);
    check_version(reader, path_);
    layout_ = read_layout(reader, file);
    first_sample_ = reader.number("lucerna:first_sample", 10);
    identity_ = {.scene_hash = reader.number("lucerna:scene_hash", 16),
                 .seed = reader.number("lucerna:seed", 10)};
    seconds_ = reader.value<double>("lucerna:render_seconds");
    part_ = read_part(reader);
}

void StateFile::add_band(std::size_t band, FilmState& film) const {
    const Band& entry = bands_[band];
    // Reused, since pages that are new to a process take longer than all else.
    thread_local std::vector<std::uint8_t> bytes;
    bytes.resize(std::max<std::size_t>(bytes.size(), entry.size));
    const std::span<std::uint8_t> read = std::span(bytes).first(entry.size);
    file_.read(entry.offset, read);
    if (hash_of_bytes(read) != entry.hash) fail_damaged();
    if (!BandAdder(read, pixels_of_band(layout_, band), film).add()) fail_damaged();
}

void StateFile::fail_damaged() const {
    throw FileError(
        fmt::format("{} is damaged: its checksum does not match; get it again, or render it again",
                    path_.string()));
}

std::string rounding_warning(const PartRecord& part) {
    if (part.roundings.size() < 2) return "";
    return fmt::format(
        "warning: the samples come from {} kinds of processors, which do not round alike: the "
        "picture is right, but its bits are those of none of them\n",
        part.roundings.size());
}

RenderState read_state(const fs::path& path) {
    const StateFile file(path);
    RenderState state = {.film = FilmState(file.layout(), file.first_sample()),
                         .identity = file.identity(),
                         .seconds = file.seconds(),
                         .part = file.part()};
    Workers().run(static_cast<std::int64_t>(file.band_count()), [&](std::int64_t band) {
        file.add_band(static_cast<std::size_t>(band), state.film);
    });
    return state;
}

void check_continues(const RenderState& state, const FilmLayout& layout,
                     const RenderIdentity& identity, const fs::path& path) {
    const FilmLayout& old = state.film.layout();
    const auto refuse = [&](const std::string& what) {
        throw Error(
            fmt::format("cannot resume from {}: {}; render again without --resume, or with "
                        "another --checkpoint file",
                        path.string(), what));
    };
    if (old.full_size != layout.full_size) {
        refuse(fmt::format("it is {} × {} pixels, the scene {} × {}", old.full_size.x,
                           old.full_size.y, layout.full_size.x, layout.full_size.y));
    }
    if (!(old.crop == layout.crop)) refuse("it has another crop window");
    if (old.layers != layout.layers) {
        refuse(fmt::format("it has the layers [{}], the scene [{}]", join(old.layers),
                           join(layout.layers)));
    }
    if (old.reach != layout.reach || old.negative_weight != layout.negative_weight ||
        old.noise_correlation != layout.noise_correlation) {
        refuse("it has another filter");
    }
    if (state.identity.seed != identity.seed) {
        refuse(fmt::format("it was rendered with --seed {}, not {}", state.identity.seed,
                           identity.seed));
    }
    if (state.identity.scene_hash != identity.scene_hash) {
        refuse("it belongs to another scene, or the scene or its --set and -D values have changed");
    }
}

}  // namespace lucerna
