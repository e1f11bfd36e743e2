// SPDX-License-Identifier: Apache-2.0
/// What every BSDF must satisfy, tried on all BSDF plugins that the registry finds, with defaults
/// and with parameters that are hard. A new plugin is tested unasked; only if it cannot be made
/// without a body does it need a line in `bodies`. D1, D3, … are cases of tests/cases.txt.
#include "core/interfaces/bsdf.h"
#include "core/description/xml_reader.h"
#include "core/image/png.h"
#include "core/math/fresnel.h"
#include "core/math/warp.h"
#include "core/scene/builder.h"
#include "plugins/commands/contracts/bsdf.h"
#include "tests/measured_writer.h"
#include "tests/paths.h"
#include "tests/statistics.h"
#include "tests/vol_writer.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <array>
#include <map>

namespace lucerna {
namespace {

using contracts::draw;
using contracts::viewers;

constexpr auto& modes = contracts::transport_modes;
constexpr Effort effort{.samples = 100000};

Interaction surface() { return contracts::bsdf_surface(); }
Vector3 direction(float cos_theta, float phi) { return contracts::local_direction(cos_theta, phi); }

/// Files that the bodies below refer to: a strongly tilted normal, a slope, and measurements.
const TemporaryFolder& images() {
    static const TemporaryFolder folder;
    [[maybe_unused]] static const bool written = [] {
        const auto rgb = [](int width, std::vector<std::uint8_t> pixels) {
            const int height = static_cast<int>(pixels.size()) / (3 * width);
            return Image8{.width = width, .height = height, .pixels = std::move(pixels)};
        };
        write_png(folder / "tilted.png", rgb(1, {200, 100, 200}));
        write_png(folder / "slope.png",
                  rgb(2, {0, 0, 0, 120, 120, 120, 60, 60, 60, 255, 255, 255}));
        write_png(folder / "grey.png", rgb(1, {102, 102, 102}));
        const auto write_measured = [](const char* name, const MicrofacetMaterial& material,
                                       const MeasuringGrid& grid) {
            write_bytes(folder / name, tensor_bytes(measured(material, grid)));
        };
        write_measured("copper.bsdf", {.reflectance = {0.9f, 0.6f, 0.5f}}, {});
        write_measured("brushed.bsdf", {.facets = {Microfacet::Type::ggx, 0.2f, 0.5f}},
                       {.phis = 5, .symmetry = 4, .thetas = 6, .spectral = true});
        write_measured("shiny.bsdf", {.facets = {Microfacet::Type::ggx, 0.1f, 0.15f}},
                       {.phis = 9, .thetas = 6, .normals = 40, .samples = 8});
        return true;
    }();
    return folder;
}

std::string image(const std::string& file, const std::string& name = "") {
    return fmt::format(
        "<texture type='bitmap' name='{}'><string name='filename' value='{}'/>"
        "<boolean name='raw' value='true'/></texture>",
        name, file);
}
std::string number(const std::string& name, double value) {
    return fmt::format("<float name='{}' value='{}'/>", name, value);
}
std::string word(const std::string& name, const std::string& value) {
    return fmt::format("<string name='{}' value='{}'/>", name, value);
}
std::string bsdf(const std::string& type, const std::string& body = "") {
    return fmt::format("<bsdf type='{}'>{}</bsdf>", type, body);
}
std::string white(const std::string& name) {
    return fmt::format("<rgb name='{}' value='1'/>", name);
}
std::string rough(const std::string& distribution, double alpha) {
    return word("distribution", distribution) + number("alpha", alpha);
}
std::string rough(const std::string& distribution, double alpha_u, double alpha_v) {
    return word("distribution", distribution) + number("alpha_u", alpha_u) +
           number("alpha_v", alpha_v);
}
std::string ior(double inside, double outside = 1) {
    return number("int_ior", inside) + number("ext_ior", outside);
}

/// What a plugin cannot be made without.
const std::map<std::string, std::string> bodies = {
    {"blendbsdf", bsdf("diffuse") + bsdf("roughconductor")},
    {"bumpmap", image("slope.png") + bsdf("diffuse")},
    {"mask", bsdf("diffuse")},
    {"measured", word("filename", "copper.bsdf")},
    {"normalmap", image("tilted.png", "normalmap") + bsdf("diffuse")},
    {"twosided", bsdf("diffuse")},
};

/// Disney's materials, no brighter than the furnace allows.
std::vector<std::string> disney_variants() {
    const auto colour = [](const char* value) {
        return fmt::format("<rgb name='base_color' value='{}'/>", value);
    };
    const std::string red = colour("0.5 0.2 0.1");
    std::vector<std::string> all;
    for (const double roughness : {0.0, 0.2, 0.6, 1.0}) {
        const std::string rough = number("roughness", roughness);
        const std::string glass = rough + number("spec_trans", 0.8);
        all.push_back(bsdf("principled", rough + number("metallic", 1) + white("base_color")));
        all.push_back(bsdf("principled", glass + red + number("eta", 1.33)));
        all.push_back(
            bsdf("principled", glass + red + number("spec_tint", 0.7) + number("metallic", 0.3)));
        all.push_back(bsdf("principledthin", glass + number("diff_trans", 0.8)));
        all.push_back(bsdf("principledthin", glass + red + number("spec_tint", 0.5)));
    }
    const std::string brushed = number("anisotropic", 0.8) + number("roughness", 0.4);
    all.push_back(bsdf("principled", brushed + number("spec_trans", 1) + number("eta", 0.7)));
    all.push_back(bsdf("principled", brushed + number("spec_trans", 1) + number("eta", 1)));
    all.push_back(bsdf("principled", brushed + number("clearcoat", 1) + red));
    all.push_back(bsdf("principled", number("clearcoat", 1) + number("clearcoat_gloss", 1)));
    all.push_back(bsdf("principled", number("flatness", 0.7) + number("specular", 0)));
    all.push_back(bsdf("principled", number("sheen", 0.5) + number("sheen_tint", 1) +
                                         number("spec_trans", 0.3) + red));
    all.push_back(bsdf("principled", image("grey.png", "metallic") +
                                         image("grey.png", "spec_trans") +
                                         image("grey.png", "roughness")));
    all.push_back(bsdf("principledthin", brushed + number("spec_trans", 1) + white("base_color")));
    all.push_back(bsdf("principledthin", number("diff_trans", 2) + white("base_color")));
    all.push_back(bsdf("principledthin", number("sheen", 0.5) + number("flatness", 1)));
    return all;
}

/// Parameters that are hard.
std::vector<std::string> variants() {
    std::vector<std::string> all;
    for (const char* d : {"beckmann", "ggx"}) {
        for (const double alpha : {0.02, 0.3, 1.0, 2.0}) {
            all.push_back(bsdf("roughconductor", rough(d, alpha) + word("material", "Cu")));
            all.push_back(bsdf("roughdielectric", rough(d, alpha) + ior(1.5)));
        }
        all.push_back(bsdf("roughconductor", rough(d, 0.01, 1)));
        all.push_back(bsdf("roughconductor", rough(d, 1, 0.001)));
        all.push_back(bsdf("roughdielectric", rough(d, 0.6, 0.03) + ior(1, 1.8)));
        all.push_back(bsdf("roughdielectric", rough(d, 0.3) + ior(1.05)));
        all.push_back(bsdf("roughplastic", rough(d, 0.03) + ior(1.5)));
        all.push_back(bsdf("roughplastic", rough(d, 0.5) + ior(1.8) + white("diffuse_reflectance") +
                                               "<boolean name='nonlinear' value='true'/>"));
    }
    all.push_back(bsdf("roughdielectric", number("alpha", 1e-4) + ior(1.5)));
    all.push_back(bsdf("roughdielectric", number("alpha", 0.2) + ior(1)));
    all.push_back(bsdf("roughdielectric", image("grey.png", "alpha") + ior(1.3)));
    all.push_back(bsdf("roughplastic", number("alpha", 1e-4) + ior(1.5)));
    all.push_back(bsdf("roughconductor", image("grey.png", "alpha_u")));
    all.push_back(bsdf("dielectric", ior(1)));
    all.push_back(bsdf("dielectric", ior(1, 1.5)));
    all.push_back(bsdf("dielectric", ior(1.0001)));
    all.push_back(bsdf("plastic", ior(1.8) + white("diffuse_reflectance")));
    all.push_back(bsdf("plastic", ior(1, 1.5)));
    all.push_back(bsdf("plastic", ior(1)));
    all.push_back(bsdf("phong", number("exponent", 1000)));
    all.push_back(bsdf("phong", number("exponent", 0) + white("specular_reflectance")));
    all.push_back(bsdf("twosided", bsdf("diffuse") + bsdf("roughplastic")));
    all.push_back(bsdf("twosided", bsdf("bumpmap", image("slope.png") + bsdf("roughconductor"))));
    all.push_back(bsdf("blendbsdf", number("weight", 0.3) + bsdf("dielectric") + bsdf("plastic")));
    all.push_back(bsdf("blendbsdf", number("weight", 0) + bsdf("diffuse") + bsdf("conductor")));
    all.push_back(bsdf("blendbsdf", image("grey.png", "weight") +
                                        bsdf("twosided", bsdf("roughconductor")) +
                                        bsdf("roughdielectric", number("alpha", 0.4))));
    all.push_back(bsdf("mask", image("grey.png", "opacity") + bsdf("twosided", bsdf("plastic"))));
    all.push_back(bsdf("mask", number("opacity", 0) + bsdf("diffuse")));
    all.push_back(bsdf("mask", number("opacity", 1) + bsdf("phong")));
    for (const char* type : {"roughdielectric", "roughplastic", "conductor", "dielectric"}) {
        all.push_back(bsdf("normalmap", image("tilted.png", "normalmap") + bsdf(type)));
    }
    all.push_back(bsdf("hair", number("eumelanin", 0) + number("pheomelanin", 0)));
    all.push_back(bsdf("hair", number("longitudinal_roughness", 1) +
                                   number("azimuthal_roughness", 0.8) + number("scale_tilt", -10)));
    all.push_back(bsdf("hair", number("longitudinal_roughness", 0.15) +
                                   number("azimuthal_roughness", 0.2) +
                                   image("grey.png", "sigma_a") + ior(1.3) + number("scale", 0.3)));
    all.push_back(bsdf("measured", word("filename", "brushed.bsdf")));
    all.push_back(bsdf("twosided", bsdf("measured", word("filename", "shiny.bsdf"))));
    all.push_back(bsdf("bumpmap", image("slope.png") + number("scale", -3) +
                                      bsdf("normalmap", image("tilted.png") + bsdf("plastic"))));
    for (const std::string& xml : disney_variants()) all.push_back(xml);
    return all;
}

/// BSDFs from text, and what they are made of.
class Workshop {
public:
    const BSDF* make(const std::string& xml) {
        const std::string name = (images().path() / "test.xml").string();
        const Description description =
            read_scene_text("<scene version='3.0.0'>" + xml + "</scene>", name, {}, diagnostics_);
        diagnostics_.throw_if_errors();
        const Element& element = *description.root->children.front().element;
        const Object* object =
            build_object(element, description, registry_, diagnostics_, objects_);
        diagnostics_.throw_if_errors();
        return static_cast<const BSDF*>(object);
    }

    Registry& registry() { return registry_; }

private:
    Registry registry_;
    Diagnostics diagnostics_;
    std::vector<std::unique_ptr<Object>> objects_;
};

/// The message with which a BSDF is refused; empty if it is not.
std::string refusal(const std::string& xml) {
    try {
        Workshop().make(xml);
        return "";
    } catch (const SceneError& e) {
        return e.what();
    }
}

struct Case {
    std::string xml;
    const BSDF* bsdf;
};

class BSDFs : public testing::Test {
protected:
    static void SetUpTestSuite() {
        workshop = new Workshop;
        std::vector<std::string> all;
        for (const std::string& name : workshop->registry().names("bsdf")) {
            const auto body = bodies.find(name);
            all.push_back(bsdf(name, body == bodies.end() ? "" : body->second));
        }
        for (const std::string& xml : variants()) all.push_back(xml);
        for (const std::string& xml : all) {
            try {
                cases.push_back({xml, workshop->make(xml)});
            } catch (const Error& e) {
                ADD_FAILURE() << xml << "\ncannot be made; if it needs nested objects or "
                              << "parameters, add them to `bodies` in this file\n"
                              << e.what();
            }
        }
    }
    static void TearDownTestSuite() {
        cases.clear();
        delete workshop;
    }

    static inline Workshop* workshop = nullptr;
    static inline std::vector<Case> cases;
};

/// What one contract found about one BSDF, at the level of as many as are tried.
testing::AssertionResult kept(const Evidence& evidence) {
    return holds(evidence, sidak(0.01, 3.0 * 128));
}

/// The mean of the power per sample times the cosine: up counts as positive.
double mean_flow(const BSDF& bsdf, Vector3 wo, int samples) {
    Rng rng(7);
    double sum = 0;
    for (int i = 0; i < samples; ++i) {
        const auto s = draw(bsdf, surface(), wo, TransportMode::importance, rng);
        if (s) sum += s->weight.y * s->wi.z;
    }
    return sum / samples;
}

testing::AssertionResult close(Color a, Color b, float tolerance) {
    const float difference = max_component(absolute(a - b));
    const float size = max_component(glm::max(absolute(a), absolute(b)));
    if (difference <= tolerance * size + 1e-7f) return testing::AssertionSuccess();
    return testing::AssertionFailure()
           << fmt::format("({}, {}, {}) is not ({}, {}, {})", a.x, a.y, a.z, b.x, b.y, b.z);
}

TEST_F(BSDFs, every_plugin_is_found_and_can_be_made) {
    EXPECT_GE(workshop->registry().names("bsdf").size(), 15u);
    EXPECT_GE(cases.size(), 50u);
}

TEST_F(BSDFs, D11_D4_D18_D21_directions_follow_their_density) {
    for (const Case& c : cases) {
        for (const Evidence& evidence : contracts::bsdf_density(*c.bsdf, {.samples = 50000})) {
            EXPECT_TRUE(kept(evidence)) << c.xml;
        }
    }
}

TEST_F(BSDFs, samples_of_many_lanes_are_those_of_each) {
    for (const Case& c : cases) EXPECT_TRUE(kept(contracts::bsdf_lanes(*c.bsdf, effort))) << c.xml;
}

TEST_F(BSDFs, D11_weight_is_value_times_cosine_over_density) {
    for (const Case& c : cases) {
        EXPECT_TRUE(kept(contracts::bsdf_weights(*c.bsdf, effort))) << c.xml;
    }
}

TEST_F(BSDFs, samples_are_what_they_say) {
    for (const Case& c : cases) {
        EXPECT_TRUE(kept(contracts::bsdf_samples(*c.bsdf, effort))) << c.xml;
    }
}

TEST_F(BSDFs, transmittance_is_the_mean_weight_of_what_goes_straight_through) {
    for (const Case& c : cases) {
        EXPECT_TRUE(kept(contracts::bsdf_transmittance(*c.bsdf))) << c.xml;
    }
}

TEST_F(BSDFs, D2_white_furnace_gains_no_energy) {
    for (const Case& c : cases) {
        EXPECT_TRUE(kept(contracts::bsdf_energy(*c.bsdf, effort))) << c.xml;
    }
}

TEST_F(BSDFs, D9_O13_lossless_surfaces_keep_all_energy) {
    const std::string smooth = number("roughness", 0);
    const std::string lossless[] = {
        bsdf("dielectric"),
        bsdf("dielectric", ior(1.5)),
        bsdf("dielectric", ior(1, 2)),
        bsdf("dielectric", ior(1)),
        bsdf("thindielectric"),
        bsdf("null"),
        bsdf("mask", number("opacity", 0.4) + bsdf("dielectric")),
        bsdf("roughdielectric", number("alpha", 5e-4)),
        bsdf("principled", smooth + number("spec_trans", 1) + white("base_color")),
        bsdf("twosided", bsdf("principled", smooth + number("metallic", 1) + white("base_color"))),
        bsdf("principledthin", smooth + number("spec_trans", 1) + white("base_color")),
        bsdf("twosided", bsdf("conductor", word("material", "none"))),
        bsdf("twosided", bsdf("diffuse", white("reflectance"))),
        bsdf("twosided", bsdf("plastic", ior(1.5) + white("diffuse_reflectance"))),
        bsdf("twosided", bsdf("plastic", ior(2.5) + white("diffuse_reflectance") +
                                             "<boolean name='nonlinear' value='true'/>")),
    };
    for (const std::string& xml : lossless) {
        const BSDF& bsdf = *workshop->make(xml);
        for (const TransportMode mode : modes) {
            for (const Vector3 wo : viewers()) {
                EXPECT_TRUE(equivalent(contracts::scattered_power(bsdf, wo, mode, 60000), 1, 0.002))
                    << xml << " cos " << wo.z;
            }
        }
    }
}

TEST_F(BSDFs, rough_plastic_with_white_base_keeps_all_energy) {
    for (const char* distribution : {"beckmann", "ggx"}) {
        for (const double alpha : {0.002, 0.1, 0.4, 1.0}) {
            const std::string xml = bsdf("roughplastic", rough(distribution, alpha) + ior(1.5) +
                                                             white("diffuse_reflectance"));
            const BSDF& plastic = *workshop->make(xml);
            for (const float cosine : {0.02f, 0.1f, 0.3f, 0.7f, 1.0f}) {
                EXPECT_TRUE(equivalent(
                    contracts::scattered_power(plastic, direction(cosine, 1), modes[0], 200000), 1,
                    0.005))
                    << xml << " cos " << cosine;
            }
        }
    }
}

TEST_F(BSDFs, white_hair_keeps_all_energy) {
    const std::string white_hair = number("eumelanin", 0) + number("pheomelanin", 0);
    for (const double roughness : {0.02, 0.3, 0.9}) {
        const std::string xml = bsdf("hair", white_hair + number("azimuthal_roughness", roughness) +
                                                 number("longitudinal_roughness", roughness));
        const BSDF& hair = *workshop->make(xml);
        for (const TransportMode mode : modes) {
            for (const Vector3 wo : viewers()) {
                if (wo.z < 0) continue;
                EXPECT_TRUE(equivalent(contracts::scattered_power(hair, wo, mode, 60000), 1, 0.002))
                    << xml << " cos " << wo.z;
            }
        }
    }
}

TEST_F(BSDFs, hair_scatters_as_in_mitsuba) {
    struct Value {
        Vector3 wo, wi;
        Color dark, tinted;
    };
    // Mitsuba 3.9.1, scalar_rgb: with the cosine, for the default pigments and for σ of 0.5, 1, 2.
    // Its Bessel function is a series of ten terms, which is up to 0.5 % too small.
    const Value values[] = {
        {{0, 0, 1},
         {0, 0, 1},
         {0.139362f, 0.134361f, 0.133144f},
         {0.141790f, 0.134294f, 0.133143f}},
        {{0, 0, 1},
         {0, 0.5f, 1},
         {0.06297f, 0.059711f, 0.058918f},
         {0.064553f, 0.059667f, 0.058917f}},
        {{0, 0.5f, 1},
         {0.2f, -0.5f, 1},
         {0.083246f, 0.080326f, 0.079675f},
         {0.084714f, 0.080289f, 0.079674f}},
        {{0.3f, 0.5f, 1},
         {0.2f, -0.5f, -1},
         {0.645803f, 0.282025f, 0.035918f},
         {0.764226f, 0.274099f, 0.035261f}},
        {{0.1f, 0.9f, 0.2f},
         {0.1f, -0.9f, -0.2f},
         {1.671423f, 0.595256f, 0.04566f},
         {2.061714f, 0.574484f, 0.044622f}},
        {{0, 0, 1},
         {0, 0, -1},
         {1.616733f, 0.720654f, 0.096579f},
         {1.905242f, 0.700896f, 0.094856f}},
    };
    const BSDF& dark = *workshop->make(bsdf("hair"));
    const BSDF& tinted = *workshop->make(bsdf("hair", "<rgb name='sigma_a' value='0.5 1 2'/>"));
    for (const Value& v : values) {
        const Vector3 wo = glm::normalize(v.wo), wi = glm::normalize(v.wi);
        const auto value = [&](const BSDF& b) {
            return b.evaluate(surface(), wo, wi, modes[0]).f * std::abs(wi.z);
        };
        EXPECT_TRUE(close(value(dark), v.dark, 6e-3f));
        EXPECT_TRUE(close(value(tinted), v.tinted, 6e-3f));
    }
}

TEST_F(BSDFs, D10_D15_importance_is_the_adjoint_of_radiance) {
    for (const Case& c : cases) {
        if (c.xml.find("hair") != std::string::npos) continue;  // only over its whole width
        EXPECT_TRUE(kept(contracts::bsdf_adjoint(*c.bsdf, effort))) << c.xml;
        // A perturbed normal makes surfaces brighter where it faces the light more than they do.
        const bool perturbed = c.xml.find("map") != std::string::npos;
        // A table of one direction is not interpolated as that of the other.
        const bool measured = c.xml.find("measured") != std::string::npos;
        const Finding reciprocity = contracts::bsdf_reciprocity(*c.bsdf, effort).finding(0);
        EXPECT_TRUE(perturbed || measured || reciprocity.keeping != Keeping::unusual) << c.xml;
    }
}

TEST_F(BSDFs, D10_refraction_is_reciprocal_but_for_eta_squared) {
    const BSDF& glass = *workshop->make(bsdf("roughdielectric", rough("ggx", 0.3) + ior(1.5)));
    const Interaction at = surface();
    Rng rng(6);
    for (int i = 0; i < 10000; ++i) {
        const Vector3 outside = square_to_uniform_hemisphere(rng.next_float2());
        const Vector3 inside = -square_to_uniform_hemisphere(rng.next_float2());
        const Color in = glass.evaluate(at, outside, inside, TransportMode::radiance).f;
        const Color out = glass.evaluate(at, inside, outside, TransportMode::radiance).f;
        ASSERT_TRUE(close(in * sqr(1.5f), out, 1e-4f));
    }
}

TEST_F(BSDFs, D12_density_is_positive_where_the_value_is) {
    for (const Case& c : cases) {
        EXPECT_TRUE(kept(contracts::bsdf_support(*c.bsdf, effort))) << c.xml;
    }
}

TEST_F(BSDFs, D3_directions_in_the_plane_are_finite) {
    for (const Case& c : cases) {
        EXPECT_TRUE(kept(contracts::bsdf_grazing(*c.bsdf, effort))) << c.xml;
    }
}

TEST_F(BSDFs, extreme_random_numbers_are_finite) {
    for (const Case& c : cases) {
        EXPECT_TRUE(kept(contracts::bsdf_extreme_numbers(*c.bsdf))) << c.xml;
    }
}

/// A rough surface, and what it becomes for alpha → 0.
struct Limit {
    std::string rough, smooth, body;
};
const Limit limits[] = {
    {"roughconductor", "conductor", word("material", "Au")},
    {"roughdielectric", "dielectric", ior(1.5)},
    {"roughplastic", "plastic", ior(1.5)},
};

TEST_F(BSDFs, D1_tiny_alpha_is_exactly_smooth) {
    for (const Limit& limit : limits) {
        const BSDF& smooth = *workshop->make(bsdf(limit.smooth, limit.body));
        const BSDF& rough = *workshop->make(bsdf(limit.rough, limit.body + number("alpha", 9e-4)));
        EXPECT_EQ(rough.lobes(), smooth.lobes());
        for (const Vector3 wo : viewers()) {
            Rng a(1), b(1);
            for (int i = 0; i < 100; ++i) {
                const auto s = draw(rough, surface(), wo, modes[0], a);
                const auto t = draw(smooth, surface(), wo, modes[0], b);
                ASSERT_EQ(s.has_value(), t.has_value());
                if (!s) continue;
                ASSERT_EQ(s->wi, t->wi);
                ASSERT_EQ(s->weight, t->weight);
                ASSERT_EQ(s->pdf, t->pdf);
                ASSERT_EQ(s->lobe, t->lobe);
            }
        }
    }
}

TEST_F(BSDFs, D1_small_alpha_approaches_smooth) {
    for (const Limit& limit : limits) {
        const BSDF& smooth = *workshop->make(bsdf(limit.smooth, limit.body));
        for (const char* distribution : {"beckmann", "ggx"}) {
            for (const double alpha : {1e-3, 3e-3, 1e-2}) {
                const std::string xml = bsdf(limit.rough, limit.body + rough(distribution, alpha));
                const BSDF& rough = *workshop->make(xml);
                for (const float cosine : {1.0f, 0.7f, 0.4f}) {
                    const Vector3 wo = direction(cosine, 1);
                    const double expected =
                        contracts::scattered_power(smooth, wo, modes[1], 100000).mean();
                    const double mean =
                        contracts::scattered_power(rough, wo, modes[1], 100000).mean();
                    EXPECT_NEAR(mean, expected, 0.005 * expected) << xml << " cos " << cosine;
                    // The same share goes up and down, in the same directions.
                    EXPECT_NEAR(mean_flow(rough, wo, 100000), mean_flow(smooth, wo, 100000), 0.005)
                        << xml << " cos " << cosine;
                }
            }
        }
    }
}

TEST_F(BSDFs, D5_D6_critical_angle_and_total_reflection) {
    const BSDF& glass = *workshop->make(bsdf("dielectric", ior(1.5)));
    const float critical = std::sqrt(1 - 1 / sqr(1.5f));
    for (const float step : {1e-6f, 1e-4f, 1e-2f, 0.3f}) {
        for (const float u_lobe : {0.0f, 0.5f, one_minus_epsilon}) {
            const Vector3 wo = direction(-(critical - step), 0.3f);
            const auto s = glass.sample(surface(), wo, u_lobe, {0.5f, 0.5f}, modes[0]);
            ASSERT_TRUE(s.has_value());
            EXPECT_EQ(s->wi, reflect(wo));
            EXPECT_EQ(s->weight, Color(1));
            EXPECT_EQ(s->pdf, 1);
        }
        const Vector3 wo = direction(-std::min(critical + step, 1.0f), 0.3f);
        const auto s = glass.sample(surface(), wo, one_minus_epsilon, {0.5f, 0.5f}, modes[0]);
        ASSERT_TRUE(s.has_value());
        EXPECT_EQ(s->lobe, Lobe::specular_transmission);
        EXPECT_NEAR(s->pdf, 1 - fresnel_dielectric(wo.z, 1.5f), 1e-6f);
        EXPECT_NEAR(glm::length(Vector2(s->wi)), 1.5f * glm::length(Vector2(wo)), 1e-5f);
    }
}

TEST_F(BSDFs, D8_nearly_equal_indices_at_grazing_angles) {
    const BSDF& glass = *workshop->make(bsdf("dielectric", ior(1.0001)));
    for (const float cosine : {1e-4f, 1e-3f, 0.01f, 0.03f}) {
        const auto s = glass.sample(surface(), direction(cosine, 1), 0, {0, 0}, modes[0]);
        ASSERT_TRUE(s.has_value());
        // Schlick's limit for small cosines, in double: both polarisations reflect the same.
        const double c = cosine, t = std::sqrt(c * c + 1.0001 * 1.0001 - 1);
        EXPECT_NEAR(s->pdf, sqr((t - c) / (t + c)), 1e-3) << cosine;
    }
}

TEST_F(BSDFs, O11_D22_panes_transmit_as_their_faces_do) {
    const BSDF& pane = *workshop->make(bsdf("thindielectric", ior(1.5)));
    const std::pair<float, double> transmittances[] = {
        {0.0f, .923077}, {30.0f, .920266}, {60.0f, .836232}, {80.0f, .441229}};
    for (const auto& [degrees, expected] : transmittances) {
        const Vector3 wo = direction(std::cos(degrees * pi / 180), 1);
        const auto s = pane.sample(surface(), wo, one_minus_epsilon, {0, 0}, modes[0]);
        ASSERT_TRUE(s.has_value());
        EXPECT_EQ(s->wi, -wo);
        EXPECT_NEAR(s->pdf, expected, 2e-6);
    }
}

TEST_F(BSDFs, D7_equal_indices_are_invisible) {
    for (const char* type : {"dielectric", "thindielectric", "roughdielectric"}) {
        const BSDF& glass = *workshop->make(bsdf(type, ior(1.5, 1.5)));
        for (const float cosine : {1.0f, 0.3f, 1e-4f, -1e-6f, -0.8f}) {
            for (const float u_lobe : {0.0f, 0.5f, one_minus_epsilon}) {
                const Vector3 wo = direction(cosine, 2);
                const auto s = glass.sample(surface(), wo, u_lobe, {0.5f, 0.5f}, modes[0]);
                ASSERT_TRUE(s.has_value()) << type;
                EXPECT_EQ(s->wi, -wo) << type;
                EXPECT_EQ(s->weight, Color(1)) << type;
                EXPECT_EQ(s->eta, 1) << type;
            }
        }
    }
}

TEST_F(BSDFs, D14_normals_turned_away_are_not_black) {
    for (const char* type : {"normalmap", "bumpmap"}) {
        const BSDF& bsdf = *workshop->make(lucerna::bsdf(type, bodies.at(type)));
        for (int i = 0; i < 64; ++i) {
            const Vector3 wo = direction(0.05f, 2 * pi * static_cast<float>(i) / 64);
            const double mean =
                contracts::scattered_power(bsdf, wo, TransportMode::radiance, 4000).mean();
            EXPECT_GT(mean, 0.25) << type << " at " << i;
        }
    }
}

/// A matte surface whose normal is tilted by `degrees` towards +x.
std::string tilted(double degrees, const std::string& more = "") {
    const double angle = degrees * std::numbers::pi / 180;
    return bsdf("normalmap", fmt::format("<texture name='normalmap' type='rawconstant'>"
                                         "<vector name='value' x='{}' y='0.5' z='{}'/></texture>",
                                         0.5 + 0.5 * std::sin(angle), 0.5 + 0.5 * std::cos(angle)) +
                                 more + bsdf("diffuse"));
}

/// f |cos θi| of a viewer and of light from these directions, of any length.
float reflected(const BSDF& bsdf, Vector3 viewer, Vector3 light) {
    const Vector3 wo = glm::normalize(viewer), wi = glm::normalize(light);
    const float value = bsdf.evaluate(surface(), wo, wi, modes[0]).f.x * std::abs(wi.z);
    const float adjoint =
        bsdf.evaluate(surface(), wi, wo, TransportMode::importance).f.x * std::abs(wi.z);
    EXPECT_NEAR(value, adjoint, 1e-6f);
    return value;
}

/// A colour is the same normal everywhere: as a texture of this colour, and (0.5, 0.5, 1) none.
TEST_F(BSDFs, a_normal_map_of_one_colour_needs_no_texture) {
    const Vector3 light(1, 1, 0.3f);
    const auto mapped = [&](const char* normal) {
        return reflected(*workshop->make(bsdf("normalmap", normal + bsdf("diffuse"))), {0, 0, 1},
                         light);
    };
    const float plain = reflected(*workshop->make(bsdf("diffuse")), {0, 0, 1}, light);
    EXPECT_NEAR(mapped("<rgb name='normalmap' value='0.5 0.5 1'/>"), plain, 1e-6);
    EXPECT_NEAR(mapped("<spectrum name='normalmap' type='srgb'><rgb name='color' value='0.5, 0.5, "
                       "1'/></spectrum>"),
                plain, 1e-6);
    EXPECT_NEAR(mapped("<rgb name='normalmap' value='0.8213938 0.5 0.8830222'/>"),
                reflected(*workshop->make(tilted(40)), {0, 0, 1}, light), 1e-6);
}

/// Expected: what Mitsuba 3.9.1 (scalar_rgb) evaluates.
TEST_F(BSDFs, D13_D14_low_light_is_shadowed_by_bumps) {
    const std::string off = "<boolean name='use_shadowing_function' value='false'/>";
    const auto ratio = [&](double degrees, Vector3 light) {
        return reflected(*workshop->make(tilted(degrees)), {0, 0, 1}, light) /
               reflected(*workshop->make(tilted(degrees, off)), {0, 0, 1}, light);
    };
    EXPECT_NEAR(reflected(*workshop->make(tilted(40, off)), {0, 0, 1}, {1, 1, 0.3f}), 0.0961, 1e-4);
    EXPECT_NEAR(ratio(20, {1, 1, 0.3f}), 0.9218, 1e-4);
    EXPECT_NEAR(ratio(40, {1, 1, 0.3f}), 0.7355, 1e-4);
    EXPECT_NEAR(ratio(60, {1, 1, 0.3f}), 0.4932, 1e-4);
    EXPECT_NEAR(ratio(60, {-0.3f, 0.5f, 1}), 0.97, 1e-4);
    EXPECT_NEAR(ratio(60, {0, 0, 1}), 1, 1e-6);
}

/// Expected: what Mitsuba 3.9.1 (scalar_rgb) evaluates.
TEST_F(BSDFs, D14_normals_turned_away_are_tilted_the_other_way) {
    const Vector3 viewer(-1, 0, 0.3f);
    const std::string black = "<boolean name='flip_invalid_normals' value='false'/>";
    EXPECT_NEAR(reflected(*workshop->make(tilted(60)), viewer, {0, 0, 1}), 0.079577468, 1e-6);
    EXPECT_NEAR(reflected(*workshop->make(tilted(60)), viewer, {-1, 0, 1}), 0.141518533, 1e-5);
    EXPECT_EQ(reflected(*workshop->make(tilted(60)), viewer, {1, 0, 1}), 0);
    EXPECT_EQ(reflected(*workshop->make(tilted(60, black)), viewer, {0, 0, 1}), 0);
}

TEST_F(BSDFs, flat_maps_change_nothing) {
    const BSDF& diffuse = *workshop->make(bsdf("roughplastic"));
    const BSDF& bumped = *workshop->make(
        bsdf("bumpmap", number("scale", 0) + image("slope.png") + bsdf("roughplastic")));
    Rng rng(12);
    for (int i = 0; i < 1000; ++i) {
        const Vector3 a = square_to_uniform_sphere(rng.next_float2());
        const Vector3 b = square_to_uniform_sphere(rng.next_float2());
        for (const TransportMode mode : modes) {
            const BSDFValue x = diffuse.evaluate(surface(), a, b, mode);
            const BSDFValue y = bumped.evaluate(surface(), a, b, mode);
            ASSERT_TRUE(close(x.f, y.f, 1e-5f));
            ASSERT_NEAR(x.pdf, y.pdf, 1e-5f * x.pdf);
        }
    }
}

TEST_F(BSDFs, bumped_matte_surface_is_lit_by_its_perturbed_cosine) {
    const BSDF& bumped = *workshop->make(bsdf("bumpmap", bodies.at("bumpmap")));
    const Vector3 wo(0, 0, 1), left = direction(0.7f, pi), right = direction(0.7f, 0);
    const float from_left = bumped.evaluate(surface(), wo, left, modes[0]).f.y;
    const float from_right = bumped.evaluate(surface(), wo, right, modes[0]).f.y;
    // The surface rises with u, so it faces −x.
    EXPECT_GT(from_left, 1.2f * from_right);
}

TEST_F(BSDFs, D19_reflectance_above_one_is_refused) {
    EXPECT_NE(refusal(bsdf("diffuse", "<rgb name='reflectance' value='1.5'/>")), "");
    EXPECT_NE(refusal(bsdf("diffuse", "<rgb name='reflectance' value='-1 0 0'/>")), "");
    EXPECT_NE(refusal(bsdf("mask", number("opacity", 2) + bsdf("diffuse"))), "");
    EXPECT_NE(refusal(bsdf("roughconductor", number("alpha", -0.1))), "");
    EXPECT_NE(refusal(bsdf("dielectric", number("int_ior", 0))), "");
}

TEST_F(BSDFs, D20_two_sided_glass_is_refused) {
    for (const char* type : {"dielectric", "roughdielectric", "thindielectric", "null"}) {
        const std::string message = refusal(bsdf("twosided", bsdf(type)));
        EXPECT_NE(message.find("transmits light"), std::string::npos) << message;
    }
    EXPECT_NE(refusal(bsdf("twosided", bsdf("diffuse") + bsdf("mask", bsdf("diffuse")))), "");
    EXPECT_NE(refusal(bsdf("twosided")), "");
    EXPECT_NE(refusal(bsdf("blendbsdf", bsdf("diffuse"))), "");
}

/// f of a viewer at cos θo and of light at cos θi from the normal, on opposite sides of it.
Color across(const BSDF& bsdf, float cos_theta, float cos_i) {
    return bsdf.evaluate(surface(), direction(cos_theta, 0), direction(cos_i, pi), modes[0]).f;
}

TEST_F(BSDFs, principled_is_the_sum_of_its_published_lobes) {
    const auto value = [](const std::string& type, const std::string& body, float o,
                          float i) -> double {
        return across(*workshop->make(bsdf(type, number("roughness", 0.5) + body)), o, i).y;
    };
    const auto close_to = [](double expected) { return testing::DoubleNear(expected, 1e-5); };
    // At the normal D = 1 / (π α²) with α = 0.25, and the reflectance is 0.04.
    const double highlight = 0.04 / (4 * pi * 0.0625), matte = 0.5 / pi;
    EXPECT_THAT(value("principled", "", 1, 1), close_to(matte + highlight));
    EXPECT_THAT(value("principled", number("metallic", 1), 1, 1), close_to(0.5 / (pi / 4)));
    EXPECT_THAT(value("principled", number("metallic", 0.25), 1, 1),
                close_to(0.75 * (matte + highlight) + 0.25 * 0.5 / (pi / 4)));
    // The coat: Schlick(0.04) / 4 times GTR1 with α = 0.1.
    const double gtr1 = (0.01 - 1) / (pi * std::log(0.01) * 0.01);
    EXPECT_THAT(value("principled", number("clearcoat", 1), 1, 1),
                close_to(matte + highlight + 0.25 * 0.04 * gtr1));
    // Sheen: (1 − cos θd)⁵ at 60° from the half vector.
    EXPECT_THAT(
        value("principled", number("sheen", 1), 0.5f, 0.5f) - value("principled", "", 0.5f, 0.5f),
        close_to(std::pow(0.5, 5)));
    // Scattering below the surface: at the normal 1.25 (1 / (1 + 1) − ½ + ½) of the matte lobe.
    EXPECT_THAT(value("principled", number("flatness", 1), 1, 1),
                close_to(1.25 * 0.5 * matte + highlight));
    // Through a sheet: α' = (0.65 η − 0.35)² 0.25.
    const double alpha = sqr(0.65 * 1.5 - 0.35) * 0.25;
    EXPECT_THAT(value("principledthin", number("spec_trans", 1), 1, -1),
                close_to(0.5 * 0.96 / (4 * pi * alpha * alpha)));
    EXPECT_THAT(value("principledthin", number("diff_trans", 0.5), 1, -1), close_to(0.25 * matte));
    EXPECT_THAT(value("principledthin", number("diff_trans", 0.5), 1, 1), close_to(0.75 * matte));
}

TEST_F(BSDFs, principled_index_is_given_once_and_refracts) {
    const std::string glass = number("spec_trans", 1);
    const std::string message =
        refusal(bsdf("principled", number("eta", 1.5) + number("specular", 0.5)));
    EXPECT_NE(message.find("either \"eta\" or \"specular\""), std::string::npos) << message;
    EXPECT_NE(refusal(bsdf("principled", number("base_color", 1.5))), "");
    EXPECT_NE(refusal(bsdf("principled", number("main_specular_sampling_rate", 0))), "");
    EXPECT_NE(refusal(bsdf("twosided", bsdf("principled", glass))), "");
    // specular = ((η − 1) / (η + 1))² / 0.08.
    const BSDF& by_eta = *workshop->make(bsdf("principled", number("eta", 1.6) + glass));
    const BSDF& by_specular =
        *workshop->make(bsdf("principled", number("specular", sqr(0.6 / 2.6) / 0.08) + glass));
    const Vector3 wo = direction(0.8f, 1), wi = direction(-0.9f, 4);
    const BSDFValue a = by_eta.evaluate(surface(), wo, wi, modes[0]);
    EXPECT_GT(a.f.y, 0);
    EXPECT_TRUE(close(a.f, by_specular.evaluate(surface(), wo, wi, modes[0]).f, 1e-4f));
}

TEST_F(BSDFs, materials_are_known_by_name) {
    const BSDF& named =
        *workshop->make(bsdf("dielectric", word("int_ior", "Water") + word("ext_ior", "vacuum")));
    const BSDF& numbered = *workshop->make(bsdf("dielectric", ior(1.333)));
    const Vector3 wo = direction(0.3f, 1);
    EXPECT_EQ(named.albedo(surface(), wo), numbered.albedo(surface(), wo));
    const auto a = named.sample(surface(), wo, 0, {0, 0}, modes[0]);
    const auto b = numbered.sample(surface(), wo, 0, {0, 0}, modes[0]);
    EXPECT_EQ(a->pdf, b->pdf);

    std::string message = refusal(bsdf("dielectric", word("int_ior", "diamont")));
    EXPECT_NE(message.find("did you mean \"diamond\"?"), std::string::npos) << message;
    message = refusal(bsdf("conductor", word("material", "Goldd")));
    EXPECT_NE(message.find("there are: "), std::string::npos) << message;
    EXPECT_NE(refusal(bsdf("roughconductor", number("alpha", 0.1) + number("alpha_u", 0.1))), "");

    // Gold: more red than blue; η and k replace what the name says.
    const BSDF& gold = *workshop->make(bsdf("conductor", word("material", "Au")));
    EXPECT_GT(gold.albedo(surface(), wo).x, 1.5f * gold.albedo(surface(), Vector3(0, 0, 1)).z);
    const BSDF& grey = *workshop->make(
        bsdf("conductor", word("material", "Au") + number("eta", 1.5) + number("k", 0)));
    EXPECT_TRUE(close(grey.albedo(surface(), wo), Color(fresnel_dielectric(0.3f, 1.5f)), 1e-5f));
}

}  // namespace
}  // namespace lucerna
