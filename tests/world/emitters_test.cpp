// Emitters that are changed while a world runs: ledgers, failed steps, saved worlds.
#include <gtest/gtest.h>

#include <cfenv>
#include <cmath>
#include <stdexcept>

#include "support/random.h"
#include "support/static_mesh.h"
#include "support/thrower.h"
#include "support/world_helpers.h"
#include "world/saved_bytes.h"

namespace oilskin::test {
namespace {

constexpr double pi = 3.14159265358979323846;

WorldSettings weightless(int threads = 1) {
  WorldSettings s;
  s.gravity.setZero();
  s.kill_box = {Vec3::Constant(-3), Vec3::Constant(3)};
  s.threads = threads;
  return s;
}

DiscEmitter nozzle(double speed = 2) {
  DiscEmitter e;
  e.radius = 0.0173;
  e.speed = speed;
  return e;
}

struct Hose {
  explicit Hose(int threads = 1) : world(weightless(threads)) {
    EXPECT_TRUE(world.add_effect(thrower).ok());
    EXPECT_TRUE(world.add_emitter(nozzle(), &id).ok());
  }
  /// What its owner does before step k.
  void steer(int k) {
    Random random(static_cast<std::uint64_t>(k));
    ok = ok && world.move_emitter(id, random.in_cube(0.05), random.direction(), k % 3 == 0 ? 0.007 : 0).ok();
    ok = ok && world.set_emitter_speed(id, random.uniform(1, 3)).ok();
    ok = ok && world.set_emitter_enabled(id, k % 7 != 3).ok();
    ok = ok && world.set_inherited_velocity(id, random.in_cube(1)).ok();
    EXPECT_TRUE(ok);
  }

  Thrower thrower;
  World world;
  EmitterId id;
  bool ok = true;
};

TEST(Emitters, the_volume_is_that_of_the_ledger_and_the_flow_what_is_asked) {
  Hose hose;
  double asked = 0, booked = 0;
  for (int k = 0; k < 250; ++k) {
    hose.steer(k);
    const EmitterState state = *hose.world.emitter(hose.id);
    asked += state.enabled ? 0.004 * state.speed * pi * 0.0173 * 0.0173 : 0;
    const StepReport& r = hose.world.step(0.004);
    booked += r.mass_emitted / 1000;
    const Vec3 residual = r.momentum_after + r.momentum_removed - r.momentum_before - r.momentum_emitted;
    ASSERT_LT(residual.norm(), 1e-10);
    if (k % 25 == 24) hose.world.clear();  // the volume does not depend on what becomes of it
  }
  const double volume = hose.world.emitter(hose.id)->volume;
  EXPECT_NEAR(volume, booked, 1e-12);
  EXPECT_NEAR(volume / asked, 1, 0.005);
}

TEST(Emitters, a_message_says_how_many_starts_lie_outside_of_the_kill_box) {
  FluidSettings coarse;
  coarse.spacing = 0.1;
  World w(weightless(), coarse);
  BoxEmitter box;
  box.box = {Vec3::Zero(), Vec3(4, 0.2, 0.2)};  // the kill box ends at 3 m
  ASSERT_TRUE(w.add_emitter(box).ok());
  const StepReport& r = w.step(0.004);
  EXPECT_EQ(w.particle_count(), 120u);
  ASSERT_EQ(r.messages.size(), 1u);
  EXPECT_NE(r.messages[0].find("40 starts"), std::string::npos) << r.messages[0];
  EXPECT_NE(r.messages[0].find("kill_box"), std::string::npos) << r.messages[0];
}

TEST(Emitters, what_does_not_enter_the_fluid_is_not_counted) {
  World w(weightless());
  w.set_max_particles(100);
  EmitterId id;
  ASSERT_TRUE(w.add_emitter(nozzle(), &id).ok());
  ASSERT_TRUE(w.move_emitter(id, Vec3(0, 4, 0), Vec3(1, 0, 0), 0.1).ok());  // leaves the kill box
  for (int k = 0; k < 50; ++k) w.step(0.004);
  EXPECT_EQ(w.emitter(id)->particles, 100u);
  EXPECT_NEAR(w.emitter(id)->volume, 100 * w.particle_mass() / 1000, 1e-15);
}

TEST(Emitters, a_jet_from_a_nozzle_that_is_pushed_forward_does_not_burst) {
  World w(weightless());
  EmitterId id;
  ASSERT_TRUE(w.add_emitter(nozzle(1), &id).ok());
  double fastest_across = 0;
  for (int k = 1; k <= 100; ++k) {
    ASSERT_TRUE(w.move_emitter(id, Vec3(0, -0.8 * 0.002 * k, 0), Vec3(0, -1, 0)).ok());
    w.step(0.002);
  }
  for (const Vec3& v : w.velocities()) fastest_across = std::max(fastest_across, std::hypot(v.x(), v.z()));
  EXPECT_GT(w.particle_count(), 1000u);
  EXPECT_LT(fastest_across, 0.01);
}

TEST(Emitters, a_step_that_throws_leaves_the_motion_as_it_was) {
  Hose hose, other;
  for (int k = 0; k < 20; ++k) {
    hose.steer(k);
    other.steer(k);
    const Bytes before = save(hose.world);
    hose.thrower.throws_in_act = true;
    EXPECT_THROW(hose.world.step(0.003), std::runtime_error);
    hose.thrower.throws_in_act = false;
    EXPECT_EQ(save(hose.world), before);
    hose.world.step(0.004);
    other.world.step(0.004);
    ASSERT_EQ(hose.world.state_hash(), other.world.state_hash());
  }
  EXPECT_GT(hose.world.particle_count(), 100u);
}

TEST(Emitters, a_restored_world_has_the_handles_and_goes_on_bit_for_bit) {
  Hose hose, again(2);
  for (int k = 0; k < 10; ++k) {
    hose.steer(k);
    hose.world.step(0.004);
  }
  hose.steer(12);  // a motion of several steps is under way
  hose.world.step(0.002);
  const Bytes bytes = save(hose.world);
  ASSERT_TRUE(again.world.restore(bytes).ok());
  EXPECT_EQ(save(again.world), bytes);
  for (int k = 10; k < 30; ++k) {
    hose.world.step(0.004);
    again.world.step(0.004);
    ASSERT_EQ(again.world.state_hash(), hose.world.state_hash());
    hose.steer(k);
    again.steer(k);
  }
  EXPECT_EQ(again.world.emitter(again.id)->particles, hose.world.emitter(hose.id)->particles);
}

TEST(Emitters, one_short_emitter_per_frame_does_not_make_a_world_grow) {
  World w(weightless());
  std::size_t first = 0;
  for (int k = 0; k < 20; ++k) {
    DiscEmitter shot = nozzle();
    shot.start = w.time();
    shot.stop = w.time() + 0.001;
    ASSERT_TRUE(w.add_emitter(shot).ok());
    w.step(0.004);
    EXPECT_GT(w.particle_count(), 0u);
    w.clear();
    w.step(0.004);  // books what was removed
    if (k == 0) first = save(w).size();
  }
  EXPECT_EQ(save(w).size(), first);
}

TEST(Emitters, what_makes_no_sense_is_refused) {
  World w(weightless());
  EmitterId id;
  ASSERT_TRUE(w.add_emitter(nozzle(), &id).ok());
  const Bytes before = save(w);
  const EmitterId unknown{77};
  EXPECT_NE(w.set_emitter_speed(unknown, 1).message.find("no emitter 77"), std::string::npos);
  EXPECT_FALSE(w.move_emitter(id, Vec3::Constant(std::nan("")), Vec3(1, 0, 0)).ok());
  EXPECT_FALSE(w.place_emitter(id, Vec3::Zero(), Vec3::Zero()).ok());
  EXPECT_FALSE(w.emitter(unknown));
  EXPECT_FALSE(w.remove_emitter(unknown));
  EmitterPose outside;
  outside.position = Vec3(20, 0, 0);
  EXPECT_NE(w.add_emitter(nozzle(), nullptr, &outside).message.find("kill box"), std::string::npos);
  EXPECT_EQ(save(w), before);
}

/// A box of water within a crate, and a nozzle in its wall.
TEST(Emitters, without_a_free_start_are_named) {
  for (const bool is_nozzle : {false, true}) {
    World w(weightless(), of_spacing(0.01));
    StaticMesh crate;
    crate.add_box({Vec3::Constant(-0.2), Vec3(0.2, 0.2, 0)}, 1);
    crate.solid = true;
    ASSERT_TRUE(w.attach(crate, sheet_settings(), nullptr).ok());
    BoxEmitter box;
    box.box = {Vec3(-0.05, -0.05, -0.15), Vec3(0.05, 0.05, -0.05)};
    DiscEmitter in_wall = nozzle();  // above the middle of the crate's top
    in_wall.direction = Vec3(0, 0, 1);
    ASSERT_TRUE((is_nozzle ? w.add_emitter(in_wall) : w.add_emitter(box)).ok());
    std::vector<std::string> messages;
    for (int k = 0; k < 5; ++k)
      for (const std::string& m : w.step(0.01).messages) messages.push_back(m);
    EXPECT_EQ(w.particle_count(), 0u);
    ASSERT_GT(messages.size(), 0u);
    const char* expected = is_nozzle ? " starts of the nozzles is free: they lie in or at a surface"
                                     : "none of the 1000 starts of a volume is free";
    EXPECT_NE(messages[0].find(expected), std::string::npos) << messages[0];
  }
}

TEST(Emitters, outside_of_the_kill_box_have_one_message) {
  World w(weightless(), of_spacing(0.01));
  EmitterId id;
  ASSERT_TRUE(w.add_emitter(nozzle(), &id).ok());
  ASSERT_TRUE(w.place_emitter(id, Vec3(5, 0, 0), Vec3::UnitX()).ok());
  StepReport r;
  for (int k = 0; k < 5 && r.messages.empty(); ++k) r = w.step(0.01);
  ASSERT_EQ(r.messages.size(), 1u);
  EXPECT_NE(r.messages[0].find("outside of the kill box"), std::string::npos) << r.messages[0];
}

/// A program may trap FE_INVALID: a box of water at rest has no direction.
TEST(Emitters, of_water_at_rest_divide_nothing_by_zero) {
  World w(weightless(), of_spacing(0.01));
  BoxEmitter box;
  box.box = {Vec3::Constant(-0.05), Vec3::Constant(0.05)};
  std::feclearexcept(FE_ALL_EXCEPT);
  ASSERT_TRUE(w.add_emitter(box).ok());
  for (int k = 0; k < 3; ++k) w.step(0.01);
  EXPECT_EQ(w.particle_count(), 1000u);
  EXPECT_EQ(std::fetestexcept(FE_INVALID | FE_DIVBYZERO), 0);
}

}  // namespace
}  // namespace oilskin::test
