// SPDX-License-Identifier: Apache-2.0
#include "core/render/state_file.h"

#include "core/image/exr.h"
#include "core/math/sequences.h"
#include "core/plugin/error.h"
#include "core/plugin/registry.h"

#include <fmt/format.h>

#include <bit>
#include <charconv>
#include <cstddef>
#include <cstring>
#include <type_traits>

namespace lucerna {

namespace fs = std::filesystem;

namespace {

static_assert(std::endian::native == std::endian::little, "the order of words in a state file");
static_assert(sizeof(ExactSum) == 16, "a sum is four words");

constexpr int state_format = 4;
constexpr const char* word_names[4] = {"high0", "high1", "low0", "low1"};

/// Calls visit(name, first, stride) for every plane of the state in a fixed order: the plane's
/// 32-bit words lie at `first`, `first` + `stride`, … bytes.
template <typename State, typename Visit>
void visit_planes(State& film, const Visit& visit) {
    using Byte = std::conditional_t<std::is_const_v<State>, const std::byte, std::byte>;
    const std::size_t sum_count = film.sum_count();
    std::vector<std::string> names = film.channel_names();
    if (film.layout().unfiltered) {
        for (const char* color : {"R", "G", "B"})
            names.push_back(fmt::format("unfiltered.{}", color));
    }
    auto* sums = reinterpret_cast<Byte*>(film.sums().data());
    auto* weights = reinterpret_cast<Byte*>(film.weights().data());
    auto* counts = reinterpret_cast<Byte*>(film.counts().data());
    visit("state.dropped", reinterpret_cast<Byte*>(film.dropped().data()), std::size_t{4});
    visit("state.even.samples", counts, std::size_t{8});
    visit("state.odd.samples", counts + 4, std::size_t{8});
    auto* squares = reinterpret_cast<Byte*>(film.squares().data());
    for (std::size_t word = 0; word < 4; ++word) {
        visit(fmt::format("state.squares.{}", word_names[word]), squares + 4 * word,
              sizeof(ExactSum));
    }
    const std::size_t bins = film.bin_count();
    for (std::size_t bin = 0; bin < bins; ++bin) {
        const std::string name =
            fmt::format("state.{}{}", bin & 1 ? "odd" : "even", bin & 2 ? ".negative" : "");
        visit(name + ".weight0", weights + 8 * bin, 8 * bins);
        visit(name + ".weight1", weights + 8 * bin + 4, 8 * bins);
        for (std::size_t sum = 0; sum < sum_count; ++sum) {
            for (std::size_t word = 0; word < 4; ++word) {
                visit(fmt::format("{}.{}.{}", name, names[sum], word_names[word]),
                      sums + 16 * (bin * sum_count + sum) + 4 * word, 16 * bins * sum_count);
            }
        }
    }
}

/// What the planes do not say.
struct Header {
    std::string version, layers;
    std::uint64_t scene_hash, seed, first_sample;
    CropWindow crop;
    bool unfiltered;
    int block, reach;
    double negative_weight, noise_correlation, seconds;
    PartRecord part;

    /// Not of the times: two states with the same sums have the same checksum.
    std::uint64_t hash() const {
        std::uint64_t h =
            hash64({scene_hash, seed, first_sample, std::bit_cast<std::uint64_t>(negative_weight),
                    std::bit_cast<std::uint64_t>(noise_correlation), unfiltered,
                    static_cast<std::uint64_t>(block), static_cast<std::uint64_t>(reach)});
        for (const int x : {crop.offset.x, crop.offset.y, crop.size.x, crop.size.y}) {
            h = hash_combine(h, static_cast<std::uint64_t>(x));
        }
        h = hash_combine(h, part.all_samples);
        const std::string texts = join(
            {version, layers, part.samples.text(), part.planned.text(), part.integrator, part.film},
            "\n");
        for (const char c : texts) {
            h = hash_combine(h, static_cast<unsigned char>(c));
        }
        return h;
    }
};

std::uint64_t checksum(std::uint64_t h, std::span<const std::uint32_t> words) {
    for (std::size_t i = 0; i + 1 < words.size(); i += 2) {
        h = hash_combine(h, std::uint64_t{words[i]} << 32 | words[i + 1]);
    }
    return words.size() % 2 == 0 ? h : hash_combine(h, words.back());
}

std::string hex(std::uint64_t value) { return fmt::format("{:016x}", value); }

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
        const auto text = value<std::string>(name);
        std::uint64_t result = 0;
        const char* end = text.data() + text.size();
        const auto [stop, error] = std::from_chars(text.data(), end, result, base);
        if (error != std::errc() || stop != end) fail();
        return result;
    }

    [[noreturn]] void fail() const {
        throw FileError(
            fmt::format("{} is not the state of a render; give a file that "
                        "`lucerna render --checkpoint` wrote",
                        path_.string()));
    }

private:
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
            .planned = ranges("lucerna:planned_samples"),
            .all_samples = reader.number("lucerna:all_samples", 10),
            .time_limit = reader.value<double>("lucerna:time_limit"),
            .parts = reader.value<int>("lucerna:parts"),
            .begin = reader.value<double>("lucerna:begin_time"),
            .end = reader.value<double>("lucerna:end_time"),
            .scene = reader.value<std::string>("lucerna:scene"),
            .integrator = reader.value<std::string>("lucerna:integrator"),
            .light_sampler = reader.value<std::string>("lucerna:light_sampler"),
            .film = reader.value<std::string>("lucerna:film")};
}

void write_part(const PartRecord& part, Metadata& metadata) {
    metadata["lucerna:samples"] = part.samples.text();
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
}

Header read_header(const MetadataReader& reader) {
    return {.version = reader.value<std::string>("lucerna:version"),
            .layers = reader.value<std::string>("lucerna:layers"),
            .scene_hash = reader.number("lucerna:scene_hash", 16),
            .seed = reader.number("lucerna:seed", 10),
            .first_sample = reader.number("lucerna:first_sample", 10),
            .crop = {.offset = {reader.value<int>("lucerna:crop_x"),
                                reader.value<int>("lucerna:crop_y")},
                     .size = {reader.value<int>("lucerna:crop_width"),
                              reader.value<int>("lucerna:crop_height")}},
            .unfiltered = reader.value<int>("lucerna:unfiltered") != 0,
            .block = reader.value<int>("lucerna:block"),
            .reach = reader.value<int>("lucerna:filter_reach"),
            .negative_weight = reader.value<double>("lucerna:negative_weight"),
            .noise_correlation = reader.value<double>("lucerna:noise_correlation"),
            .seconds = reader.value<double>("lucerna:render_seconds"),
            .part = read_part(reader)};
}

void write_header(const Header& header, Metadata& metadata) {
    metadata["lucerna:state"] = state_format;
    metadata["lucerna:version"] = header.version;
    metadata["lucerna:layers"] = header.layers;
    metadata["lucerna:scene_hash"] = hex(header.scene_hash);
    metadata["lucerna:seed"] = std::to_string(header.seed);
    metadata["lucerna:first_sample"] = std::to_string(header.first_sample);
    metadata["lucerna:crop_x"] = header.crop.offset.x;
    metadata["lucerna:crop_y"] = header.crop.offset.y;
    metadata["lucerna:crop_width"] = header.crop.size.x;
    metadata["lucerna:crop_height"] = header.crop.size.y;
    metadata["lucerna:unfiltered"] = header.unfiltered ? 1 : 0;
    metadata["lucerna:block"] = header.block;
    metadata["lucerna:filter_reach"] = header.reach;
    metadata["lucerna:negative_weight"] = header.negative_weight;
    metadata["lucerna:noise_correlation"] = header.noise_correlation;
    metadata["lucerna:render_seconds"] = header.seconds;
    write_part(header.part, metadata);
}

/// Before all else: other versions may have written other things.
void check_version(const MetadataReader& reader, const fs::path& path) {
    const auto version = reader.value<std::string>("lucerna:version");
    const int format = reader.value<int>("lucerna:state");
    if (format == state_format && version == core_version()) return;
    throw VersionError(
        fmt::format("{} was written by Lucerna {} in version {} of its states; this is {} with "
                    "version {}: images of two versions cannot be continued; render it again",
                    path.string(), version, format, core_version(), state_format));
}

std::vector<std::string> split(const std::string& text) {
    std::vector<std::string> words;
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = std::min(text.find(',', begin), text.size());
        words.push_back(text.substr(begin, end - begin));
        begin = end + 1;
    }
    return words;
}

}  // namespace

void write_state(const fs::path& path, const FilmState& film, const RenderIdentity& identity,
                 double seconds, const PartRecord& part) {
    const Header header = {.version = core_version(),
                           .layers = join(film.layout().layers, ","),
                           .scene_hash = identity.scene_hash,
                           .seed = identity.seed,
                           .first_sample = film.first_sample(),
                           .crop = film.layout().crop,
                           .unfiltered = film.layout().unfiltered,
                           .block = film.layout().block,
                           .reach = film.layout().reach,
                           .negative_weight = film.layout().negative_weight,
                           .noise_correlation = film.layout().noise_correlation,
                           .seconds = seconds,
                           .part = part};
    ImageFile file = film.resolve(film.layout().sampled());
    write_header(header, file.metadata);
    std::uint64_t sum = header.hash();
    visit_planes(film, [&](const std::string& name, const std::byte* first, std::size_t stride) {
        std::vector<std::uint32_t> words(film.dropped().size());
        for (std::size_t i = 0; i < words.size(); ++i) {
            std::memcpy(&words[i], first + i * stride, 4);
        }
        sum = checksum(sum, words);
        file.planes.push_back({.name = name, .samples = std::move(words)});
    });
    file.metadata["lucerna:checksum"] = hex(sum);
    write_exr(path, file);
}

RenderState read_state(const fs::path& path) {
    const ImageFile file = read_exr(path);
    const MetadataReader reader(file.metadata, path);
    check_version(reader, path);
    const Header header = read_header(reader);
    const FilmLayout layout = {.full_size = {file.full_width, file.full_height},
                               .crop = header.crop,
                               .layers = split(header.layers),
                               .unfiltered = header.unfiltered,
                               .block = header.block,
                               .reach = header.reach,
                               .negative_weight = header.negative_weight,
                               .noise_correlation = header.noise_correlation};
    if (layout.block < 1 || layout.block > 16) reader.fail();
    const CropWindow sampled = layout.sampled();
    const auto inside = [](Vector2i begin, Vector2i size, Vector2i full) {
        return begin.x >= 0 && begin.y >= 0 && size.x > 0 && size.y > 0 &&
               size.x <= full.x - begin.x && size.y <= full.y - begin.y;
    };
    if (!(layout.reach >= 0 && layout.reach < 1 << 16) ||
        !inside(layout.crop.offset, layout.crop.size, layout.full_size) ||
        sampled.offset != Vector2i(file.x, file.y) ||
        sampled.size != Vector2i(file.width, file.height)) {
        reader.fail();
    }
    RenderState state = {.film = FilmState(layout, header.first_sample),
                         .identity = {header.scene_hash, header.seed},
                         .seconds = header.seconds,
                         .part = header.part};
    std::uint64_t sum = header.hash();
    visit_planes(state.film, [&](const std::string& name, std::byte* first, std::size_t stride) {
        const Plane* plane = file.plane(name);
        const auto* words =
            plane ? std::get_if<std::vector<std::uint32_t>>(&plane->samples) : nullptr;
        if (!words || words->size() != state.film.dropped().size()) reader.fail();
        for (std::size_t i = 0; i < words->size(); ++i) {
            std::memcpy(first + i * stride, &(*words)[i], 4);
        }
        sum = checksum(sum, *words);
    });
    if (sum != reader.number("lucerna:checksum", 16)) {
        throw FileError(
            fmt::format("{} is damaged: its checksum does not match; use an older copy "
                        "or render again without --resume",
                        path.string()));
    }
    return state;
}

VersionError::~VersionError() = default;

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
