// Boxes of water at walls and in water: what would start compressed is left out, and nothing bursts.
#include <gtest/gtest.h>

#include "support/mock_cloth.h"
#include "support/random.h"
#include "support/record.h"
#include "support/static_mesh.h"
#include "support/world_helpers.h"

namespace oilskin::test {
namespace {

constexpr double dx = 0.006;

WorldSettings small_world(const Vec3& gravity) {
  WorldSettings s;
  s.gravity = gravity;
  s.kill_box = {Vec3::Constant(-1), Vec3::Constant(1)};
  s.threads = 1;
  return s;
}

FluidSettings fluid_of(BoundaryModel boundary) {
  FluidSettings s;
  s.spacing = dx;
  s.boundary = boundary;
  return s;
}

BoxEmitter box_of(const Vec3& min, const Vec3& max) {
  BoxEmitter e;
  e.box = {min, max};
  return e;
}

/// A tank of 20 × 16 × 20 spacings without a lid, and a smaller box in it, turned at random.
struct TankWithBody {
  explicit TankWithBody(BoundaryModel boundary, std::uint64_t seed)
      : world(small_world(Vec3(0, -9.81, 0)), fluid_of(boundary)) {
    const Vec3 x = 20 * dx * Vec3::UnitX(), y = 30 * dx * Vec3::UnitY(), z = 20 * dx * Vec3::UnitZ();
    const Vec3 corner = -0.5 * (x + z);
    tank.add_rectangle(corner, z, x);
    for (const Vec3& at : {corner, Vec3(corner + z)}) tank.add_rectangle(at, x, y);
    for (const Vec3& at : {corner, Vec3(corner + x)}) tank.add_rectangle(at, z, y);
    Random random(seed);
    body.add_box({Vec3::Constant(-4.3 * dx), Vec3::Constant(4.3 * dx)}, 2 * dx);
    const Rotation turn(Eigen::AngleAxis<double>(random.uniform(0, 3), random.direction()));
    middle = Vec3(0, 8 * dx, 0) + random.in_cube(dx);
    for (Vec3& n : body.nodes) n = middle + turn * n;
    for (Triangle& t : body.triangles) {
      const Vec3 &a = body.nodes[t[0]], &b = body.nodes[t[1]], &c = body.nodes[t[2]];
      if ((b - a).cross(c - a).dot(a - middle) < 0) std::swap(t[1], t[2]);  // normals outwards
    }
    EXPECT_TRUE(world.attach(tank, sheet_settings(), nullptr).ok());
  }

  Vec3 middle;  // of the body
  StaticMesh tank, body;
  World world;
};

const BoxEmitter whole_tank = box_of(dx * Vec3(-10, 0, -10), dx* Vec3(10, 16, 10));

TEST(FreeStarts, a_box_with_the_faces_of_a_tank_loses_nothing) {
  TankWithBody t(BoundaryModel::mirrored, 1);
  ASSERT_TRUE(t.world.add_emitter(whole_tank).ok());
  EXPECT_EQ(t.world.step(0.001).blocked_starts, 0u);
  EXPECT_EQ(t.world.particle_count(), 20u * 16 * 20);
}

TEST(FreeStarts, a_tank_filled_around_a_turned_body_makes_no_energy) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    TankWithBody t(BoundaryModel::mirrored, seed);
    ASSERT_TRUE(t.world.attach(t.body, sheet_settings(), nullptr).ok());
    ASSERT_TRUE(t.world.add_emitter(whole_tank).ok());
    const std::uint64_t blocked = t.world.step(0.001).blocked_starts;
    EXPECT_GT(blocked, 0u);
    // A fifth of a spacing on both sides of the body.
    const double layer = 6 * 8.6 * 8.6;
    EXPECT_NEAR(static_cast<double>(blocked), 0.4 * layer, 0.2 * layer);
    double made = 0;
    for (int k = 0; k < 30; ++k) made = std::max(made, t.world.step(0.001).energy.made_fraction());
    EXPECT_LE(made, 0.01) << seed;
    record("energy_made", made);
  }
}

/// What encloses no water: a body that the host, or the caller, calls a solid.
TEST(FreeStarts, no_water_starts_in_a_solid) {
  for (const BoundaryModel boundary : {BoundaryModel::mirrored, BoundaryModel::contact_only})
    for (const bool by_host : {true, false}) {
      TankWithBody t(boundary, 1);
      t.body.solid = by_host;
      SurfaceSettings settings = sheet_settings();
      if (!by_host) settings.solid = true;
      ASSERT_TRUE(t.world.attach(t.body, settings, nullptr).ok());
      ASSERT_TRUE(t.world.add_emitter(whole_tank).ok());
      const double inside = 8.6 * 8.6 * 8.6, layer = 6 * 8.6 * 8.6;
      const bool is_crowded = boundary == BoundaryModel::mirrored;
      EXPECT_NEAR(static_cast<double>(t.world.step(0.001).blocked_starts),
                  inside + (is_crowded ? 0.2 * layer : 0), 0.1 * layer);
      std::uint64_t blocked = 0;
      const Vec3 still = Vec3::Zero();
      ASSERT_TRUE(t.world.add_particles({&t.middle, 1}, {&still, 1}, &blocked).ok());
      EXPECT_EQ(blocked, 1u);
    }
}

/// A solid that appears in water takes its volume; a shell keeps what is inside.
TEST(FreeStarts, a_solid_takes_the_place_of_water) {
  for (const bool solid : {true, false}) {
    TankWithBody t(BoundaryModel::mirrored, 2);
    t.body.solid = true;
    SurfaceSettings settings = sheet_settings();
    if (!solid) settings.solid = false;
    ASSERT_TRUE(t.world.add_emitter(whole_tank).ok());
    t.world.step(0.001);
    const std::size_t before = t.world.particle_count();
    SurfaceId id;
    ASSERT_TRUE(t.world.attach(t.body, settings, &id).ok());
    const StepReport& report = t.world.step(0.001);
    const double removed = static_cast<double>(before - t.world.particle_count());
    EXPECT_EQ(report.removed, before - t.world.particle_count());
    EXPECT_NEAR(removed, solid ? 8.6 * 8.6 * 8.6 : 0, solid ? 50 : 5);
    EXPECT_LE(report.momentum_residual().norm(), 1e-12 * t.world.fluid_mass());
    t.world.reset_motion(id);
    EXPECT_LE(t.world.step(0.001).removed, 5u) << "nothing is left inside";
  }
}

/// Cloth that hangs across a box is pressed from both sides; cloth below it is not.
TEST(FreeStarts, cloth_across_a_box_takes_its_place_and_cloth_below_it_does_not) {
  for (const double height : {2.13, -0.13}) {
    World w(small_world(Vec3(0, -9.81, 0)), fluid_of(BoundaryModel::mirrored));
    MockCloth<double> cloth(
        {13, 13, dx * Vec3(-6, height, -6), 12 * dx * Vec3::UnitZ(), 12 * dx * Vec3::UnitX(), 0.2});
    ASSERT_TRUE(w.attach(cloth, sheet_settings(), nullptr).ok());
    ASSERT_TRUE(w.add_emitter(box_of(dx * Vec3(-5, -0.5, -5), dx * Vec3(5, 5.5, 5))).ok());
    EXPECT_EQ(w.step(0.001).blocked_starts, height > 0 ? 100u : 0u);
  }
}

TEST(FreeStarts, contact_alone_takes_all_that_is_free) {
  TankWithBody t(BoundaryModel::contact_only, 1);
  ASSERT_TRUE(t.world.attach(t.body, sheet_settings(), nullptr).ok());
  ASSERT_TRUE(t.world.add_emitter(whole_tank).ok());
  EXPECT_LE(t.world.step(0.001).blocked_starts, 3u) << "closer than 2 δ";
}

/// Two boxes of 10³ spacings that overlap by half, the second one shifted by a part of a spacing.
class Overlap : public ::testing::TestWithParam<double> {};

TEST_P(Overlap, fills_what_is_empty_and_bursts_nothing) {
  const Vec3 shift = dx * (Vec3(5, 0, 0) + GetParam() * Vec3(1, 1, 1));
  const BoxEmitter first = box_of(Vec3::Zero(), Vec3::Constant(10 * dx)),
                   second = box_of(shift, shift + Vec3::Constant(10 * dx));
  for (const bool at_once : {true, false}) {
    World w(small_world(Vec3::Zero()), fluid_of(BoundaryModel::mirrored));
    EmitterId id;
    ASSERT_TRUE(w.add_emitter(first).ok());
    if (!at_once) w.step(0.001);
    ASSERT_TRUE(w.add_emitter(second, &id).ok());
    std::uint64_t blocked = w.step(0.001).blocked_starts;
    const std::uint64_t added = w.emitter(id)->particles;
    EXPECT_EQ(added + blocked, 1000u);
    EXPECT_NEAR(static_cast<double>(added), 500, 150) << "without a layer at most on each side that overlaps";
    for (int k = 0; k < 20; ++k) w.step(0.001);
    EXPECT_LE(fastest(w), 0.2);
    EXPECT_LE(w.report().fluid.density_error_mean, 0.02);
  }
}

INSTANTIATE_TEST_SUITE_P(Shifts, Overlap, ::testing::Values(0.0, 0.3, 0.5));

TEST(FreeStarts, a_nozzle_starts_in_water) {
  World w(small_world(Vec3::Zero()), fluid_of(BoundaryModel::mirrored));
  ASSERT_TRUE(w.add_emitter(box_of(Vec3::Constant(-5 * dx), Vec3::Constant(5 * dx))).ok());
  w.step(0.001);
  DiscEmitter nozzle;
  nozzle.radius = 2 * dx;
  ASSERT_TRUE(w.add_emitter(nozzle).ok());
  for (int k = 0; k < 10; ++k) EXPECT_EQ(w.step(0.001).blocked_starts, 0u);
  EXPECT_GT(w.particle_count(), 1000u);
}

}  // namespace
}  // namespace oilskin::test
