// The path of a node over the sub-steps of a step.
#include <gtest/gtest.h>

#include "world/substeps.h"

namespace oilskin {
namespace {

using world::SurfacePaths;

/// One node on its way from 0 to (1, 0, 0).
SurfaceMotion one_node(double inverse_mass) {
  SurfaceMotion m;
  m.x_t0 = {Vec3::Zero()};
  m.x_t1 = {Vec3(1, 0, 0)};
  m.velocity = {Vec3(0.25, 0, 0)};
  m.inverse_mass = {inverse_mass};
  return m;
}

/// As contact does: resets the output, moves the node, gives an impulse.
void act(SurfaceMotion& m, const Vec3& end, const Vec3& impulse) {
  m.impulse = {impulse};
  m.velocity[0] += m.inverse_mass[0] * impulse;
  m.moved = {std::uint8_t(end != m.x_t1[0])};
  m.touched.assign(m.moved[0] != 0 || !impulse.isZero(0) ? 1 : 0, 0);
  m.x_t1[0] = end;
}

TEST(SurfacePaths, a_node_continues_from_where_it_is_to_where_the_host_wants_it) {
  SurfaceMotion m = one_node(2);
  SurfaceMotion* const surfaces[] = {&m};
  SurfacePaths paths;
  paths.begin(surfaces, 4, 1);
  paths.next();
  EXPECT_EQ(m.x_t1[0], Vec3(0.25, 0, 0));
  act(m, Vec3(0.25, 0.3, 0), Vec3(0, 1, 0));  // moved aside
  paths.next();
  EXPECT_EQ(m.x_t0[0], Vec3(0.25, 0.3, 0));
  EXPECT_TRUE(m.x_t1[0].isApprox(Vec3(0.5, 0.2, 0), 1e-15));
  EXPECT_EQ(m.velocity[0], Vec3(0.25, 2, 0));
  act(m, m.x_t0[0], Vec3(0, 0, 1));  // held
  paths.next();
  EXPECT_TRUE(m.x_t1[0].isApprox(Vec3(0.625, 0.15, 0), 1e-15));
  act(m, m.x_t1[0], Vec3::Zero());
  paths.next();
  EXPECT_EQ(m.x_t1[0], Vec3(1, 0, 0));
  act(m, m.x_t1[0], Vec3(0, 1, 0));
  paths.end();
  EXPECT_EQ(m.x_t0[0], Vec3::Zero());
  EXPECT_EQ(m.x_t1[0], Vec3(1, 0, 0));
  EXPECT_EQ(m.impulse[0], Vec3(0, 2, 1));
  EXPECT_EQ(m.velocity[0], Vec3(0.25, 4, 2));
  EXPECT_FALSE(m.moved[0]) << "it has arrived: the host need not write anything";
}

TEST(SurfacePaths, a_held_pin_catches_up_and_moved_marks_where_it_did_not) {
  SurfaceMotion m = one_node(0);
  SurfaceMotion* const surfaces[] = {&m};
  SurfacePaths paths;
  paths.begin(surfaces, 4, 1);
  paths.next();
  act(m, m.x_t0[0], Vec3(0, -1, 0));  // held
  paths.next();
  EXPECT_TRUE(m.x_t1[0].isApprox(Vec3(1.0 / 3, 0, 0), 1e-15));
  EXPECT_TRUE(m.velocity[0].isApprox(Vec3(1.0 / 3, 0, 0), 1e-15));
  act(m, m.x_t1[0], Vec3::Zero());
  paths.next();
  act(m, m.x_t1[0], Vec3::Zero());
  paths.next();
  EXPECT_EQ(m.x_t1[0], Vec3(1, 0, 0));
  act(m, m.x_t0[0], Vec3(0, -1, 0));  // held in the last one
  paths.end();
  EXPECT_TRUE(m.moved[0]);
  EXPECT_TRUE(m.x_t1[0].isApprox(Vec3(2.0 / 3, 0, 0), 1e-15));
  EXPECT_EQ(m.velocity[0], Vec3(0.25, 0, 0)) << "the host's";
  EXPECT_EQ(m.impulse[0], Vec3(0, -2, 0));
}

TEST(SurfacePaths, one_part_changes_nothing) {
  SurfaceMotion m = one_node(1);
  SurfaceMotion* const surfaces[] = {&m};
  SurfacePaths paths;
  paths.begin(surfaces, 1, 1);
  paths.next();
  EXPECT_EQ(m.x_t1[0], Vec3(1, 0, 0));
  m.impulse = {Vec3(1, 2, 3)};
  m.moved = {1};
  paths.end();
  EXPECT_EQ(m.impulse[0], Vec3(1, 2, 3));
  EXPECT_TRUE(m.moved[0]);
}

}  // namespace
}  // namespace oilskin
