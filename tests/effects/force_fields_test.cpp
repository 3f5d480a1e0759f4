// Force fields: what they give, against closed forms; wind on slabs, drops and pools.
#include "oilskin/force_fields.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/record.h"
#include "support/static_mesh.h"
#include "support/world_helpers.h"

namespace oilskin::test {
namespace {

constexpr double dx = 0.01, dt = 1e-3;

WorldSettings weightless(int threads = 1) {
  WorldSettings s;
  s.gravity.setZero();
  s.kill_box = {Vec3::Constant(-2), Vec3::Constant(2)};
  s.threads = threads;
  return s;
}

FluidSettings water(double spacing = dx, double support_ratio = 2) {
  FluidSettings f;
  f.spacing = spacing;
  f.support_ratio = support_ratio;
  return f;
}

/// nx × ny × nz particles from the corner on.
void add_slab(World& w, const Vec3& corner, int nx, int ny, int nz) {
  std::vector<Vec3> x;
  const double d = w.fluid_settings().spacing;
  for (int i = 0; i < nx; ++i)
    for (int j = 0; j < ny; ++j)
      for (int k = 0; k < nz; ++k) x.push_back(corner + d * Vec3(i, j, k));
  ASSERT_TRUE(w.add_particles(x, std::vector<Vec3>(x.size(), Vec3::Zero())).ok());
}

/// The mean force of the effects in a step [N].
Vec3 force_in_step(World& w, double length = 1e-5) {
  const StepReport& r = w.step(length);
  EXPECT_TRUE(r.status.ok()) << r.status.message;
  EXPECT_LT(r.momentum_residual().norm(), 1e-12);
  return r.momentum_effects / length;
}

WindForce wind(const Vec3& velocity, double drag, double friction) {
  WindForce f;
  f.velocity = velocity;
  f.drag_coefficient = drag;
  f.friction_coefficient = friction;
  return f;
}

TEST(ForceFields, a_uniform_force_acts_in_its_region_alone) {
  World w(weightless(), water());
  ForceFields fields;
  ASSERT_TRUE(w.add_effect(fields).ok());
  UniformForce f;
  f.acceleration = Vec3(1, -2, 3);
  f.region = box_region({Vec3(0, -1, -1), Vec3(1, 1, 1)});
  ASSERT_TRUE(fields.add(f).ok());
  ASSERT_TRUE(w.add_particles(std::vector<Vec3>{Vec3(0.5, 0, 0), Vec3(-0.5, 0, 0)},
                              std::vector<Vec3>(2, Vec3::Zero()))
                  .ok());
  for (int k = 0; k < 100; ++k) ASSERT_TRUE(w.step(dt).status.ok());
  for (std::size_t i = 0; i < 2; ++i) {
    const bool inside = w.positions()[i].x() > 0;
    const Vec3 expected = inside ? 0.1 * f.acceleration : Vec3(Vec3::Zero());
    EXPECT_LT((w.velocities()[i] - expected).norm(), 1e-12);
  }
  // Σ m a · v dt, exactly what the particle has.
  EXPECT_NEAR(w.report().energy.work_outside, kinetic_energy(w), 1e-12 * kinetic_energy(w));
}

TEST(ForceFields, a_vortex_has_the_profile_of_rankine) {
  VortexForce f;
  f.center = Vec3(0.1, 0.2, 0.3);
  f.axis = Vec3(0, 3, 0);
  f.radius = 0.2;
  f.strength = 5;
  for (double distance : {0.0, 0.05, 0.2, 0.4, 0.8}) {
    World w(weightless(), water());
    ForceFields fields;
    ASSERT_TRUE(w.add_effect(fields).ok());
    ASSERT_TRUE(fields.add(f).ok());
    const Vec3 x = f.center + Vec3(distance, -0.1, 0);
    ASSERT_TRUE(w.add_particles(std::vector<Vec3>{x}, std::vector<Vec3>{Vec3::Zero()}).ok());
    ASSERT_TRUE(w.step(1e-6).status.ok());
    const double size = f.strength * (distance < f.radius ? distance / f.radius : f.radius / distance);
    EXPECT_LT((w.velocities()[0] / 1e-6 - Vec3(0, 0, -size)).norm(), 1e-9) << distance;
  }
}

/// ½ ρ_a C_d A |w| w on the face of a slab.
void expect_drag_on_slab(double spacing, double support_ratio, const Vec3& velocity, double tolerance) {
  World w(weightless(), water(spacing, support_ratio));
  ForceFields fields;
  ASSERT_TRUE(w.add_effect(fields).ok());
  ASSERT_TRUE(fields.add(wind(velocity, 1.2, 0)).ok());
  add_slab(w, Vec3::Zero(), 8, 30, 30);
  const double area = std::pow(30 * spacing, 2);
  const Vec3 expected = 0.5 * 1.2 * 1.2 * area * velocity.norm() * velocity;
  const Vec3 found = force_in_step(w);
  record("drag over expected", found.norm() / expected.norm());
  EXPECT_LT((found - expected).norm(), tolerance * expected.norm())
      << found.transpose() << " instead of " << expected.transpose();
}

TEST(Wind, gives_a_slab_the_drag_of_the_area_that_faces_it) {
  for (double support : {1.7, 2.0, 2.5})
    for (double speed : {0.5, 10.0, 300.0}) expect_drag_on_slab(dx, support, Vec3(speed, 0, 0), 0.06);
  expect_drag_on_slab(0.004, 2, Vec3(-10, 0, 0), 0.06);
}

TEST(Wind, gives_a_slab_the_friction_of_its_whole_area) {
  World w(weightless(), water());
  ForceFields fields;
  ASSERT_TRUE(w.add_effect(fields).ok());
  const Vec3 velocity(0, 8, 0);
  ASSERT_TRUE(fields.add(wind(velocity, 0, 0.01)).ok());
  add_slab(w, Vec3::Zero(), 8, 30, 30);
  const double area = (2 * 30 * 30 + 4 * 30 * 8) * dx * dx;
  const Vec3 expected = 0.5 * 1.2 * 0.01 * area * 8 * velocity;
  const Vec3 found = force_in_step(w);
  record("friction over expected", found.norm() / expected.norm());
  EXPECT_LT((found - expected).norm(), 0.12 * expected.norm());
}

TEST(Wind, leaves_water_behind_water_and_behind_walls_alone) {
  World w(weightless(), water());
  StaticMesh wall;  // from which the wind comes
  wall.add_rectangle(Vec3(-0.006, -0.1, -0.1), Vec3(0, 0.6, 0), Vec3(0, 0, 0.6), 6, 6);
  ASSERT_TRUE(w.attach(wall, sheet_settings(), nullptr).ok());
  ForceFields fields;
  ASSERT_TRUE(w.add_effect(fields).ok());
  ASSERT_TRUE(fields.add(wind(Vec3(20, 0, 0), 1, 0)).ok());
  add_slab(w, Vec3::Zero(), 8, 30, 30);
  const double on_a_free_face = 0.5 * 1.2 * 0.09 * 400;
  EXPECT_LT(force_in_step(w).norm(), 0.03 * on_a_free_face);
}

/// A drop is a ball of its volume: du/dt = −c |u| u, u = u_0/(1 + c u_0 t).
TEST(Wind, takes_a_drop_along_as_the_closed_form_says) {
  for (double step : {1e-4, 1e-2, 0.2}) {
    WorldSettings room = weightless();
    room.kill_box = {Vec3::Constant(-1000), Vec3::Constant(1000)};
    World w(room, water(0.002));
    ForceFields fields;
    ASSERT_TRUE(w.add_effect(fields).ok());
    ASSERT_TRUE(fields.add(wind(Vec3(0, 0, 30), 0.47, 0)).ok());
    ASSERT_TRUE(w.add_particles(std::vector<Vec3>{Vec3::Zero()}, std::vector<Vec3>{Vec3::Zero()}).ok());
    const double m = w.particle_mass(), c = 0.5 * 1.2 * 0.47 * std::pow(m / 1000, 2. / 3) / m;
    for (int k = 0; k < std::lround(0.2 / step); ++k) ASSERT_TRUE(w.step(step).status.ok());
    EXPECT_NEAR(30 - w.velocities()[0].z(), 30 / (1 + c * 30 * 0.2), 2e-3) << step;
  }
}

TEST(Wind, is_stable_at_any_speed_step_and_spacing) {
  for (double spacing : {1e-4, 0.01, 1.0})
    for (double speed : {1.0, 300.0, 1e5})
      for (double step : {1e-4, 0.1}) {
        WorldSettings room = weightless();
        room.kill_box = {Vec3::Constant(-1e6), Vec3::Constant(1e6)};
        FluidSettings f = water(spacing);
        f.max_substeps = 1;
        World w(room, f);
        ForceFields fields;
        ASSERT_TRUE(w.add_effect(fields).ok());
        // Two winds, of which each alone would bring a particle to its velocity.
        for (int k = 0; k < 2; ++k) ASSERT_TRUE(fields.add(wind(Vec3(speed, 0, 0), 10, 10)).ok());
        std::vector<Vec3> x(20, Vec3::Zero());
        for (std::size_t k = 0; k < x.size(); ++k) x[k].y() = 3 * static_cast<double>(k) * spacing;
        ASSERT_TRUE(w.add_particles(x, std::vector<Vec3>(20, Vec3::Zero())).ok());
        double before = 0;
        for (int k = 0; k < 5 && w.particle_count() == 20; ++k) {
          ASSERT_TRUE(w.step(step).status.ok());
          for (const Vec3& v : w.velocities()) {
            EXPECT_LE(v.x(), speed * (1 + 1e-12));
            EXPECT_GE(v.x(), before * (1 - 1e-12));
          }
          before = w.velocities()[0].x();
        }
        EXPECT_GT(before, 0);
      }
}

TEST(ForceFields, handles_add_change_switch_and_remove) {
  World w(weightless(), water());
  ForceFields fields;
  ASSERT_TRUE(w.add_effect(fields).ok());
  UniformForce f;
  f.acceleration = Vec3(1, 0, 0);
  ForceId first, second;
  ASSERT_TRUE(fields.add(f, &first).ok());
  ASSERT_TRUE(fields.add(f, &second).ok());
  ASSERT_TRUE(w.add_particles(std::vector<Vec3>{Vec3::Zero()}, std::vector<Vec3>{Vec3::Zero()}).ok());
  const auto gained = [&] {
    const double before = w.velocities()[0].x();
    EXPECT_TRUE(w.step(1e-3).status.ok());
    return (w.velocities()[0].x() - before) / 1e-3;
  };
  EXPECT_NEAR(gained(), 2, 1e-9);
  ASSERT_TRUE(fields.set_enabled(first, false).ok());
  EXPECT_FALSE(fields.find(first)->enabled);
  EXPECT_NEAR(gained(), 1, 1e-9);
  f.acceleration.x() = 5;
  ASSERT_TRUE(fields.set(second, f).ok());
  EXPECT_NEAR(gained(), 5, 1e-9);
  EXPECT_TRUE(fields.remove(second));
  EXPECT_FALSE(fields.remove(second));
  EXPECT_FALSE(fields.find(second).has_value());
  EXPECT_NEAR(gained(), 0, 1e-9);
}

TEST(ForceFields, what_makes_no_sense_is_refused_in_words) {
  ForceFields fields;
  ForceId id;
  ASSERT_TRUE(fields.add(UniformForce(), &id).ok());
  const auto refuse = [&](const Force& f, const char* word) {
    for (const Status& s : {fields.add(f), fields.set(id, f)}) {
      EXPECT_FALSE(s.ok());
      EXPECT_NE(s.message.find(word), std::string::npos) << s.message;
    }
  };
  UniformForce uniform;
  uniform.acceleration.x() = NAN;
  refuse(uniform, "acceleration");
  uniform = UniformForce();
  uniform.region = ball_region(Vec3::Zero(), -1);
  refuse(uniform, "radius");
  VortexForce vortex;
  vortex.radius = 0;
  refuse(vortex, "radius");
  vortex = VortexForce();
  vortex.axis.setZero();
  refuse(vortex, "axis");
  vortex = VortexForce();
  vortex.strength = INFINITY;
  refuse(vortex, "strength");
  WindForce w = wind(Vec3(0, NAN, 0), 1, 1);
  refuse(w, "velocity");
  refuse(wind(Vec3::Zero(), -1, 0), "drag_coefficient");
  refuse(wind(Vec3::Zero(), 1, NAN), "friction_coefficient");
  w = wind(Vec3::Zero(), 1, 0);
  w.air_density = -1;
  refuse(w, "air_density");
  EXPECT_NE(fields.set({9}, UniformForce()).message.find("no force 9"), std::string::npos);
  EXPECT_NE(fields.set_enabled({9}, true).message.find("no force 9"), std::string::npos);
  EXPECT_EQ(fields.size(), 1u);
}

/// A block in all three fields.
struct Blown {
  explicit Blown(int threads = 1) : world(weightless(threads), water()) {
    EXPECT_TRUE(world.add_effect(fields).ok());
    EXPECT_TRUE(fields.add(wind(Vec3(5, 0, 2), 1, 0.01)).ok());
    VortexForce vortex;
    vortex.strength = 3;
    EXPECT_TRUE(fields.add(vortex, &vortex_id).ok());
    UniformForce uniform;
    uniform.acceleration = Vec3(0, 1, 0);
    uniform.region = ball_region(Vec3::Zero(), 0.053);
    EXPECT_TRUE(fields.add(uniform).ok());
    add_slab(world, Vec3::Zero(), 8, 8, 8);
  }
  void step(int count) {
    for (int k = 0; k < count; ++k) ASSERT_TRUE(world.step(2e-3).status.ok());
  }
  World world;
  ForceFields fields;
  ForceId vortex_id;
};

TEST(ForceFields, do_not_depend_on_the_number_of_threads) {
  Blown one(1), four(4);
  one.step(20);
  four.step(20);
  EXPECT_EQ(one.world.state_hash(), four.world.state_hash());
}

TEST(ForceFields, are_saved_with_the_world_and_their_handles) {
  Blown a;
  a.step(5);
  ASSERT_TRUE(a.fields.set_enabled(a.vortex_id, false).ok());
  std::vector<std::uint8_t> bytes, again;
  ASSERT_TRUE(a.world.save(&bytes).ok());
  World other(weightless(), water());
  ForceFields fields;
  ASSERT_TRUE(other.add_effect(fields).ok());
  ASSERT_TRUE(other.restore(bytes).ok());
  ASSERT_TRUE(other.save(&again).ok());
  EXPECT_EQ(again, bytes);
  ASSERT_EQ(fields.size(), 3u);
  EXPECT_FALSE(fields.find(a.vortex_id)->enabled);
  ASSERT_TRUE(fields.set_enabled(a.vortex_id, true).ok());
  ASSERT_TRUE(a.fields.set_enabled(a.vortex_id, true).ok());
  a.step(10);
  for (int k = 0; k < 10; ++k) ASSERT_TRUE(other.step(2e-3).status.ok());
  EXPECT_EQ(other.state_hash(), a.world.state_hash());
  std::vector<std::uint8_t> damaged = a.fields.save();
  damaged.pop_back();
  EXPECT_FALSE(fields.restore(damaged).ok());
  EXPECT_EQ(fields.size(), 3u);
}

TEST(ForceFields, move_with_a_world_that_is_translated) {
  Blown a, b;
  const Vec3 offset(0.5, -0.25, 0.125);  // exact in binary
  ASSERT_TRUE(b.world.translate(offset).ok());
  a.step(1);
  b.step(1);
  EXPECT_LT((a.world.report().momentum_effects - b.world.report().momentum_effects).norm(), 1e-12);
  const Force moved = b.fields.find(b.vortex_id)->force;
  EXPECT_EQ(std::get<VortexForce>(moved).center, offset);
}

TEST(ForceFields, without_fields_no_state_changes) {
  World plain(weightless(), water()), with(weightless(), water());
  ForceFields fields;
  ASSERT_TRUE(with.add_effect(fields).ok());
  ForceId off;
  ASSERT_TRUE(fields.add(wind(Vec3(5, 0, 0), 1, 1), &off).ok());
  ASSERT_TRUE(fields.set_enabled(off, false).ok());
  for (World* w : {&plain, &with}) {
    add_block(*w, 8, Vec3::Zero(), Vec3(1, 2, 3));
    for (int k = 0; k < 10; ++k) ASSERT_TRUE(w->step(2e-3).status.ok());
  }
  EXPECT_EQ(plain.state_hash(), with.state_hash());
}

/// Water at rest in a tank without a lid, 15 dx wide and 8 dx deep.
TEST(Wind, blows_on_the_surface_of_a_pool_alone) {
  WorldSettings room = weightless();
  room.gravity = Vec3(0, -9.81, 0);
  World w(room, water());
  const double width = 0.15;
  StaticMesh tank;
  tank.add_rectangle(Vec3(0, 0, 0), Vec3(0, 0, width), Vec3(width, 0, 0), 4, 4);
  tank.add_rectangle(Vec3(0, 0, 0), Vec3(width, 0, 0), Vec3(0, width, 0), 4, 4);
  tank.add_rectangle(Vec3(0, 0, width), Vec3(width, 0, 0), Vec3(0, width, 0), 4, 4);
  tank.add_rectangle(Vec3(0, 0, 0), Vec3(0, 0, width), Vec3(0, width, 0), 4, 4);
  tank.add_rectangle(Vec3(width, 0, 0), Vec3(0, 0, width), Vec3(0, width, 0), 4, 4);
  ASSERT_TRUE(w.attach(tank, sheet_settings(), nullptr).ok());
  add_slab(w, Vec3::Constant(0.5 * dx), 15, 8, 15);
  for (int k = 0; k < 100; ++k) ASSERT_TRUE(w.step(5e-3).status.ok());
  ForceFields fields;
  ForceId id;
  ASSERT_TRUE(w.add_effect(fields).ok());
  ASSERT_TRUE(fields.add(WindForce(), &id).ok());
  const double unit = 0.5 * 1.2 * width * width * 100;
  const auto force = [&](const Vec3& velocity, double drag, double friction) {
    EXPECT_TRUE(fields.set(id, wind(velocity, drag, friction)).ok());
    return Vec3(w.step(1e-4).momentum_effects / 1e-4 / unit);
  };
  const Vec3 down = force(Vec3(0, -10, 0), 1, 0), up = force(Vec3(0, 10, 0), 1, 0);
  const Vec3 along = force(Vec3(10, 0, 0), 1, 0), friction = force(Vec3(10, 0, 0), 0, 1);
  record("pool, wind from above", down.norm());
  record("pool, wind from below", up.norm());
  record("pool, wind along", along.norm());
  record("pool, friction", friction.norm());
  EXPECT_NEAR(-down.y(), 1, 0.2);
  EXPECT_NEAR(friction.x(), 1, 0.2);
  EXPECT_LT(up.norm(), 0.05);
  EXPECT_LT(along.norm(), 0.2);
}

/// A ball of a lattice, 18 dx across: its steps lie too deep between their neighbours, and count less.
TEST(Wind, gives_a_ball_the_drag_of_its_section) {
  World w(weightless(), water());
  ForceFields fields;
  ASSERT_TRUE(w.add_effect(fields).ok());
  ASSERT_TRUE(fields.add(wind(Vec3(10, 0, 0), 1, 0)).ok());
  std::vector<Vec3> x;
  for (int i = -9; i <= 9; ++i)
    for (int j = -9; j <= 9; ++j)
      for (int k = -9; k <= 9; ++k)
        if (Vec3(i, j, k).norm() < 9) x.push_back(dx * Vec3(i, j, k));
  ASSERT_TRUE(w.add_particles(x, std::vector<Vec3>(x.size(), Vec3::Zero())).ok());
  const Vec3 expected = 0.5 * 1.2 * 3.14159265 * 0.09 * 0.09 * 10 * Vec3(10, 0, 0);
  const Vec3 found = force_in_step(w);
  record("drag over expected", found.norm() / expected.norm());
  EXPECT_LT((found - expected).norm(), 0.35 * expected.norm());
}

}  // namespace
}  // namespace oilskin::test
