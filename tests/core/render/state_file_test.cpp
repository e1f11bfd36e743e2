// SPDX-License-Identifier: Apache-2.0
/// Checkpoints: exact, viewable, and refused if damaged or foreign.
#include "core/render/state_file.h"

#include "core/base/atomic_file.h"
#include "core/base/error.h"
#include "core/base/file_bytes.h"
#include "core/image/exr.h"
#include "core/math/sequences.h"
#include "tests/core/render/films.h"
#include "tests/paths.h"

#include <gtest/gtest.h>

namespace lucerna {
namespace {

const RenderIdentity identity = {.scene_hash = 0xfedcba9876543210, .seed = 0x8000000000000001};

/// A film with a crop window, layers, negative lobes, what is unfiltered, dropped samples, and
/// pixels of different numbers of samples.
FilmState rich_film() {
    FilmState film({.full_size = {20, 10},
                    .crop = {{3, 2}, {6, 5}},
                    .layers = {"albedo.R", "depth.Z"},
                    .unfiltered = true,
                    .reach = 3,
                    .negative_weight = 0.125,
                    .noise_correlation = 1.125,
                    .chance_luminance = 0.3},
                   12345678901);
    const ReconstructionFilter filter(lanczos_filter());
    Rng rng(1);
    for (std::size_t pixel = 0; pixel < film.dropped().size(); ++pixel) {
        for (std::size_t i = 0; i < 10 + pixel % 3; ++i) {
            PixelSample sample = grey_sample(1 / (rng.next_float() + 1e-6f));
            if (pixel == 7 && i == 3) sample.radiance.z = infinity;
            float layers[2] = {rng.next_float(), rng.next_float() - 0.5f};
            sample.layers = layers;
            sample.unfiltered = Color(rng.next_float());
            add_sample(film, pixel, sample, filter, rng.next_float2());
        }
    }
    return film;
}

class StateFile : public testing::Test {
protected:
    void damage(std::size_t byte, unsigned char mask) {
        std::vector<std::uint8_t> bytes = read_file_bytes(path);
        bytes[byte] = static_cast<std::uint8_t>(bytes[byte] ^ mask);
        write_file_atomically(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    }

    TemporaryFolder folder;
    std::filesystem::path path = folder / "state.exr";
    FilmState film = rich_film();
};

TEST_F(StateFile, N10_N15_holds_every_bit) {
    write_state(path, film, identity, 12.5);
    const RenderState read = read_state(path);
    EXPECT_TRUE(same_bits(film, read.film));
    EXPECT_EQ(read.film.first_sample(), film.first_sample());
    EXPECT_EQ(read.film.dropped_samples(), 1u);
    EXPECT_EQ(read.film.layout().layers, film.layout().layers);
    EXPECT_EQ(read.identity.scene_hash, identity.scene_hash);
    EXPECT_EQ(read.identity.seed, identity.seed);
    EXPECT_EQ(read.seconds, 12.5);
}

TEST_F(StateFile, is_a_picture) {
    write_state(path, film, identity, 0);
    const ImageFile file = read_exr(path);
    const auto* red = std::get_if<std::vector<float>>(&file.plane("R")->samples);
    ASSERT_NE(red, nullptr);
    // The picture has the margin, too.
    const CropWindow sampled = film.layout().sampled();
    EXPECT_EQ(Vector2i(file.x, file.y), sampled.offset);
    EXPECT_EQ(Vector2i(file.width, file.height), sampled.size);
    const Vector2i first = film.layout().crop.offset - sampled.offset;
    EXPECT_EQ((*red)[static_cast<std::size_t>(first.x + first.y * sampled.size.x)],
              static_cast<float>(film.mean(0, 0)));
    EXPECT_NE(file.plane("depth.Z"), nullptr);
}

TEST_F(StateFile, L10_damage_is_noticed) {
    write_state(path, film, identity, 0);
    const std::size_t size = read_file_bytes(path).size();
    Rng rng(2);
    for (int i = 0; i < 300; ++i) {
        const std::size_t byte = rng.next_uint() % size;
        const auto mask = static_cast<unsigned char>(1u << (i % 8));
        damage(byte, mask);
        EXPECT_THROW(read_state(path), Error) << "byte " << byte;
        damage(byte, mask);
    }
    EXPECT_TRUE(same_bits(film, read_state(path).film));
}

TEST_F(StateFile, L8_truncation_is_noticed) {
    write_state(path, film, identity, 0);
    const std::vector<std::uint8_t> bytes = read_file_bytes(path);
    for (std::size_t length = 0; length < bytes.size(); length += 97) {
        write_file_atomically(path, {reinterpret_cast<const char*>(bytes.data()), length});
        EXPECT_THROW(read_state(path), FileError) << length << " bytes";
    }
}

TEST_F(StateFile, refuses_an_ordinary_picture) {
    write_exr(path, film.resolve());
    EXPECT_THROW(read_state(path), FileError);
}

TEST_F(StateFile, HoldsWhichPartItIs) {
    PartRecord part;
    part.samples.add({.begin = 5, .end = 15});
    part.samples.add({.begin = 20, .end = 25});
    part.planned.add({.begin = 5, .end = 40});
    part.all_samples = 1234567890123;
    part.time_limit = 2.5;
    part.parts = 7;
    part.begin = 1e9 + 0.25;
    part.end = 2e9 + 0.75;
    part.scene = "a scene.xml";
    part.integrator = "path";
    part.light_sampler = "cache";
    part.film = "hdrfilm\npixel_format=rgba";
    part.roundings = {1, 0xfedcba9876543210};
    write_state(path, film, identity, 0, part);
    const PartRecord read = lucerna::StateFile(path).part();
    EXPECT_EQ(read.samples, part.samples);
    EXPECT_EQ(read.planned, part.planned);
    EXPECT_TRUE(read.uneven);  // its pixels have 10, 11 or 12 samples
    EXPECT_EQ(read.all_samples, part.all_samples);
    EXPECT_EQ(read.time_limit, part.time_limit);
    EXPECT_EQ(read.parts, part.parts);
    EXPECT_EQ(read.begin, part.begin);
    EXPECT_EQ(read.end, part.end);
    EXPECT_EQ(read.scene, part.scene);
    EXPECT_EQ(read.integrator, part.integrator);
    EXPECT_EQ(read.light_sampler, part.light_sampler);
    EXPECT_EQ(read.film, part.film);
    EXPECT_EQ(read.roundings, part.roundings);
}

TEST_F(StateFile, N13_refuses_another_version) {
    write_state(path, film, identity, 0);
    ImageFile file = read_exr(path);
    file.metadata["lucerna:version"] = "0.0.1";
    write_exr(path, file);
    try {
        read_state(path);
        FAIL();
    } catch (const FileError& e) {
        EXPECT_NE(std::string(e.what()).find("0.0.1"), std::string::npos) << e.what();
    }
}

TEST_F(StateFile, N13_refuses_another_render_and_says_why) {
    const RenderState state = {.film = film, .identity = identity, .seconds = 0};
    const auto refusal = [&](const FilmLayout& layout, const RenderIdentity& other) {
        try {
            check_continues(state, layout, other, "checkpoint.exr");
            return std::string();
        } catch (const Error& e) {
            return std::string(e.what());
        }
    };
    const auto expect = [&](const FilmLayout& layout, const RenderIdentity& other,
                            const char* words) {
        EXPECT_NE(refusal(layout, other).find(words), std::string::npos) << refusal(layout, other);
    };
    EXPECT_EQ(refusal(film.layout(), identity), "");
    expect(film.layout(), {identity.scene_hash, 1}, "--seed");
    expect(film.layout(), {1, identity.seed}, "another scene");
    FilmLayout layout = film.layout();
    layout.full_size.x = 21;
    expect(layout, identity, "20 × 10 pixels, the scene 21 × 10");
    layout = film.layout();
    layout.crop.offset.x = 0;
    expect(layout, identity, "crop window");
    layout = film.layout();
    layout.layers.pop_back();
    expect(layout, identity, "albedo.R, depth.Z");
}

}  // namespace
}  // namespace lucerna
