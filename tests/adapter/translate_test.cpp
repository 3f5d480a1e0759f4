// A scene that is moved far away goes on there as it would have here.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>

#include "state_scene.h"

namespace oilskin::bullet {
namespace {

using namespace test;

const btVector3 far(64, -32, 128);  // exact in both precisions

/// The largest difference of what the scenes have, less the offset [m].
double difference(const StateScene& here, const StateScene& there, const btVector3& offset) {
  double most = 0;
  const auto compare = [&](const btVector3& a, const btVector3& b) {
    most = std::max(most, (to_vec3(b) - to_vec3(a) - to_vec3(offset)).cwiseAbs().maxCoeff());
  };
  for (int i = 0; i < here.cloth->m_nodes.size(); ++i)
    compare(here.cloth->m_nodes[i].m_x, there.cloth->m_nodes[i].m_x);
  compare(here.box->getWorldTransform().getOrigin(), there.box->getWorldTransform().getOrigin());
  const World &a = here.water.getWorld(), &b = there.water.getWorld();
  EXPECT_EQ(a.particle_count(), b.particle_count());
  std::map<std::uint64_t, Vec3> place;
  for (std::size_t i = 0; i < a.particle_count(); ++i) place[a.ids()[i]] = a.positions()[i];
  for (std::size_t i = 0; i < b.particle_count(); ++i)
    most = std::max(most, (b.positions()[i] - place[b.ids()[i]] - to_vec3(offset)).cwiseAbs().maxCoeff());
  return most;
}

/// Of the largest coordinate, in the last place.
double rounding() {
  return 130 * std::ldexp(1.0, is_double ? -52 : -23);
}

StateOptions without_rain() {
  StateOptions options;
  options.has_rain = false;  // fewer particles leave the box
  return options;
}

void go_on(StateScene& scene, int steps) {
  for (int i = 0; i < steps; ++i) {
    scene.bullet.step(0.002);
    const StepReport& r = scene.solver.getReport();
    ASSERT_TRUE(r.status.ok()) << r.status.message;
    ASSERT_EQ(r.contact.relocated, 0u);
    ASSERT_EQ(r.flags & (flag_leaked | flag_no_promise | flag_surface_refused | flag_scatter_mismatch |
                         flag_surface_out_of_range),
              0u);
  }
}

TEST(Translate, a_scene_goes_on_as_it_would_have_here) {
  StateScene here(without_rain()), there(without_rain());
  for (StateScene* s : {&here, &there}) {
    EXPECT_TRUE(s->pour(0.01).ok());
    s->play(80, 0.5);
  }
  ASSERT_EQ(here.look(), there.look());
  const double stretched = double(there.cloth->m_links[7].m_rl);
  Status status = there.solver.translate(far);
  ASSERT_TRUE(status.ok()) << status.message;
  EXPECT_LE(difference(here, there, far), rounding());
  EXPECT_EQ(double(there.cloth->m_links[7].m_rl), stretched);
  EXPECT_EQ(to_vec3(there.nozzle.getWorldTransform().getOrigin()),
            to_vec3(here.nozzle.getWorldTransform().getOrigin() + far));
  EXPECT_EQ(there.water.getWorld().settings().kill_box.min,
            Vec3(here.water.getWorld().settings().kill_box.min + to_vec3(far)));
  btVector3 impulse[2], moment;
  for (StateScene* s : {&here, &there})
    ASSERT_TRUE(s->solver.getCoupling().takeImpulse(s->box.get(), impulse[0], moment));
  go_on(here, 1);
  go_on(there, 1);
  // Rounding changes what the solvers do by as much as velocities that differ by 1e-8 m/s.
  EXPECT_LE(difference(here, there, far), 1e-4);
  go_on(here, 9);
  go_on(there, 9);
  EXPECT_LE(difference(here, there, far), 2e-3);
  ASSERT_TRUE(here.solver.getCoupling().takeImpulse(here.box.get(), impulse[0], moment));
  ASSERT_TRUE(there.solver.getCoupling().takeImpulse(there.box.get(), impulse[1], moment));
  EXPECT_LE((impulse[0] - impulse[1]).length(), bt(0.1) * impulse[0].length());
  EXPECT_NEAR(there.solver.getReport().energy.made, here.solver.getReport().energy.made, 1e-3);
}

TEST(Translate, there_and_back_water_at_rest_stays_at_rest) {
  StateScene scene(without_rain());
  EXPECT_TRUE(scene.pour(0.005).ok());
  EXPECT_TRUE(scene.nozzle.setEnabled(false).ok());
  scene.solver.removeRigidBody(scene.box.get());
  go_on(scene, 350);
  const auto speed = [&] { return scene.solver.getReport().energy.rms_speed; };
  const double before = speed();
  const std::size_t particles = scene.water.getWorld().particle_count();
  for (const btVector3& offset : {far, btVector3(-far), btVector3(bt(0.3), 0, bt(1e-3))}) {
    ASSERT_TRUE(scene.solver.translate(offset).ok());
    double most = 0;
    for (int i = 0; i < 15; ++i) {
      go_on(scene, 1);
      most = std::max(most, speed());
    }
    EXPECT_LT(most, before + 0.02);
  }
  EXPECT_EQ(scene.water.getWorld().particle_count(), particles);
}

TEST(Translate, refuses_and_changes_nothing) {
  StateScene scene(without_rain());
  scene.play(20, 0);
  const Bytes before = scene.save();
  const btScalar nan = std::numeric_limits<btScalar>::quiet_NaN();
  const auto refusal = [&](const btVector3& offset) {
    const Status status = scene.solver.translate(offset);
    EXPECT_FALSE(status.ok());
    EXPECT_TRUE(scene.save() == before);
    return status.message;
  };
  EXPECT_TRUE(has(refusal({0, nan, 0}), "must be finite"));
  EXPECT_TRUE(has(refusal({std::numeric_limits<btScalar>::infinity(), 0, 0}), "must be finite"));
  EXPECT_TRUE(has(refusal({bt(1e16), 0, 0}), "beyond the range of numbers"));
  EXPECT_TRUE(has(refusal({0, bt(is_double ? 1e12 : 4096), 0}), "below 4 δ"));
  EXPECT_TRUE(scene.solver.translate({0, 0, 0}).ok());
  EXPECT_TRUE(scene.save() == before);
}

}  // namespace
}  // namespace oilskin::bullet
