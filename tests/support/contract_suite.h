/// What every host must do, as tests: run on the mock cloth and on Bullet, in float and in double.
///
/// A fixture provides:
///   World& world();                         the world that the host is attached to by attach()
///   Status attach(SurfaceSettings);         a square sheet of 0.2 m in the plane y = 0, centre at the origin
///   void pin(int i, int j);                 before attach; nodes (0 … 16)²
///   void move_pin(int i, int j, Vec3 by);   as a user would, between steps
///   void step(double dt);                   the host's own motion and the coupling
///   Vec3 momentum();                        of free nodes [N s]
///   Vec3 position(int i, int j);
///   SurfaceId id();
///   static constexpr bool is_double;
/// No gravity acts on the sheet.
#pragma once

#include <gtest/gtest.h>

#include "oilskin/wetting.h"
#include "support/world_helpers.h"

namespace oilskin::test {

/// Settings of every fixture of the contract: no gravity, crossings are counted.
inline WorldSettings contract_world() {
  WorldSettings s;
  s.gravity.setZero();
  s.kill_box = {Vec3::Constant(-2), Vec3::Constant(2)};
  return s;
}
inline FluidSettings contract_fluid(int max_substeps) {
  FluidSettings s;
  s.max_substeps = max_substeps;
  return s;
}
inline ContactSettings contract_contact() {
  ContactSettings s;
  s.verify = true;
  return s;
}

/// A fabric that takes up much within a few steps.
inline WettingSettings contract_wetting() {
  WettingSettings s;
  s.fabric.capacity = 5;
  s.absorption = 500;
  return s;
}

template <class Fixture>
class HostContract : public ::testing::Test {
 protected:
  Fixture fixture;
};
TYPED_TEST_SUITE_P(HostContract);

TYPED_TEST_P(HostContract, momentum_given_is_momentum_kept) {
  auto& host = this->fixture;
  ASSERT_TRUE(host.attach(sheet_settings()).ok());
  World& w = host.world();
  add_block(w, 5, Vec3(-0.01, 0.003, -0.013), Vec3(0.2, -1.5, 0.1));
  const Vec3 start = fluid_momentum(w) + host.momentum();
  for (int k = 0; k < 60; ++k) {
    host.step(1e-3);
    const StepReport& r = w.report();
    ASSERT_TRUE(r.status.ok()) << r.status.message;
    EXPECT_LE(r.momentum_residual().norm(), 1e-10 * start.norm()) << "step " << k;
  }
  const Vec3 end = fluid_momentum(w) + host.momentum();
  EXPECT_GT(host.momentum().norm(), 0.1 * start.norm()) << "the sheet was not hit";
  EXPECT_LE((end - start).norm(), (TypeParam::is_double ? 1e-10 : 1e-4) * start.norm());
}

TYPED_TEST_P(HostContract, nothing_crosses_at_any_speed) {
  auto& host = this->fixture;
  for (int c : {0, 16})
    for (int d : {0, 16}) host.pin(c, d);
  ASSERT_TRUE(host.attach(sheet_settings()).ok());
  World& w = host.world();
  add_block(w, 3, Vec3(-0.05, 0.01, -0.053), Vec3(0, -3, 0));
  add_block(w, 3, Vec3(0.03, 0.02, 0.027), Vec3(3, -60, 0));
  add_block(w, 3, Vec3(0.03, -0.2, -0.053), Vec3(0, 500, 0));
  std::uint64_t meetings = 0;
  for (int k = 0; k < 40; ++k) {
    host.step(1e-3);
    ASSERT_TRUE(w.report().status.ok());
    ASSERT_EQ(w.report().contact.crossings_found_by_verify, 0u) << "step " << k;
    ASSERT_EQ(w.report().contact.removed, 0u);
    meetings += w.report().contact.impacts;
  }
  EXPECT_GT(meetings, 0u);
}

TYPED_TEST_P(HostContract, what_the_next_step_starts_from_is_what_was_certified) {
  auto& host = this->fixture;
  ASSERT_TRUE(host.attach(sheet_settings()).ok());
  World& w = host.world();
  add_block(w, 4, Vec3(-0.01, 0.003, -0.013), Vec3(0, -3, 0));

  class Watch : public IntervalObserver {
   public:
    std::vector<Vec3> last;
    int jumps = 0, records = 0;
    void on_interval(const Interval& i) override {
      const SurfaceMotion& s = *i.surfaces[0];
      if (records++ > 0) jumps += s.x_t0 != last;
      for (const Vec3& x : s.x_t1) jumps += stored(x, s.storage) != x;
      last = s.x_t1;
    }
  } watch;
  w.set_observer(&watch);
  for (int k = 0; k < 30; ++k) {
    host.step(1e-3);
    ASSERT_EQ(w.report().flags & flag_scatter_mismatch, 0u);
  }
  w.set_observer(nullptr);
  EXPECT_GE(watch.records, 30) << "one per certified interval";
  EXPECT_EQ(watch.jumps, 0);
}

TYPED_TEST_P(HostContract, pins_dragged_by_hand_are_swept_not_jumped) {
  auto& host = this->fixture;
  for (int i = 0; i <= 16; ++i)
    for (int j = 0; j <= 16; ++j) host.pin(i, j);
  ASSERT_TRUE(host.attach(sheet_settings()).ok());
  World& w = host.world();
  add_block(w, 4, Vec3(-0.01, 0.02, -0.013), Vec3::Zero());
  for (int k = 0; k < 10; ++k) {
    for (int i = 0; i <= 16; ++i)
      for (int j = 0; j <= 16; ++j) host.move_pin(i, j, Vec3(0, 0.015, 0));  // 15 m/s
    host.step(1e-3);
    ASSERT_EQ(w.report().contact.crossings_found_by_verify, 0u);
    for (const Vec3& x : w.positions()) ASSERT_GT(x.y(), 0.015 * (k + 1)) << "step " << k;
  }
  EXPECT_EQ(w.particle_count(), 64u);
  EXPECT_GT(fluid_momentum(w).y(), 64 * w.particle_mass() * 10) << "the water is carried along";
}

TYPED_TEST_P(HostContract, a_teleport_is_a_new_surface_and_leaves_no_particle_too_near) {
  auto& host = this->fixture;
  for (int i = 0; i <= 16; ++i)
    for (int j = 0; j <= 16; ++j) host.pin(i, j);
  ASSERT_TRUE(host.attach(sheet_settings()).ok());
  World& w = host.world();
  add_block(w, 3, Vec3(-0.01, 0.0201, -0.013), Vec3::Zero());
  host.step(1e-3);
  const std::uint64_t before = w.surface(host.id())->id;
  for (int i = 0; i <= 16; ++i)
    for (int j = 0; j <= 16; ++j) host.move_pin(i, j, Vec3(0, 0.02010001, 0));
  w.reset_motion(host.id());
  host.step(1e-3);
  EXPECT_NE(w.surface(host.id())->id, before);
  EXPECT_GT(w.report().contact.relocated, 0u);
  EXPECT_EQ(w.report().contact.crossings_found_by_verify, 0u);
  host.step(1e-3);
  EXPECT_EQ(w.report().contact.crossings_found_by_verify, 0u);
}

TYPED_TEST_P(HostContract, a_thickness_below_four_deltas_is_refused_with_what_would_do) {
  auto& host = this->fixture;
  const Status s = host.attach(sheet_settings(TypeParam::is_double ? 1e-16 : 1e-6));
  EXPECT_FALSE(s.ok());
  EXPECT_NE(s.message.find("below 4 δ"), std::string::npos) << s.message;
  EXPECT_NE(s.message.find("must be ≥"), std::string::npos) << s.message;
  EXPECT_EQ(host.world().surface_count(), 0u);
}

TYPED_TEST_P(HostContract, reactions_of_pins_carry_what_the_fluid_loses) {
  auto& host = this->fixture;
  for (int i = 0; i <= 16; ++i)
    for (int j = 0; j <= 16; ++j) host.pin(i, j);
  ASSERT_TRUE(host.attach(sheet_settings()).ok());
  World& w = host.world();
  add_block(w, 4, Vec3(-0.01, 0.003, -0.013), Vec3(0, -2, 0));
  const Vec3 start = fluid_momentum(w);
  Vec3 reaction = Vec3::Zero();
  for (int k = 0; k < 20; ++k) {
    host.step(1e-3);
    reaction += w.report().contact.impulse_on_prescribed;
    EXPECT_EQ(w.report().contact.impulse_on_free_nodes, Vec3::Zero());
  }
  EXPECT_LE((fluid_momentum(w) + reaction - start).norm(), 1e-10 * start.norm());
  EXPECT_LT(reaction.y(), 0.5 * start.y());
}

TYPED_TEST_P(HostContract, a_detached_surface_stops_nothing) {
  auto& host = this->fixture;
  for (int i = 0; i <= 16; ++i)
    for (int j = 0; j <= 16; ++j) host.pin(i, j);
  ASSERT_TRUE(host.attach(sheet_settings()).ok());
  World& w = host.world();
  add_block(w, 2, Vec3(-0.01, 0.01, -0.013), Vec3(0, -5, 0));
  host.step(1e-3);
  w.detach(host.id());
  EXPECT_EQ(w.surface(host.id()), nullptr);
  for (int k = 0; k < 10; ++k) w.step(1e-3);
  for (const Vec3& x : w.positions()) EXPECT_LT(x.y(), 0);
}

TYPED_TEST_P(HostContract, carried_mass_is_that_of_loaded_free_nodes_and_hosts_may_ignore_it) {
  auto& host = this->fixture;
  for (int i = 0; i <= 16; ++i)
    for (int j : {0, 16}) host.pin(i, j), host.pin(j, i);
  ASSERT_TRUE(host.attach(sheet_settings()).ok());
  World& w = host.world();
  add_block(w, 5, Vec3(-0.01, 0.003, -0.013), Vec3(0, -1.5, 0));
  const double layer = w.fluid_settings().rest_density * w.fluid_settings().spacing;
  double carried = 0;
  for (int k = 0; k < 25; ++k) {
    host.step(4e-3);
    const SurfaceMotion& s = *w.surface(host.id());
    ASSERT_EQ(s.carried_mass.size(), s.x_t1.size());
    ASSERT_TRUE(s.added_mass.empty() || s.added_mass.size() == s.x_t1.size());
    Vec3 owed = Vec3::Zero();
    double sum = 0, area = 0;
    for (const Triangle& t : s.triangles)
      area += 0.5 * (s.x_t1[t[1]] - s.x_t1[t[0]]).cross(s.x_t1[t[2]] - s.x_t1[t[0]]).norm();
    for (std::size_t i = 0; i < s.x_t1.size(); ++i) {
      EXPECT_GE(s.carried_mass[i], 0);
      if (s.inverse_mass[i] == 0) {
        EXPECT_EQ(s.carried_mass[i], 0) << "a pin carries by its support";
      }
      sum += s.carried_mass[i];
      if (s.added_mass.empty()) continue;
      EXPECT_LT(s.added_mass[i] * s.inverse_mass[i], 1);
      owed += s.added_mass[i] * s.inverse_mass[i] * s.impulse[i];
    }
    EXPECT_LE((w.report().momentum_owed - owed).norm(), 1e-12 * owed.norm());
    EXPECT_LT(sum, 0.5001 * layer * area) << "half a layer";
    EXPECT_EQ(sum > 0, w.report().carried_ratio > 0);
    carried = std::max(carried, sum);
  }
  EXPECT_GT(carried, 0);
  w.reset_motion(host.id());
  EXPECT_TRUE(w.surface(host.id())->carried_mass.empty()) << "a teleport leaves the load behind";
}

TYPED_TEST_P(HostContract, small_loads_are_carried_by_nothing_but_the_sheet) {
  auto& host = this->fixture;
  for (int i = 0; i <= 16; ++i)
    for (int j : {0, 16}) host.pin(i, j), host.pin(j, i);
  ASSERT_TRUE(host.attach(sheet_settings()).ok());
  World& w = host.world();
  add_block(w, 5, Vec3(-0.01, 0.003, -0.013), Vec3(0, -0.1, 0));
  for (int k = 0; k < 60; ++k) {
    host.step(5e-4);
    for (double m : w.surface(host.id())->carried_mass) ASSERT_EQ(m, 0) << "step " << k;
    ASSERT_EQ(w.report().momentum_owed, Vec3::Zero());
  }
  EXPECT_GT(w.report().load_speed, 0);
}

/// Liquid that a sheet absorbs weighs on it: the host's masses, and the momentum of both.
TYPED_TEST_P(HostContract, absorbed_liquid_weighs_and_keeps_its_momentum) {
  auto& host = this->fixture;
  ASSERT_TRUE(host.attach(sheet_settings()).ok());
  World& w = host.world();
  Wetting wetting(contract_wetting());
  ASSERT_TRUE(w.add_effect(wetting).ok());
  add_block(w, 5, Vec3(-0.01, 0.003, -0.013), Vec3(0.2, -1, 0.1));
  const double water = w.fluid_mass();
  const Vec3 start = fluid_momentum(w) + host.momentum();
  for (int k = 0; k < 150; ++k) {
    host.step(1e-3);
    const StepReport& r = w.report();
    ASSERT_TRUE(r.status.ok()) << r.status.message;
    EXPECT_LE(r.momentum_residual().norm(), 1e-10 * start.norm()) << "step " << k;
    EXPECT_NEAR(w.fluid_mass() + w.absorbed_mass(), water, 1e-12 * water);
    EXPECT_LE((fluid_momentum(w) + host.momentum() - start).norm(),
              (TypeParam::is_double ? 1e-10 : 1e-4) * start.norm())
        << "step " << k;
  }
  EXPECT_GT(w.absorbed_mass(), 0.3 * water);
  w.remove_effect(wetting);
}

/// Pins stay pins, and nothing is lost.
TYPED_TEST_P(HostContract, pinned_nodes_absorb_too) {
  auto& host = this->fixture;
  for (int i = 0; i < 17; ++i)
    for (int j = 0; j < 17; ++j)
      if ((i + j) % 2 == 0) host.pin(i, j);
  ASSERT_TRUE(host.attach(sheet_settings()).ok());
  World& w = host.world();
  Wetting wetting(contract_wetting());
  ASSERT_TRUE(w.add_effect(wetting).ok());
  add_block(w, 4, Vec3(-0.01, 0.003, -0.013), Vec3(0, -0.5, 0));
  const double water = w.fluid_mass();
  for (int k = 0; k < 60; ++k) {
    host.step(1e-3);
    ASSERT_LE(w.report().momentum_residual().norm(), 1e-12);
    ASSERT_NEAR(w.fluid_mass() + w.absorbed_mass(), water, 1e-12 * water);
  }
  const SurfaceMotion* sheet = w.surface(host.id());
  ASSERT_NE(sheet, nullptr);
  double pinned = 0;
  for (std::size_t i = 0; i < sheet->absorbed_mass.size(); ++i)
    if (sheet->inverse_mass[i] == 0) pinned += sheet->absorbed_mass[i];
  EXPECT_GT(pinned, 0);
  w.remove_effect(wetting);
}

REGISTER_TYPED_TEST_SUITE_P(HostContract, carried_mass_is_that_of_loaded_free_nodes_and_hosts_may_ignore_it,
                            small_loads_are_carried_by_nothing_but_the_sheet, momentum_given_is_momentum_kept,
                            nothing_crosses_at_any_speed,
                            what_the_next_step_starts_from_is_what_was_certified,
                            pins_dragged_by_hand_are_swept_not_jumped,
                            a_teleport_is_a_new_surface_and_leaves_no_particle_too_near,
                            a_thickness_below_four_deltas_is_refused_with_what_would_do,
                            reactions_of_pins_carry_what_the_fluid_loses, a_detached_surface_stops_nothing,
                            absorbed_liquid_weighs_and_keeps_its_momentum, pinned_nodes_absorb_too);

}  // namespace oilskin::test
