// The limit of the number of particles.
#include <gtest/gtest.h>

#include "world/saved_bytes.h"

namespace oilskin::test {
namespace {

WorldSettings pool() {
  WorldSettings s;
  s.kill_box = {Vec3::Constant(-0.5), Vec3::Constant(0.5)};
  s.threads = 1;
  return s;
}

World& with_jet(World& w) {
  DiscEmitter jet;
  jet.radius = 0.012;
  jet.speed = 2;
  EXPECT_TRUE(w.add_emitter(jet).ok());
  return w;
}

TEST(ParticleLimit, emitters_stop_there_and_go_on_when_particles_have_left) {
  World free(pool()), limited(pool());
  with_jet(free);
  with_jet(limited).set_max_particles(100);
  EXPECT_EQ(limited.settings().max_particles, 100u);
  std::uint64_t starts = 0, emitted = 0, lost = 0;
  for (int k = 0; k < 60; ++k) {
    if (k == 40) {
      EXPECT_EQ(limited.particle_count(), 100u);
      limited.clear();
    }
    starts += free.step(1e-3).emitted;
    const StepReport& r = limited.step(1e-3);
    emitted += r.emitted;
    lost += r.limited_starts;
    EXPECT_NEAR(r.mass_emitted, static_cast<double>(r.emitted) * limited.particle_mass(), 1e-15);
    EXPECT_LE(limited.particle_count(), 100u);
  }
  EXPECT_GT(emitted, 100u);
  EXPECT_EQ(emitted + lost, starts) << "what is lost does not come later";
  limited.set_max_particles(0);
  for (int k = 0; k < 30; ++k) EXPECT_EQ(limited.step(1e-3).limited_starts, 0u);
  EXPECT_GT(limited.particle_count(), 100u);
}

TEST(ParticleLimit, boxes_are_filled_in_part_and_a_smaller_limit_removes_nothing) {
  WorldSettings settings = pool();
  settings.max_particles = 50;
  World w(settings);
  BoxEmitter box;
  box.box = {Vec3::Zero(), Vec3::Constant(0.02001)};
  ASSERT_TRUE(w.add_emitter(box).ok());
  EXPECT_EQ(w.step(1e-3).limited_starts, 14u);
  EXPECT_EQ(w.particle_count(), 50u);
  std::uint64_t left_out = 0;
  w.set_max_particles(52);
  const std::vector<Vec3> x = {Vec3(0.1, 0, 0), Vec3(0.2, 0, 0), Vec3(0.3, 0, 0)};
  ASSERT_TRUE(w.add_particles(x, x, &left_out).ok());
  EXPECT_EQ(left_out, 1u);
  EXPECT_EQ(w.particle_count(), 52u);
  w.set_max_particles(10);
  w.step(1e-3);
  EXPECT_EQ(w.particle_count(), 52u);
}

TEST(ParticleLimit, is_saved) {
  World w(pool()), other(pool());
  with_jet(w).set_max_particles(100);
  for (int k = 0; k < 10; ++k) w.step(1e-3);
  ASSERT_TRUE(other.restore(save(w)).ok());
  EXPECT_EQ(other.settings().max_particles, 100u);
  for (int k = 0; k < 40; ++k) {
    EXPECT_EQ(other.step(1e-3).limited_starts, w.step(1e-3).limited_starts);
    EXPECT_EQ(other.state_hash(), w.state_hash());
  }
  EXPECT_EQ(w.particle_count(), 100u);
}

TEST(AddParticles, takes_what_the_world_gives) {
  World world;
  const std::vector<Vec3> x = {Vec3(0, 0, 0), Vec3(0.1, 0, 0), Vec3(0.2, 0, 0)},
                          v = {Vec3(1, 2, 3), Vec3(4, 5, 6), Vec3(7, 8, 9)};
  ASSERT_TRUE(world.add_particles(x, v).ok());
  std::vector<Vec3> all = v;
  for (int k = 0; k < 6; ++k) {  // the arrays grow
    std::vector<Vec3> beside;
    for (const Vec3& at : world.positions()) beside.push_back(at + Vec3(0, 0.1 * (k + 1), 0));
    ASSERT_TRUE(world.add_particles(beside, world.velocities()).ok());
    const std::vector<Vec3> before = all;
    all.insert(all.end(), before.begin(), before.end());
  }
  ASSERT_EQ(world.particle_count(), all.size());
  for (std::size_t i = 0; i < all.size(); ++i) EXPECT_EQ(world.velocities()[i], all[i]);
  ASSERT_TRUE(world.add_velocities(world.velocities()).ok());
  EXPECT_EQ(world.velocities()[0], Vec3(2, 4, 6));
  EXPECT_EQ(world.motions()[0], Vec3(2, 4, 6));
}

}  // namespace
}  // namespace oilskin::test
