#include <gtest/gtest.h>

#include <set>

#include "simulate/fabric.h"

namespace toile::simulate {
namespace {

const Fabric& named(std::string_view name) {
    for (const Fabric& fabric : measured_fabrics())
        if (fabric.name == name) return fabric;
    throw std::runtime_error("no such fabric");
}

TEST(Fabric, EveryOneIsWithinTheBoundsOfTheKeys) {
    std::set<std::string_view> names;
    for (const Fabric& fabric : measured_fabrics()) {
        EXPECT_TRUE(names.insert(fabric.name).second) << fabric.name;
        const MembraneOptions& m = fabric.membrane;
        EXPECT_TRUE(m.density_per_area > 0.05 && m.density_per_area < 1.0) << fabric.name;
        EXPECT_TRUE(m.warp_stiffness > 1.0 && m.weft_stiffness > 1.0 && m.shear_stiffness > 1.0) << fabric.name;
        EXPECT_TRUE(m.poisson_ratio >= 0.0 && m.poisson_ratio <= 0.49) << fabric.name;
        // What Kawabata's bending test finds for clothes, 0.01 to 1 gf cm²/cm.
        EXPECT_TRUE(fabric.bending_stiffness > 1e-6 && fabric.bending_stiffness < 1e-4) << fabric.name;
    }
    EXPECT_EQ(names.size(), 10u);
}

TEST(Fabric, DenimIsTheSourcesConverted) {
    // By hand from the source's numbers: 0.7 without stretch and 0.3 at a stretch of 1/6.
    const Fabric& denim = named("denim");
    EXPECT_EQ(denim.membrane.density_per_area, 0.324);
    const MembraneStiffness c =
        MembraneStiffness::from_moduli(denim.membrane.weft_stiffness, denim.membrane.warp_stiffness,
                                       denim.membrane.shear_stiffness, denim.membrane.poisson_ratio);
    EXPECT_NEAR(c.uu, 2.0 * (0.7 * 205.352005 + 0.3 * 232.027634), 1e-9);
    EXPECT_NEAR(c.vv, 2.0 * (0.7 * 1013.88629 + 0.3 * 1051.55712), 1e-9);
    EXPECT_NEAR(c.uv, 2.0 * (0.7 * 10.234077 + 0.3 * 0.5 * (40.646339 + 40.917892)), 1e-9);
    EXPECT_NEAR(c.shear, 0.7 * 53.387184 + 0.3 * 83.992020, 1e-9);
    EXPECT_NEAR(denim.bending_stiffness, 1.85e-5, 0.01e-5);
}

TEST(Fabric, AnIndefiniteCouplingBecomesNone) {
    // The sweater's first row couples its axes negatively; at 5 % stretch that is still so in part.
    EXPECT_GE(named("sweater_knit").membrane.poisson_ratio, 0.0);
    EXPECT_EQ(named("rib_knit").membrane.poisson_ratio > 0.0, true);
}

}  // namespace
}  // namespace toile::simulate
