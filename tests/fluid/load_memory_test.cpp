// What nodes remember of loads: how much of a load its host is expected to carry.
#include "fluid/boundary/load_memory.h"

#include <gtest/gtest.h>

#include "support/surface_of.h"

namespace oilskin::fluid {
namespace {

constexpr double dt = 1e-3, mass = 2e-3;
const Vec3 load(0, -0.5, 0.1);  // [N]

struct Sheet {
  SurfaceMotion motion;
  LoadMemory memory;
  Vec3 applied = load;  ///< of all fluids [N]

  Sheet() {
    test::StaticMesh mesh;
    mesh.add_rectangle(Vec3::Zero(), Vec3(1, 0, 0), Vec3(0, 0, 1));
    motion = test::surface_of(mesh, 1 / mass);
    memory.prepare(surfaces());
  }
  std::vector<SurfaceMotion*> surfaces() { return {&motion}; }

  /// One step in which the nodes get the load, and the host carries a part of it in the next.
  void step(double carried, const Vec3& gravity, Span<const std::vector<Vec3>> of_others = {}) {
    memory.record_host_response(dt, gravity, surfaces());
    for (std::size_t i = 0; i < motion.velocity.size(); ++i) {
      motion.impulse[i] = dt * applied;
      motion.velocity[i] += motion.impulse[i] / mass;
    }
    memory.record_load(dt, surfaces(), of_others);
    for (Vec3& v : motion.velocity) v += dt * (gravity - carried * applied / mass);
  }
};

TEST(LoadMemory, learns_the_part_of_a_load_that_the_host_carries) {
  const Vec3 gravity(0, -9.81, 0);
  for (const double carried : {0.0, 0.3, 1.0}) {
    Sheet sheet;
    EXPECT_TRUE(sheet.memory.carried_impulse(1, 0, dt).isZero(0));
    for (int k = 0; k < 2000; ++k) sheet.step(carried, gravity);
    for (std::uint32_t i = 0; i < 4; ++i)
      EXPECT_LT((sheet.memory.carried_impulse(1, i, dt) - carried * dt * load).norm(), 1e-6 * dt) << carried;
  }
}

TEST(LoadMemory, a_host_that_adds_to_the_load_carries_nothing) {
  Sheet sheet;
  for (int k = 0; k < 1000; ++k) sheet.step(-0.5, Vec3::Zero());
  EXPECT_TRUE(sheet.memory.carried_impulse(1, 0, dt).isZero(0));
}

/// Another fluid gives a part of the load: of what the host carries, it has its share.
TEST(LoadMemory, what_the_host_carries_for_another_fluid_is_not_carried_for_this_one) {
  for (const double carried : {0.0, 0.4, 1.0}) {
    Sheet sheet;
    const std::vector<std::vector<Vec3>> of_others = {std::vector<Vec3>(4, 0.6 * dt * load)};
    for (int k = 0; k < 2000; ++k) sheet.step(carried, Vec3::Zero(), of_others);
    EXPECT_LT((sheet.memory.carried_impulse(1, 0, dt) - (carried - 0.6) * dt * load).norm(), 1e-6 * dt)
        << carried;
  }
}

TEST(LoadMemory, opposite_fluids_on_a_free_sheet_carry_each_other) {
  Sheet sheet;
  const Vec3 own = 0.7 * load;
  const std::vector<std::vector<Vec3>> of_others = {std::vector<Vec3>(4, -dt * own)};
  sheet.applied.setZero();  // together
  for (int k = 0; k < 2000; ++k) sheet.step(0, Vec3::Zero(), of_others);
  EXPECT_LT((sheet.memory.carried_impulse(1, 2, dt) - dt * own).norm(), 1e-6 * dt);
}

TEST(LoadMemory, forgets_surfaces_that_are_absent) {
  Sheet sheet;
  for (int k = 0; k < 100; ++k) sheet.step(1, Vec3::Zero());
  EXPECT_GT(sheet.memory.carried_impulse(1, 0, dt).norm(), 0.5 * dt * load.norm());
  sheet.memory.record_host_response(dt, Vec3::Zero(), {});
  sheet.memory.prepare(sheet.surfaces());
  EXPECT_TRUE(sheet.memory.carried_impulse(1, 0, dt).isZero(0));
}

/// A body of 2 kg, its response to each load that of a floor, a rope, or nothing.
struct Body {
  SurfaceMotion motion;
  LoadMemory memory;
  static constexpr double body_mass = 2;
  const Vec3 gravity = Vec3(0, -9.81, 0), weight = body_mass * gravity;

  Body() {
    test::StaticMesh mesh;
    mesh.add_rectangle(Vec3::Zero(), Vec3(1, 0, 0), Vec3(0, 0, 1));
    motion = test::surface_of(mesh, 1 / body_mass);
    BodyMotion& body = motion.body.emplace();
    body.inverse_mass = Vec3::Constant(1 / body_mass);
    body.inverse_inertia = Eigen::Matrix3d::Identity();
    body.gravity = gravity;
    body.velocity = Vec3(3, 4, 5);  // not a response
    memory.prepare(surfaces());
  }
  std::vector<SurfaceMotion*> surfaces() { return {&motion}; }
  void step(const Vec3& force, const Vec3& response) {
    memory.record_host_response(dt, gravity, surfaces());
    BodyMotion& body = *motion.body;
    body.impulse = dt * force;
    body.velocity += body.impulse / body_mass;
    memory.record_load(dt, surfaces());
    body.velocity += dt * (gravity + response / body_mass);
  }
  /// What (B.39) takes the host to do to the body: gravity, less what is carried [N].
  Vec3 expected() const { return weight - memory.carried_of_body(motion, 3 * dt, dt).impulse / (3 * dt); }
};

TEST(LoadMemory, what_holds_a_body_holds_its_weight) {
  const Vec3 up(0, 5, 0), press(0, -40, 0), aside(3, -1, 0);
  for (const Vec3& force : {up, press, aside}) {
    Body held;
    for (int k = 0; k < 2; ++k) held.step(force, -force - held.weight);
    EXPECT_LT((held.expected() + force).norm(), 1e-9) << "after two steps: " << force.transpose();
    for (int k = 0; k < 1000; ++k) held.step(force, -force - held.weight);
    EXPECT_LT((held.expected() + force).norm(), 1e-9) << force.transpose();
  }
  Body afloat, sliding;
  for (int k = 0; k < 1000; ++k) {
    afloat.step(-afloat.weight, Vec3::Zero());
    sliding.step(Vec3(7, -2, 0), -sliding.weight + Vec3(0, 2, 0));
  }
  EXPECT_LT((afloat.expected() - afloat.weight).norm(), 1e-9);
  EXPECT_LT((sliding.expected() - Vec3(0, 2, 0)).norm(), 1e-9) << "nothing holds it across";
}

TEST(LoadMemory, hosts_that_let_nothing_move_are_firm) {
  Body stands, floats, swings;
  for (int k = 0; k < 1000; ++k) {
    const Vec3 changes(0, -20 + 10 * (k % 3), 0);
    stands.step(changes, -changes - stands.weight);
    floats.step(changes, Vec3::Zero());
    swings.step(changes, -Vec3(0, -10, 0) - swings.weight);  // the mean alone
  }
  EXPECT_NEAR(stands.memory.carried_of_body(stands.motion, dt, dt).firmness, 1, 1e-9);
  EXPECT_EQ(floats.memory.carried_of_body(floats.motion, dt, dt).firmness, 0);
  EXPECT_EQ(swings.memory.carried_of_body(swings.motion, dt, dt).firmness, 0);
}

TEST(LoadMemory, a_host_carries_no_more_than_load_and_weight) {
  Body thrown, pulled;
  for (int k = 0; k < 1000; ++k) {
    thrown.step(Vec3(0, -5, 0), Vec3(0, 400, 0));
    pulled.step(Vec3(0, -5, 0), Vec3(0, -400, 0));
  }
  EXPECT_LT((thrown.expected() - Vec3(0, 5, 0)).norm(), 1e-9);
  EXPECT_LT((pulled.expected() - pulled.weight).norm(), 1e-9);
}

}  // namespace
}  // namespace oilskin::fluid
