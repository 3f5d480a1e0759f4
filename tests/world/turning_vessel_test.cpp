// Vessels that their host turns: what is reported of loads and work, and that no water is lost.
#include <gtest/gtest.h>

#include <cmath>

#include "support/mock_body.h"
#include "support/record.h"
#include "support/static_mesh.h"
#include "support/world_helpers.h"

namespace oilskin::test {
namespace {

/// Turns about an axis through the origin at a constant rate, and is shaken along x.
class TurningMesh : public StaticMesh {
 public:
  Vec3 axis = Vec3::UnitZ();
  double rate = 0;                   ///< [rad/s]
  double shake = 0, frequency = 20;  ///< [m/s], [rad/s]

  TurningMesh() { changes = Changes::unknown; }
  Gathered gather(double dt, SurfaceMotion& m) override {
    if (upright_.empty()) upright_ = nodes;
    time_ += dt;
    const Eigen::AngleAxisd turn(rate * time_, axis);
    const Vec3 shift(shake / frequency * std::sin(frequency * time_), 0, 0);
    for (std::size_t i = 0; i < nodes.size(); ++i) nodes[i] = turn * upright_[i] + shift;
    const std::vector<Vec3> before = m.x_t0;
    Gathered gathered = StaticMesh::gather(dt, m);
    if (dt > 0 && before.size() == nodes.size())
      for (std::size_t i = 0; i < nodes.size(); ++i) m.velocity[i] = (nodes[i] - before[i]) / dt;
    return gathered;
  }

 private:
  std::vector<Vec3> upright_;
  double time_ = 0;
};

WorldSettings weightless() {
  WorldSettings s;
  s.gravity.setZero();
  s.kill_box = {Vec3::Constant(-2), Vec3::Constant(2)};
  return s;
}

/// About the z axis through the origin.
double spin_of(const World& w) {
  double sum = 0;
  for (std::size_t i = 0; i < w.particle_count(); ++i)
    sum += w.particle_mass() * w.positions()[i].cross(w.velocities()[i]).z();
  return sum;
}

class TurningBox : public ::testing::TestWithParam<double> {};

/// Water that turns with a full box has a constant angular momentum: nothing brakes the box, and it does no
/// work.
TEST_P(TurningBox, takes_no_moment_and_does_no_work_on_water_that_turns_with_it) {
  const double dt = GetParam(), rate = 18.85, dx = 0.02;
  World w(weightless(), of_spacing(dx));
  TurningMesh vessel;
  vessel.rate = rate;
  vessel.add_box({Vec3(-0.1, -0.1, -0.06), Vec3(0.1, 0.1, 0.06)}, 1);
  SurfaceId id;
  ASSERT_TRUE(w.attach(vessel, sheet_settings(dx / 5), &id).ok());
  std::vector<Vec3> x, v;
  for (int i = 0; i < 10; ++i)
    for (int j = 0; j < 10; ++j)
      for (int k = 0; k < 6; ++k) {
        x.push_back(dx * Vec3(i - 4.5, j - 4.5, k - 2.5));
        v.push_back(Vec3(0, 0, rate).cross(x.back()));
      }
  std::uint64_t blocked = 0;
  ASSERT_TRUE(w.add_particles(x, v, &blocked).ok());
  ASSERT_EQ(blocked, 0u);
  const int settling = static_cast<int>(0.2 / dt), measured = static_cast<int>(0.5 / dt);
  for (int k = 0; k < settling; ++k) w.step(dt);
  const double before = spin_of(w), work_before = w.report().energy.work_prescribed,
               made_before = w.report().energy.made;
  double moment = 0;
  for (int k = 0; k < measured; ++k) {
    w.step(dt);
    moment += load_of(*w.surface(id)).angular_impulse.z();
  }
  EXPECT_EQ(w.particle_count(), x.size());
  const EnergyReport& energy = w.report().energy;
  const double change = (spin_of(w) - before) / before, reported = -moment / before,
               work = (energy.work_prescribed - work_before) / energy.water_kinetic,
               made = (energy.made - made_before) / energy.water_kinetic;
  record("change", change);
  record("moment", reported);
  record("work", work);
  record("made", made);
  EXPECT_LT(std::abs(change), 0.02);
  EXPECT_NEAR(reported, change, 0.05) << "the water keeps its spin, so nothing takes it";
  EXPECT_LT(std::abs(work), 0.1);
  EXPECT_LT(std::abs(made), 0.15);
}

INSTANTIATE_TEST_SUITE_P(Steps, TurningBox, ::testing::Values(1.0 / 60, 1.0 / 240));

TEST(TurningBody, the_moment_of_the_load_is_what_the_body_gains) {
  WorldSettings settings = weightless();
  FluidSettings fluid = of_spacing(0.02);
  World w(settings, fluid);
  MockBody body;
  body.mass = 5;
  body.half = Vec3(0.08, 0.03, 0.05);
  body.free_axes = Vec3::Zero();  // an axle
  body.spin = Vec3(0, 0, 15);
  SurfaceId id;
  ASSERT_TRUE(w.attach(body, sheet_settings(0.004), &id).ok());
  add_block(w, 6, Vec3(-0.05, 0.11, -0.05), Vec3(0, -3, 0));
  double largest = 0;
  for (int k = 0; k < 20; ++k) {
    const double before = body.angular_momentum().z();
    const StepReport& r = w.step(1.0 / 60);
    ASSERT_GE(r.substeps, 2);
    const double gained = body.angular_momentum().z() - before;
    largest = std::max(largest, std::abs(gained));
    EXPECT_NEAR(load_of(*w.surface(id)).angular_impulse.z(), gained, 1e-9 + 1e-2 * std::abs(gained));
  }
  EXPECT_GT(largest, 1e-3) << "the water hits the body";
}

/// A wedge with an edge of 19°, turned and shaken: what is squeezed into the edge goes along with it.
TEST(TurningWedge, keeps_what_is_squeezed_into_its_edge) {
  const double dx = 0.02, half_width = 0.05, height = 0.3, length = 0.2;
  World w(under_gravity(), of_spacing(dx));
  TurningMesh wedge;
  wedge.axis = Vec3(0.3, 0.4, 0.866).normalized();
  wedge.rate = 18.85;
  wedge.shake = 3;
  const double l = length, h = height, b = half_width;
  wedge.nodes = {{0, 0, -l}, {0, 0, l}, {-b, h, -l}, {-b, h, l}, {b, h, -l}, {b, h, l}};
  wedge.triangles = {{0, 1, 3}, {0, 3, 2}, {1, 0, 4}, {1, 4, 5}, {2, 3, 5}, {2, 5, 4}, {0, 2, 4}, {1, 5, 3}};
  ASSERT_TRUE(w.attach(wedge, sheet_settings(dx / 5), nullptr).ok());
  std::vector<Vec3> x;
  for (double y = 0.06; y < 0.2; y += dx)
    for (double z = -l + dx; z < l - dx / 2; z += dx)
      for (double at = -b; at < b; at += dx)
        if (std::abs(at) < b * y / h - 0.012) x.emplace_back(at, y, z);
  ASSERT_TRUE(w.add_particles(x, std::vector<Vec3>(x.size(), Vec3::Zero())).ok());
  ASSERT_GT(x.size(), 100u);
  for (int k = 0; k < 120; ++k) w.step(1.0 / 60);
  EXPECT_EQ(w.particle_count(), x.size());
  EXPECT_EQ(w.report().removed, 0u);
}

}  // namespace
}  // namespace oilskin::test
