// A step that an exception ends leaves no trace in a wetting effect.
#include <gtest/gtest.h>

#include "effects/wetting_scene.h"
#include "support/thrower.h"
#include "world/saved_bytes.h"

namespace oilskin::test {
namespace {

/// Takes up water and drips.
WettingSettings dripping() {
  WettingSettings s = thirsty();
  s.fabric.capacity = 1;
  s.dripping = 5;
  return s;
}

struct Scene : WetScene {
  Thrower thrower;

  Scene() : WetScene(dripping(), Vec3(0, -9.81, 0)) {
    pin_border();
    EXPECT_TRUE(world.add_effect(thrower).ok());
    add_block(6, Vec3(-0.0125, 0.004, -0.0125), Vec3(0, -1, 0));
  }
};

// Liquid spreads every 4 ms: the time since then is the effect's own.
TEST(WettingFailure, leaves_no_trace) {
  Scene plain, failing;
  for (int k = 0; k < 60; ++k) {
    SCOPED_TRACE("step " + std::to_string(k));
    const Bytes before = save(failing.world);
    const MockCloth<double> cloth = failing.cloth;
    failing.thrower.throws_in_exchange = true;
    EXPECT_THROW(failing.world.step(1e-3), std::runtime_error);
    failing.thrower.throws_in_exchange = false;
    EXPECT_TRUE(save(failing.world) == before);
    failing.cloth = cloth;
    ASSERT_TRUE(failing.world.step(1e-3).status.ok());
    ASSERT_TRUE(plain.world.step(1e-3).status.ok());
    ASSERT_TRUE(save(failing.world) == save(plain.world));
  }
  EXPECT_GT(plain.world.absorbed_mass(), 0.1 * plain.world.fluid_mass());
}

}  // namespace
}  // namespace oilskin::test
