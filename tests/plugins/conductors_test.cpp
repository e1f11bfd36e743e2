// SPDX-License-Identifier: Apache-2.0
#include "plugins/bsdfs/conductors.h"

#include <gtest/gtest.h>

namespace lucerna {
namespace {

/// Reflectance at normal incidence.
Color reflectance(const ConductorData& d) {
    const Color k2 = d.k * d.k;
    return ((d.eta - 1.0f) * (d.eta - 1.0f) + k2) / ((d.eta + 1.0f) * (d.eta + 1.0f) + k2);
}

TEST(Conductors, MetalsLookLikeThemselves) {
    const Color gold = reflectance(*conductor("Au")), copper = reflectance(*conductor("Cu"));
    const Color silver = reflectance(*conductor("Ag")), aluminium = reflectance(*conductor("Al"));
    EXPECT_GT(gold.x, 0.9f);  // yellow
    EXPECT_GT(gold.y, 0.7f);
    EXPECT_LT(gold.z, 0.45f);
    EXPECT_GT(copper.x, 0.9f);  // reddish
    EXPECT_LT(copper.y, 0.7f);
    EXPECT_GT(min_component(silver), 0.9f);
    EXPECT_GT(min_component(aluminium), 0.85f);
    EXPECT_LT(max_component(reflectance(*conductor("W"))), 0.65f);
    EXPECT_EQ(reflectance(*conductor("none")), Color(1));
}

TEST(Conductors, SilverAgreesWithAnIndependentIntegration) {
    // Mitsuba 3's integration of the same spectrum, published with a web renderer.
    const ConductorData silver = *conductor("Ag");
    const Color eta(0.155276f, 0.116728f, 0.138388f), k(4.828354f, 3.122222f, 2.146901f);
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(silver.eta[c], eta[c], 2e-4);
        EXPECT_NEAR(silver.k[c], k[c], 2e-4);
    }
}

TEST(Conductors, AllAreUsable) {
    EXPECT_GE(conductor_names().size(), 40u);
    for (const std::string& name : conductor_names()) {
        const std::optional<ConductorData> data = conductor(name);
        ASSERT_TRUE(data) << name;
        EXPECT_GE(min_component(data->k), 0) << name;
        EXPECT_LE(max_component(reflectance(*data)), 1) << name;
        EXPECT_TRUE(name == "none" || min_component(data->eta) > 0.03f) << name;
    }
}

TEST(Conductors, BothOfMitsubasNamesAreKnown) {
    EXPECT_EQ(conductor("Ir_palik")->eta, conductor("Ir")->eta);
    EXPECT_NE(conductor("Cu_palik")->eta, conductor("Cu")->eta);
    EXPECT_TRUE(conductor("V_palik"));
    EXPECT_FALSE(conductor("V"));
    EXPECT_FALSE(conductor("none_palik"));
    EXPECT_FALSE(conductor("cu"));
    EXPECT_FALSE(conductor(""));
}

TEST(Dielectrics, HaveTheirIndices) {
    EXPECT_EQ(dielectric_ior("bk7"), 1.5046);
    EXPECT_EQ(dielectric_ior("Water"), 1.3330);
    EXPECT_EQ(dielectric_ior("vacuum"), 1.0);
    EXPECT_EQ(dielectric_ior("fused quartz"), 1.458);
    EXPECT_FALSE(dielectric_ior("unobtainium"));
    EXPECT_EQ(dielectric_names().size(), 23u);
}

}  // namespace
}  // namespace lucerna
