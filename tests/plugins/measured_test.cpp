// SPDX-License-Identifier: Apache-2.0
/// Measured materials: files right and wrong, and what a microfacet model becomes as a measurement.
#include "core/base/error.h"
#include "core/math/sequences.h"
#include "core/math/warp.h"
#include "plugins/bsdfs/measured_material.h"
#include "plugins/bsdfs/tensor_file.h"
#include "tests/measured_writer.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace lucerna {
namespace {

using Bytes = std::vector<std::uint8_t>;

const TensorFields& small() {
    static const TensorFields fields =
        measured({}, {.phis = 1, .thetas = 3, .normals = 4, .samples = 4});
    return fields;
}

std::string refusal(const Bytes& bytes) {
    try {
        MeasuredMaterial(bytes, "a.bsdf");
        return "";
    } catch (const Error& error) {
        return error.what();
    }
}

/// The message if one field is another.
std::string refusal(const std::string& name, const TensorFieldData& field) {
    TensorFields fields = small();
    fields[name] = field;
    return refusal(tensor_bytes(fields));
}

/// The same if one number of a field is another.
std::string refusal(const std::string& name, std::size_t index, float number) {
    TensorFieldData field = small().at(name);
    std::memcpy(&field.bytes[index * sizeof number], &number, sizeof number);
    return refusal(name, field);
}

TEST(TensorFile, L19_what_is_wrong_is_named) {
    EXPECT_EQ(refusal(tensor_bytes(small())), "");
    EXPECT_EQ(refusal({}), "a.bsdf: this is not a tensor file, which begins with \"tensor_file\"");
    EXPECT_EQ(refusal(Bytes(100, 't')),
              "a.bsdf: this is not a tensor file, which begins with \"tensor_file\"");
    Bytes version = tensor_bytes(small());
    version[12] = 2;
    EXPECT_EQ(refusal(version), "a.bsdf: version 2.0 of the format cannot be read, only 1.0");
    EXPECT_EQ(refusal(tensor_bytes({})), "a.bsdf: there is no field \"phi_i\"; there are: none");
    EXPECT_EQ(refusal("sigma", {.type = 12, .shape = {4, 4}, .bytes = Bytes(64)}),
              "a.bsdf: field \"sigma\" has the type 12; there are 1 to 11");
    EXPECT_EQ(refusal("sigma", {.type = 11, .shape = {4, 4}, .bytes = Bytes(128)}),
              "a.bsdf: field \"sigma\" is of type float64, not float32");
    EXPECT_EQ(refusal("sigma", float_field({16}, std::vector<float>(16))),
              "a.bsdf: field \"sigma\" has the shape 16, not n × n, where n is 2 or more");
    EXPECT_EQ(refusal("vndf", float_field({1, 2, 4, 4}, std::vector<float>(32))),
              "a.bsdf: field \"vndf\" has the shape 1 × 2 × 4 × 4, not 1 × 3 × n × n, where n is "
              "2 or more");
    EXPECT_EQ(refusal("rgb", float_field({1, 3, 3, 4, 5}, std::vector<float>(180))),
              "a.bsdf: field \"rgb\" has the shape 1 × 3 × 3 × 4 × 5, not 1 × 3 × 3 × 4 × 4");
    EXPECT_EQ(refusal("theta_i", float_field({0}, {})),
              "a.bsdf: field \"theta_i\" has the shape 0, not one dimension of 1 or more");
    EXPECT_EQ(refusal("theta_i", float_field({3}, {0, 0.5f, 0.5f})),
              "a.bsdf: the numbers of field \"theta_i\" must rise, but 0.5 follows 0.5");
    EXPECT_EQ(refusal("phi_i", float_field({3}, {0, 1, 2})),
              "a.bsdf: field \"phi_i\" covers 114.6°; it must be a whole turn, a half or a "
              "quarter");
    TensorFields no_colors = small();
    no_colors.erase("rgb");
    EXPECT_EQ(refusal(tensor_bytes(no_colors)),
              "a.bsdf: there is no field \"wavelengths\"; there are: \"description\", "
              "\"jacobian\", \"luminance\", \"ndf\", \"phi_i\", \"sigma\", \"theta_i\", \"vndf\"");
}

TEST(TensorFile, L19_fields_that_lie_about_their_size_are_refused) {
    const std::uint64_t huge = std::uint64_t{1} << 62;
    const std::size_t size = tensor_bytes(small()).size() - small().at("vndf").bytes.size();
    const auto message = [&](const TensorFieldData& field) { return refusal("vndf", field); };
    EXPECT_TRUE(message({.shape = {1, 3, 4, 1000}, .bytes = {}})
                    .starts_with("a.bsdf: field \"vndf\", 1 × 3 × 4 × 1000 of type float32 from "))
        << message({.shape = {1, 3, 4, 1000}, .bytes = {}});
    EXPECT_TRUE(message({.shape = {1, 3, 4, 1000}, .bytes = {}})
                    .ends_with(fmt::format("goes beyond the end of the file of {} bytes", size)));
    for (const std::vector<std::uint64_t>& shape :
         {std::vector{huge, huge, huge, huge}, {1, 3, huge, 4}, {huge + 1, 4, 1, 1}}) {
        EXPECT_NE(message({.shape = shape, .bytes = {}}).find("goes beyond the end"),
                  std::string::npos);
    }
    // The head of the first field: count of fields, length of "description", number of dimensions.
    Bytes file = tensor_bytes(small());
    file[17] = 0xff;
    EXPECT_EQ(refusal(file), fmt::format("a.bsdf: the file ends after {} bytes, within its list of "
                                         "fields",
                                         file.size()));
}

TEST(TensorFile, L19_every_truncation_is_refused) {
    const Bytes file = tensor_bytes(small());
    for (std::size_t size = 0; size < file.size(); ++size) {
        const Bytes piece(file.begin(), file.begin() + static_cast<std::ptrdiff_t>(size));
        EXPECT_TRUE(refusal(piece).starts_with("a.bsdf: ")) << size;
    }
}

TEST(MeasuredMaterial, L20_numbers_without_a_meaning_are_refused) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(refusal("rgb", 7, nan), "a.bsdf: number 7 of field \"rgb\" is not finite: nan");
    EXPECT_EQ(refusal("ndf", 3, infinity), "a.bsdf: number 3 of field \"ndf\" is not finite: inf");
    EXPECT_EQ(refusal("vndf", 5, -1), "a.bsdf: number 5 of field \"vndf\" is negative: -1");
    EXPECT_EQ(refusal("theta_i", 0, nan),
              "a.bsdf: number 0 of field \"theta_i\" is not finite: nan");
    EXPECT_EQ(refusal("rgb", 7, -1), "");
    EXPECT_EQ(refusal("luminance", float_field({1, 3, 4, 4}, std::vector<float>(48))),
              "a.bsdf: all numbers of field \"luminance\" are zero for phi_i 0 and theta_i 0");
}

MeasuredMaterial made(const MicrofacetMaterial& material, const MeasuringGrid& grid) {
    return MeasuredMaterial(tensor_bytes(measured(material, grid)), "made.bsdf");
}

/// RMS error of the value over pairs of directions away from the horizon, over its RMS.
double error(const MicrofacetMaterial& material, const MeasuringGrid& grid) {
    const MeasuredMaterial copy = made(material, grid);
    Rng rng(3);
    double difference2 = 0, value2 = 0;
    for (int i = 0; i < 4000; ++i) {
        const Vector3 wi = square_to_uniform_hemisphere(rng.next_float2());
        const Vector3 wo = square_to_uniform_hemisphere(rng.next_float2());
        if (wi.z < 0.2f || wo.z < 0.2f) continue;
        const double value = material.f_cos(wi, wo);
        difference2 += sqr(static_cast<double>(copy.evaluate(wi, wo).f_cos.y) - value);
        value2 += sqr(value);
    }
    return std::sqrt(difference2 / value2);
}

/// With half the distance of nodes, at most half the error is left; for smooth tables much less.
TEST(MeasuredMaterial, approaches_the_model_that_was_measured) {
    const auto grid = [](int n) {
        return MeasuringGrid{.thetas = n, .normals = 4 * n, .samples = 4 * n};
    };
    const MicrofacetMaterial rough{.facets = {Microfacet::Type::ggx, 0.4f, 0.4f}};
    const double coarse = error(rough, grid(8)), fine = error(rough, grid(16));
    EXPECT_LT(coarse, 0.05);
    EXPECT_LT(fine, coarse / 2);
    // Brushed, measured over a quarter of a turn.
    const auto brushed_grid = [](int n) {
        return MeasuringGrid{
            .phis = n, .symmetry = 4, .thetas = n, .normals = 6 * n, .samples = 4 * n};
    };
    const MicrofacetMaterial brushed{.facets = {Microfacet::Type::ggx, 0.3f, 0.5f}};
    const double coarse2 = error(brushed, brushed_grid(5)), fine2 = error(brushed, brushed_grid(9));
    EXPECT_LT(coarse2, 0.1);
    EXPECT_LT(fine2, coarse2 / 2);
}

/// Symmetric files hold a part of what a full one holds.
TEST(MeasuredMaterial, a_quarter_of_a_turn_tells_the_rest) {
    const MicrofacetMaterial brushed{.facets = {Microfacet::Type::ggx, 0.3f, 0.5f}};
    MeasuringGrid grid{.phis = 33, .thetas = 9, .normals = 49, .samples = 32};
    const double whole = error(brushed, grid);
    for (const int symmetry : {2, 4}) {
        grid.phis = 32 / symmetry + 1;
        grid.symmetry = symmetry;
        EXPECT_LT(error(brushed, grid), 2 * whole) << symmetry;
        // Half a turn changes nothing; a mirror would change what is interpolated.
        const MeasuredMaterial part = made(brushed, grid);
        Rng rng(5);
        for (int i = 0; i < 100; ++i) {
            const Vector3 wi = square_to_uniform_hemisphere(rng.next_float2());
            const Vector3 wo = square_to_uniform_hemisphere(rng.next_float2());
            EXPECT_EQ(part.evaluate(wi, wo).f_cos,
                      part.evaluate({-wi.x, -wi.y, wi.z}, {-wo.x, -wo.y, wo.z}).f_cos);
        }
    }
}

TEST(MeasuredMaterial, spectra_become_rgb) {
    const MicrofacetMaterial grey{.reflectance = Color(0.4f)};
    MeasuringGrid grid{.thetas = 4, .normals = 16, .samples = 16};
    const MeasuredMaterial rgb = made(grey, grid);
    grid.spectral = true;
    const MeasuredMaterial spectral = made(grey, grid);
    Rng rng(6);
    for (int i = 0; i < 1000; ++i) {
        const Vector3 wi = square_to_uniform_hemisphere(rng.next_float2());
        const Vector3 wo = square_to_uniform_hemisphere(rng.next_float2());
        const Color a = rgb.evaluate(wi, wo).f_cos, b = spectral.evaluate(wi, wo).f_cos;
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(a[k], b[k], 1e-6f + 1e-5f * a[k]);
    }
}

TEST(BilinearWarp, C10_inverts_what_it_maps) {
    Rng rng(7);
    std::vector<float> values(2 * 5 * 7);
    for (float& x : values) x = rng.next_float() < 0.2f ? 0.0f : rng.next_float();
    const BilinearWarp warp(values, {.width = 5, .height = 7});
    const TableMix mix{.count = 2, .table = {0, 1}, .weight = {0.3, 0.7}};
    double sum = 0;
    constexpr int side = 200;
    for (int i = 0; i < side * side; ++i) {
        const Vector2d u((i % side + 0.5) / side, (i / side + 0.5) / side);
        const Vector2d p = warp.sample(mix, u);
        const BilinearWarp::Inverse back = warp.invert(mix, p);
        EXPECT_NEAR(back.u.x, u.x, 1e-6);
        EXPECT_NEAR(back.u.y, u.y, 1e-6);
        sum += warp.invert(mix, u).pdf;
    }
    EXPECT_NEAR(sum / (side * side), 1, 1e-4);
}

}  // namespace
}  // namespace lucerna
