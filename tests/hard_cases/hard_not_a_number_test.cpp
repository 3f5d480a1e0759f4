// Hard cases 24, 24b, 24c: NaN and infinity.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>

#include "hard_cases/cloth_scene.h"
#include "hard_cases/hard_case.h"
#include "hard_cases/water.h"

namespace oilskin::test {
namespace {

using namespace water;

/// Positions and velocities in order of id.
std::vector<Vec3> state_of(const World& w, std::uint64_t without = 0) {
  std::vector<std::size_t> order(w.particle_count());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return w.ids()[a] < w.ids()[b]; });
  std::vector<Vec3> state;
  for (std::size_t i : order) {
    if (w.ids()[i] == without) continue;
    state.push_back(w.positions()[i]);
    state.push_back(w.velocities()[i]);
  }
  return state;
}

constexpr double infinity = std::numeric_limits<double>::infinity();
const double not_a_number = std::nan("");

TEST(HardFluid, a_particle_that_is_not_finite_is_removed_and_the_others_keep_their_bits) {
  HardCase c("24", "NaN, ±Inf and 1e300 as the velocity of one particle among 217, three solvers");
  std::uint64_t removed_invalid = 0, different = 0;
  for (PressureSolver solver : all_solvers) {
    // Without the particle, then with one that is spoilt before the first step: the last of the block's ids,
    // in the middle of its water.
    std::vector<std::vector<Vec3>> states;
    for (double bad : {0.0, not_a_number, infinity, -infinity, 1e300}) {
      ClothSetup setup;
      setup.fluid = solver_of(solver);
      ClothScene<double> scene(setup, 1, [](ClothScene<double>& s) {
        fill(s.world(), lattice(6, 6, 6, Vec3(-0.0151, 0.003, -0.0147)), Vec3(0, -2, 0));
      });
      World& w = scene.world();
      if (bad != 0) {
        fill(w, {Vec3(-0.0026, 0.0155, -0.0022)});
        std::vector<Vec3> dv(w.particle_count(), Vec3::Zero());
        dv.back().y() = bad;
        ASSERT_TRUE(w.add_velocities(dv).ok());
      }
      for (int k = 0; k < 20; ++k) {
        const StepReport& r = w.step(1e-3);
        ASSERT_TRUE(r.status.ok());
        removed_invalid += r.removed_invalid;
        ASSERT_EQ(r.removed_invalid, k == 0 && bad != 0 ? 1u : 0u);
        ASSERT_EQ((r.flags & flag_removed_invalid) != 0, k == 0 && bad != 0);
      }
      states.push_back(state_of(w));
      for (const auto& x : scene.cloths[0]->x) states.back().push_back(x);
    }
    for (const auto& state : states) different += state != states.front();
  }
  c.equal("particles removed", removed_invalid, 12);
  c.equal("runs whose other particles have other bits", different, 0);
}

/// A mock cloth that spoils what gather() reports.
class Spoilt : public MockCloth<double> {
 public:
  using MockCloth<double>::MockCloth;
  std::function<void(SurfaceMotion&)> spoil;
  Gathered gather(double dt, SurfaceMotion& m) override {
    Gathered gathered = MockCloth<double>::gather(dt, m);
    if (spoil) spoil(m);
    return gathered;
  }
};

TEST(HardFluid, a_node_or_a_target_that_is_not_finite_excludes_its_surface_and_nothing_else) {
  HardCase c("24b", "NaN or Inf as a node's position, velocity or mass, or as a pin's target");
  const std::function<void(SurfaceMotion&)> faults[] = {
      nullptr,  // detached at that step instead
      [](SurfaceMotion& m) { m.x_t1[40].x() = not_a_number; },
      [](SurfaceMotion& m) { m.x_t1[0].y() = infinity; },  // the target of a pin
      [](SurfaceMotion& m) { m.velocity[41].z() = -infinity; },
      [](SurfaceMotion& m) { m.velocity[42].z() = not_a_number; },
      [](SurfaceMotion& m) { m.inverse_mass[43] = not_a_number; },
      [](SurfaceMotion& m) { m.inverse_mass[43] = infinity; },
  };
  std::vector<std::vector<Vec3>> states;
  for (const auto& fault : faults) {
    ClothSetup setup;
    ClothScene<double> scene(setup, 1, [](ClothScene<double>& s) {
      fill(s.world(), lattice(5, 5, 5, Vec3(-0.0126, 0.003, -0.0122)), Vec3(0, -2, 0));
    });
    World& w = scene.world();
    GridShape below = setup.shape;
    below.origin.y() = -0.01;
    Spoilt spoilt(below);
    spoilt.pin(0);
    SurfaceId id;
    ASSERT_TRUE(w.attach(spoilt, sheet_settings(), &id).ok());
    for (int k = 0; k < 40; ++k) {
      if (k == 10 && fault) spoilt.spoil = fault;
      if (k == 10 && !fault) w.detach(id);
      const StepReport& r = w.step(1e-3);
      ASSERT_TRUE(r.status.ok());
      ASSERT_EQ((r.flags & flag_surface_refused) != 0, fault && k >= 10);
      ASSERT_EQ(r.messages.size(), fault && k == 10 ? 1u : 0u) << "said once";
      ASSERT_LE(r.momentum_residual().norm(), 1e-12);
    }
    states.push_back(state_of(w));
    for (const auto& x : scene.cloths[0]->x) states.back().push_back(x);
  }
  std::uint64_t different = 0;
  for (const auto& state : states) different += state != states.front();
  c.note("runs", std::uint64_t{states.size()});
  c.equal("runs with other bits than without that surface", different, 0);
}

TEST(HardFluid, forces_that_are_not_finite_are_refused) {
  HardCase c("24c", "NaN or Inf as gravity, dt, emitter, place or velocity");
  ClothSetup setup;
  ClothScene<double> scene(setup, 1, [](ClothScene<double>& s) {
    fill(s.world(), lattice(5, 5, 5, Vec3(-0.0126, 0.003, -0.0122)), Vec3(0, -2, 0));
  });
  World& w = scene.world();
  std::uint64_t accepted = 0, changes = 0;
  for (double bad : {not_a_number, infinity, -infinity}) {
    const std::uint64_t hash = w.state_hash();
    accepted += w.set_gravity(Vec3(0, bad, 0)).ok();
    accepted += w.step(bad).status.ok();
    DiscEmitter jet;
    jet.speed = bad;
    accepted += w.add_emitter(jet).ok();
    jet = {};
    jet.center.x() = bad;
    accepted += w.add_emitter(jet).ok();
    const Vec3 x(0, 0.1, bad), v = Vec3::Zero();
    accepted += w.add_particles(Span<const Vec3>(&x, 1), Span<const Vec3>(&v, 1)).ok();
    accepted += w.add_particles(Span<const Vec3>(&v, 1), Span<const Vec3>(&x, 1)).ok();
    changes += w.state_hash() != hash;
  }
  EXPECT_TRUE(w.step(1e-3).status.ok());
  EXPECT_EQ(w.report().removed_invalid, 0u);
  c.equal("accepted", accepted, 0);
  c.equal("changes of the state", changes, 0);
}

}  // namespace
}  // namespace oilskin::test
