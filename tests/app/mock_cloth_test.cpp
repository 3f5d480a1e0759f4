#include "hosts/mock_cloth.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/inverse_mass.h"
#include "oilskin/world.h"

namespace oilskin::demo {
namespace {

struct Sheet {
  explicit Sheet(PinKind pins) : cloth(settings(pins), build_cloth(settings(pins), "cloth.0")) {
    cloth.gather(0.01, motion);
    own = motion.inverse_mass;
    motion.carried_mass.assign(own.size(), 0.5);
    cloth.gather(0.01, motion);
  }
  static Cloth settings(PinKind pins) {
    Cloth c;
    c.grid = {5, 5};
    c.pins.kind = pins;
    return c;
  }

  MockCloth cloth;
  SurfaceMotion motion;
  std::vector<double> own;  // inverse masses without water
};

TEST(MockCloth, nodes_of_a_supported_sheet_weigh_the_water_that_they_carry) {
  Sheet sheet(PinKind::border);
  ASSERT_EQ(sheet.motion.added_mass.size(), sheet.own.size());
  std::size_t loaded = 0;
  for (std::size_t i = 0; i < sheet.own.size(); ++i) {
    const bool is_free = sheet.own[i] > 0;
    loaded += is_free;
    EXPECT_EQ(sheet.motion.added_mass[i], is_free ? 0.5 : 0);
    EXPECT_DOUBLE_EQ(sheet.motion.inverse_mass[i], is_free ? 1 / (1 / sheet.own[i] + 0.5) : 0);
  }
  EXPECT_EQ(loaded, 9u);

  const std::vector<double> inverse_mass = sheet.motion.inverse_mass;
  sheet.motion.impulse.assign(inverse_mass.size(), Vec3(0, -1, 0));
  sheet.motion.moved.assign(inverse_mass.size(), 0);
  sheet.cloth.scatter(sheet.motion);
  sheet.motion.carried_mass.clear();
  sheet.cloth.gather(0.01, sheet.motion);
  EXPECT_EQ(sheet.motion.inverse_mass, sheet.own);
  for (std::size_t i = 0; i < inverse_mass.size(); ++i)
    EXPECT_DOUBLE_EQ(sheet.motion.velocity[i].y(), -inverse_mass[i]);
}

// The load on each node counts by its own mass over what it weighs: were these parts different, a sheet under
// a steady load would take another shape. A strip under water sagged by 6 % too little.
TEST(MockCloth, loaded_nodes_carry_in_proportion_to_their_own_masses) {
  Cloth settings = Sheet::settings(PinKind::border);
  settings.grid = {13, 13};
  settings.size = {0.2, 0.2};
  settings.bowl_depth = 0.04;
  settings.areal_density = 0.5;
  settings.substeps = 1;
  MockCloth cloth(settings, build_cloth(settings, "cloth.0"));
  WorldSettings world_settings;
  world_settings.gravity = Vec3(0, -9.81, 0);
  FluidSettings fluid;
  fluid.spacing = 0.01;
  World world(world_settings, fluid);
  SurfaceId id;
  ASSERT_TRUE(world.attach(cloth, SurfaceSettings(), &id).ok());
  BoxEmitter water;
  water.box = {Vec3(-0.05, -0.01, -0.05), Vec3(0.05, 0.03, 0.05)};
  ASSERT_TRUE(world.add_emitter(water).ok());
  constexpr double dt = 1.0 / 600;
  while (world.time() < 0.3) {
    cloth.advance(world.time(), dt, world_settings.gravity);
    ASSERT_TRUE(world.step(dt).status.ok());
  }
  const SurfaceMotion& motion = *world.surface(id);
  std::vector<double> ratios;
  for (std::size_t i = 0; i < motion.added_mass.size(); ++i)
    if (motion.added_mass[i] > 0) ratios.push_back(motion.added_mass[i] / own_mass(motion, i));
  std::sort(ratios.begin(), ratios.end());
  ASSERT_GT(ratios.size(), 40u);
  EXPECT_GT(ratios.back(), 0.5);
  // But for those that the water hardly touches.
  EXPECT_NEAR(ratios[ratios.size() / 4], ratios.back(), 1e-9 * ratios.back());
}

TEST(MockCloth, a_free_sheet_keeps_its_own_masses) {
  const Sheet sheet(PinKind::none);
  EXPECT_TRUE(sheet.motion.added_mass.empty());
  EXPECT_EQ(sheet.motion.inverse_mass, sheet.own);
}

}  // namespace
}  // namespace oilskin::demo
