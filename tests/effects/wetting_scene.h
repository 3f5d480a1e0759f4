/// Water on a sheet that takes it up.
#pragma once

#include <gtest/gtest.h>

#include <numeric>

#include "oilskin/wetting.h"
#include "support/mock_cloth.h"
#include "support/world_helpers.h"

namespace oilskin::test {

constexpr double dx = 0.005;

inline WorldSettings world_settings(const Vec3& gravity, int threads) {
  WorldSettings s;
  s.gravity = gravity;
  s.threads = threads;
  s.kill_box = {Vec3::Constant(-1), Vec3::Constant(1)};
  return s;
}

inline ContactSettings verified() {
  ContactSettings s;
  s.verify = true;
  return s;
}

/// A square sheet of 0.2 m in the plane y = 0.
inline GridShape sheet() {
  GridShape g;
  g.nu = g.nv = 17;
  g.origin = Vec3(-0.1, 0, -0.1);
  g.u = Vec3(0.2, 0, 0);
  g.v = Vec3(0, 0, 0.2);
  return g;
}

inline double sum(Span<const double> values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

/// Water, a sheet that absorbs, and their ledger.
struct WetScene {
  MockCloth<double> cloth;
  Wetting wetting;
  World world;
  SurfaceId id;
  double emitted = 0, removed = 0, dried = 0, lost = 0;
  std::uint64_t absorbed = 0, released = 0;

  explicit WetScene(const WettingSettings& settings, const Vec3& gravity = Vec3::Zero(), int threads = 1,
                    const GridShape& shape = sheet())
      : cloth(shape),
        wetting(settings),
        world(world_settings(gravity, threads), FluidSettings(), verified()) {
    cloth.gravity = gravity;
    EXPECT_TRUE(world.attach(cloth, sheet_settings(), &id).ok());
    EXPECT_TRUE(world.add_effect(wetting).ok());
  }

  void pin_border() {
    for (std::size_t i = 0; i < 17; ++i)
      for (std::size_t j = 0; j < 17; ++j)
        if (i == 0 || j == 0 || i == 16 || j == 16) cloth.pin(i + 17 * j);
  }
  void add_block(int n, const Vec3& corner, const Vec3& velocity) {
    test::add_block(world, n, corner, velocity);
    emitted = world.fluid_mass();
  }

  Vec3 momentum() const { return cloth.momentum() + fluid_momentum(world); }
  double missing() const {
    return emitted - removed - dried - lost - world.fluid_mass() - world.absorbed_mass();
  }
  void step(double dt) {
    const StepReport& r = world.step(dt);
    ASSERT_TRUE(r.status.ok()) << r.status.message;
    EXPECT_EQ(r.contact.crossings_found_by_verify, 0u);
    emitted += r.mass_emitted;
    removed += r.mass_removed;
    dried += r.mass_dried;
    lost += r.mass_lost;
    absorbed += r.absorbed;
    released += r.released;
    ASSERT_LE(r.momentum_residual().norm(), 1e-12);
  }
};

inline WettingSettings thirsty() {
  WettingSettings s;
  s.fabric.capacity = 5;
  s.absorption = 2000;
  s.dripping = 0;
  return s;
}

}  // namespace oilskin::test
