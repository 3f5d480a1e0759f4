// A step that an exception ends leaves no trace in a wetting effect.
#include <gtest/gtest.h>

#include <stdexcept>

#include "oilskin/wetting.h"
#include "support/mock_cloth.h"
#include "support/world_helpers.h"

namespace oilskin {
namespace {

/// Throws in exchange() while asked to.
class Thrower : public Effect {
 public:
  bool throws = false;

  std::string name() const override { return "thrower"; }
  void exchange(EffectExchange&) override {
    if (throws) throw std::runtime_error("thrown by a test");
  }
};

/// Water that falls on a sheet which takes it up and drips.
struct Scene {
  test::MockCloth<double> cloth;
  Wetting wetting;
  Thrower thrower;
  World world;
  SurfaceId id;

  Scene() : cloth(sheet()), wetting(thirsty()), world(settings(), FluidSettings()) {
    cloth.gravity = Vec3(0, -9.81, 0);
    for (std::size_t i = 0; i < 17; ++i) cloth.pin(i);
    EXPECT_TRUE(world.attach(cloth, test::sheet_settings(), &id).ok());
    EXPECT_TRUE(world.add_effect(wetting).ok());
    EXPECT_TRUE(world.add_effect(thrower).ok());
    test::add_block(world, 6, Vec3(-0.0125, 0.004, -0.0125), Vec3(0, -1, 0));
  }

  static test::GridShape sheet() {
    test::GridShape g;
    g.nu = g.nv = 17;
    g.origin = Vec3(-0.1, 0, -0.1);
    g.u = Vec3(0.2, 0, 0);
    g.v = Vec3(0, 0, 0.2);
    return g;
  }
  static WettingSettings thirsty() {
    WettingSettings s;
    s.fabric.capacity = 1;
    s.absorption = 2000;
    return s;
  }
  static WorldSettings settings() {
    WorldSettings s;
    s.kill_box = {Vec3::Constant(-1), Vec3::Constant(1)};
    return s;
  }
  std::vector<std::uint8_t> saved() const {
    std::vector<std::uint8_t> bytes;
    EXPECT_TRUE(world.save(&bytes).ok());
    return bytes;
  }
};

// Liquid spreads every 4 ms: the time since then is the effect's own.
TEST(WettingFailure, leaves_no_trace) {
  Scene plain, failing;
  for (int k = 0; k < 60; ++k) {
    SCOPED_TRACE("step " + std::to_string(k));
    const auto before = failing.saved();
    const test::MockCloth<double> cloth = failing.cloth;
    failing.thrower.throws = true;
    EXPECT_THROW(failing.world.step(1e-3), std::runtime_error);
    failing.thrower.throws = false;
    EXPECT_TRUE(failing.saved() == before);
    failing.cloth = cloth;
    ASSERT_TRUE(failing.world.step(1e-3).status.ok());
    ASSERT_TRUE(plain.world.step(1e-3).status.ok());
    ASSERT_TRUE(failing.saved() == plain.saved());
  }
  EXPECT_GT(plain.world.absorbed_mass(), 0.1 * plain.world.fluid_mass());
}

}  // namespace
}  // namespace oilskin
