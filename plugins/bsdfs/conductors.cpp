// SPDX-License-Identifier: Apache-2.0
#include "plugins/bsdfs/conductors.h"

#include <algorithm>
#include <array>
#include <cctype>

namespace lucerna {

namespace {

struct Conductor {
    std::string_view name;
    ConductorData data;
};

/// Measured spectra from Palik, "Handbook of Optical Constants of Solids" (1985-1998), and the
/// SOPRA database, as distributed with Mitsuba; integrated to linear Rec.709 by Mitsuba's rule
/// (spectrum.h, `emission`), to five digits; the same figures as in the scene libraries of
/// Tungsten. AlSb is left out: its red lies outside the gamut.
constexpr Conductor conductors[] = {
    {"none", {{0, 0, 0}, {1, 1, 1}}},
    {"a-C", {{2.9441f, 2.2272f, 1.9682f}, {0.88743f, 0.79932f, 0.81529f}}},
    {"Ag", {{0.15526f, 0.11672f, 0.13838f}, {4.8283f, 3.1222f, 2.147f}}},
    {"Al", {{1.6575f, 0.88037f, 0.52123f}, {9.2239f, 6.2695f, 4.837f}}},
    {"AlAs", {{3.6051f, 3.2329f, 2.2176f}, {0.00066702f, 0, 0.0074261f}}},
    {"Au", {{0.14312f, 0.37496f, 1.4425f}, {3.9832f, 2.3857f, 1.6032f}}},
    {"Be", {{4.1851f, 3.1851f, 2.7841f}, {3.8354f, 3.0101f, 2.869f}}},
    {"Cr", {{4.3697f, 2.9167f, 1.6547f}, {5.2064f, 4.2314f, 3.7549f}}},
    {"CsI", {{2.1449f, 1.7023f, 1.6624f}, {0, 0, 0}}},
    {"Cu", {{0.20044f, 0.92403f, 1.1022f}, {3.9129f, 2.4528f, 2.1422f}}},
    {"Cu2O", {{3.5493f, 2.9521f, 2.7369f}, {0.11322f, 0.19467f, 0.60017f}}},
    {"CuO", {{3.2454f, 2.4496f, 2.1974f}, {0.52027f, 0.57074f, 0.71723f}}},
    {"Cu_palik", {{0.21268f, 0.91999f, 1.1024f}, {3.9216f, 2.4571f, 2.1367f}}},
    {"d-C", {{2.7113f, 2.3186f, 2.2289f}, {0, 0, 0}}},
    {"Hg", {{2.3989f, 1.44f, 0.90955f}, {6.3276f, 4.3719f, 3.4218f}}},
    {"HgTe", {{4.7795f, 3.231f, 2.66f}, {1.632f, 1.5808f, 1.7296f}}},
    {"Ir", {{3.0864f, 2.0822f, 1.6179f}, {5.5922f, 4.0672f, 3.2673f}}},
    {"K", {{0.064049f, 0.04641f, 0.038184f}, {2.1042f, 1.3489f, 0.91321f}}},
    {"Li", {{0.26579f, 0.19561f, 0.22092f}, {3.5402f, 2.3111f, 1.6686f}}},
    {"MgO", {{2.0896f, 1.6507f, 1.5949f}, {0, 0, 0}}},
    {"Mo", {{4.4837f, 3.5255f, 2.7761f}, {4.1111f, 3.4209f, 3.1506f}}},
    {"Na_palik", {{0.060267f, 0.056141f, 0.061991f}, {3.1793f, 2.1125f, 1.5791f}}},
    {"Nb", {{3.4201f, 2.7902f, 2.3956f}, {3.4414f, 2.7376f, 2.5799f}}},
    {"Ni_palik", {{2.3673f, 1.6634f, 1.4671f}, {4.4988f, 3.0502f, 2.3454f}}},
    {"Rh", {{2.5858f, 1.8602f, 1.5544f}, {6.7823f, 4.703f, 3.9761f}}},
    {"Se-e", {{5.7243f, 4.1654f, 4.0816f}, {0.87137f, 1.1053f, 1.5648f}}},
    {"Se", {{4.0593f, 2.8427f, 2.8208f}, {0.75438f, 0.63852f, 0.52159f}}},
    {"SiC", {{3.1723f, 2.526f, 2.4794f}, {7.284e-07f, 0, 1.0015e-05f}}},
    {"SnTe", {{4.5252f, 1.9812f, 1.2817f}, {0, 0, 0}}},
    {"Ta", {{2.0626f, 2.3931f, 2.6281f}, {2.408f, 1.7414f, 1.947f}}},
    {"Te-e", {{7.509f, 4.2965f, 2.3699f}, {5.5842f, 4.9476f, 3.9975f}}},
    {"Te", {{7.3908f, 4.4821f, 2.6371f}, {3.2561f, 3.5274f, 3.2922f}}},
    {"ThF4", {{1.8307f, 1.4422f, 1.3876f}, {0, 0, 0}}},
    {"TiC", {{3.7005f, 2.8374f, 2.5823f}, {3.2657f, 2.3516f, 2.1728f}}},
    {"TiN", {{1.6485f, 1.1504f, 1.3798f}, {3.3685f, 1.9435f, 1.102f}}},
    {"TiO2-e", {{3.1066f, 2.5132f, 2.5824f}, {2.8954e-05f, 0, 0.00017756f}}},
    {"TiO2", {{3.4566f, 2.8017f, 2.9051f}, {0.00010267f, 0, 0.00063569f}}},
    {"VC", {{3.6576f, 2.7527f, 2.5327f}, {3.0684f, 2.1987f, 1.9632f}}},
    {"VN", {{2.8656f, 2.1192f, 1.9401f}, {3.0323f, 2.0561f, 1.6163f}}},
    {"V_palik", {{4.2775f, 3.5132f, 2.7611f}, {3.4912f, 2.8894f, 3.1117f}}},
    {"W", {{4.3707f, 3.3003f, 2.9983f}, {3.5007f, 2.6049f, 2.2732f}}},
};

struct Dielectric {
    std::string_view name;
    double ior;
};

/// Mitsuba's list; Hecht, "Optics", 4th edition, at 0 to 20 °C and 589 nm.
constexpr Dielectric dielectrics[] = {
    {"vacuum", 1.0},      {"helium", 1.000036},        {"hydrogen", 1.000132},
    {"air", 1.000277},    {"carbon dioxide", 1.00045}, {"water", 1.3330},
    {"acetone", 1.36},    {"ethanol", 1.361},          {"carbon tetrachloride", 1.461},
    {"glycerol", 1.4729}, {"benzene", 1.501},          {"silicone oil", 1.52045},
    {"bromine", 1.661},   {"water ice", 1.31},         {"fused quartz", 1.458},
    {"pyrex", 1.470},     {"acrylic glass", 1.49},     {"polypropylene", 1.49},
    {"bk7", 1.5046},      {"sodium chloride", 1.544},  {"amber", 1.55},
    {"pet", 1.5750},      {"diamond", 2.419},
};

template <typename Table>
const auto* find(const Table& table, std::string_view name) {
    const auto found = std::find_if(std::begin(table), std::end(table),
                                    [&](const auto& entry) { return entry.name == name; });
    return found == std::end(table) ? nullptr : &*found;
}

template <typename Table>
std::vector<std::string> names_of(const Table& table) {
    std::vector<std::string> names;
    for (const auto& entry : table) names.emplace_back(entry.name);
    return names;
}

}  // namespace

std::optional<ConductorData> conductor(std::string_view name) {
    if (const Conductor* exact = find(conductors, name)) return exact->data;
    // Where there is one measurement only, Mitsuba knows it by both names.
    constexpr std::string_view suffix = "_palik";
    const bool palik = name.ends_with(suffix);
    if (palik) name.remove_suffix(suffix.size());
    const Conductor* entry = palik && name != "none" ? find(conductors, name) : nullptr;
    if (!entry) return {};
    return entry->data;
}

std::vector<std::string> conductor_names() { return names_of(conductors); }

std::optional<double> dielectric_ior(std::string_view name) {
    std::string lower(name);
    for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    const Dielectric* entry = find(dielectrics, lower);
    if (!entry) return {};
    return entry->ior;
}

std::vector<std::string> dielectric_names() { return names_of(dielectrics); }

}  // namespace lucerna
