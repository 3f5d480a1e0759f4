// What happens when prescribed surfaces close on particles, what is counted, and what is refused.
#include <gtest/gtest.h>

#include "support/particle_arrays.h"

namespace oilskin {
namespace {

using test::ParticleArrays;

struct Press {
  SurfaceMotion lower, upper;
  ParticleArrays particles;
  ContactReport report;

  explicit Press(bool holdable) {
    lower = test::make_grid(4, 4, Vec3(0, 0, 0), Vec3(0.03, 0, 0), Vec3(0, 0, 0.03), 0, 0.001, 1,
                            Storage::float64, 1);
    upper = test::make_grid(4, 4, Vec3(0, 0.01, 0), Vec3(0.03, 0, 0), Vec3(0, 0, 0.03), 0, 0.001, 1,
                            Storage::float64, 2);
    for (SurfaceMotion* s : {&lower, &upper}) s->holdable.assign(s->x_t0.size(), holdable ? 1 : 0);
    for (int i = 0; i < 5; ++i) particles.add({0.0051 + 0.004 * i, 0.005, 0.0123}, Vec3::Zero(), 1e-4);
    particles.add({0.5, 0.005, 0}, Vec3::Zero(), 1e-4);  // far away: nothing may happen to it
  }

  // The upper layer goes through the lower one.
  void close(Infeasible policy, double displacement = -0.02) {
    for (std::size_t i = 0; i < upper.x_t0.size(); ++i) {
      upper.x_t1[i] = upper.x_t0[i] + Vec3(0, displacement, 0);
      upper.velocity[i] = Vec3(0, displacement / 1e-3, 0);
    }
    ContactSettings settings;
    settings.infeasible = policy;
    settings.verify = true;
    ParticleMotion motion = particles.motion();
    SurfaceMotion* surfaces[] = {&lower, &upper};
    StageSeconds seconds;
    const Status status = ContactSolver(settings, 1).resolve(1e-3, motion, surfaces, report, seconds);
    ASSERT_TRUE(status.ok()) << status.message;
  }
};

TEST(Policies, pins_that_may_be_held_stall_and_are_counted) {
  Press press(true);
  press.close(Infeasible::stall);
  EXPECT_GT(press.report.stalled, 0u);
  EXPECT_EQ(press.report.removed, 0u);
  EXPECT_EQ(press.report.crossings_found_by_verify, 0u);
  EXPECT_EQ(press.particles.x_t1[5], Vec3(0.5, 0.005, 0));
}

TEST(Policies, surfaces_that_may_not_be_held_cost_the_particles_and_their_momentum_is_booked) {
  Press press(false);
  press.close(Infeasible::stall);
  EXPECT_EQ(press.report.stalled, 0u);
  EXPECT_EQ(press.report.removed, 5u);
  EXPECT_EQ(press.report.crossings_found_by_verify, 0u);
  for (int i = 0; i < 5; ++i) EXPECT_EQ(press.particles.removed[i], 1);
  EXPECT_EQ(press.particles.removed[5], 0);
  Vec3 after = Vec3::Zero();
  for (int i = 0; i < 6; ++i)
    if (!press.particles.removed[i]) after += 1e-4 * press.particles.velocity[i];
  const Vec3 residual = after + press.report.momentum_removed + press.report.impulse_on_prescribed;
  EXPECT_LE(residual.norm(), 1e-12);
}

TEST(Policies, remove_gives_particles_up_even_where_pins_could_be_held) {
  Press press(true);
  press.close(Infeasible::remove);
  EXPECT_EQ(press.report.removed, 5u);
  EXPECT_EQ(press.report.stalled, 0u);
  for (std::size_t i = 0; i < press.upper.x_t1.size(); ++i)
    EXPECT_EQ(press.upper.x_t1[i], Vec3(press.upper.x_t0[i] + Vec3(0, -0.02, 0)))
        << "the surface keeps its way";
}

TEST(Policies, allow_is_counted_as_a_leak_and_verify_sees_it) {
  Press press(false);
  press.close(Infeasible::allow);
  EXPECT_EQ(press.report.removed, 0u);
  EXPECT_EQ(press.report.allowed, 5u);
  EXPECT_EQ(press.report.crossings_found_by_verify, 5u);
}

TEST(Policies, a_gentle_squeeze_costs_nothing) {
  Press press(false);
  press.close(Infeasible::stall, -0.004);
  EXPECT_EQ(press.report.removed, 0u);
  EXPECT_EQ(press.report.stalled, 0u);
  EXPECT_EQ(press.report.crossings_found_by_verify, 0u);
}

TEST(Policies, without_the_continuous_test_a_fast_particle_crosses_and_verify_counts_it) {
  for (bool ccd : {false, true}) {
    SurfaceMotion sheet = test::make_grid(4, 4, Vec3(0, 0, 0), Vec3(0.03, 0, 0), Vec3(0, 0, 0.03), 1e-3,
                                          0.001, 1, Storage::float64);
    ParticleArrays p;
    p.add({0.0123, 0.02, 0.0171}, {0, -100, 0}, 1e-4);
    p.move(1e-3);
    ContactSettings settings;
    settings.ccd = settings.zones = ccd;
    settings.verify = true;
    ParticleMotion motion = p.motion();
    SurfaceMotion* surfaces[] = {&sheet};
    ContactReport report;
    StageSeconds seconds;
    ASSERT_TRUE(ContactSolver(settings, 1).resolve(1e-3, motion, surfaces, report, seconds).ok());
    EXPECT_EQ(report.crossings_found_by_verify, ccd ? 0u : 1u);
    if (ccd) {
      EXPECT_GT(p.x_t1[0].y(), 0.0009);
    }
  }
}

struct Refusal {
  const char* name;
  void (*spoil)(Press&, double& dt, ContactSettings&);
  const char* message;
};

class Refused : public ::testing::TestWithParam<Refusal> {};

TEST_P(Refused, names_the_fault_and_leaves_the_state) {
  Press press(false);
  double dt = 1e-3;
  ContactSettings settings;
  GetParam().spoil(press, dt, settings);
  const std::vector<Vec3> x = press.particles.x_t1;
  ParticleMotion motion = press.particles.motion();
  SurfaceMotion* surfaces[] = {&press.lower, &press.upper};
  StageSeconds seconds;
  const Status status = ContactSolver(settings, 1).resolve(dt, motion, surfaces, press.report, seconds);
  EXPECT_FALSE(status.ok());
  EXPECT_NE(status.message.find(GetParam().message), std::string::npos) << status.message;
}

const double nan = std::numeric_limits<double>::quiet_NaN();
INSTANTIATE_TEST_SUITE_P(
    Input, Refused,
    ::testing::Values(
        Refusal{"dt_zero", [](Press&, double& dt, ContactSettings&) { dt = 0; }, "dt is 0"},
        Refusal{"dt_negative", [](Press&, double& dt, ContactSettings&) { dt = -1; }, "dt is -1"},
        Refusal{"dt_nan", [](Press&, double& dt, ContactSettings&) { dt = nan; }, "must be finite and > 0"},
        Refusal{"particle_nan", [](Press& p, double&, ContactSettings&) { p.particles.x_t1[2].x() = nan; },
                "particle x_t1[2] is not finite"},
        Refusal{"node_inf", [](Press& p, double&, ContactSettings&) { p.upper.x_t1[3].y() = 1 / 0.0; },
                "surface x_t1[3] is not finite"},
        Refusal{"index", [](Press& p, double&, ContactSettings&) { p.lower.triangles[4][1] = 99; },
                "triangle 4 of surface 1 has the node index 99; there are 16 nodes"},
        Refusal{"no_triangles", [](Press& p, double&, ContactSettings&) { p.lower.triangles.clear(); },
                "surface 1 has no triangles"},
        Refusal{"thin", [](Press& p, double&, ContactSettings&) { p.lower.thickness = 3 * p.lower.delta; },
                "thickness ≥ 4 delta"},
        Refusal{"mass", [](Press& p, double&, ContactSettings&) { p.particles.inverse_mass[1] = -1; },
                "inverse_mass[1] is -1"},
        Refusal{"friction_nan",
                [](Press& p, double&, ContactSettings&) {
                  p.upper.slip = {SlipModel::coulomb, nan};
                },
                "slip.friction is nan"},
        Refusal{"slip_length_negative",
                [](Press& p, double&, ContactSettings&) {
                  p.upper.slip_back = SlipSettings{SlipModel::viscous_wall, 1, -1};
                },
                "slip_back.slip_length is -1"},
        Refusal{"sweeps", [](Press&, double&, ContactSettings& s) { s.solver_iterations = 0; },
                "contact.sweeps is 0"}),
    [](const ::testing::TestParamInfo<Refusal>& instance) { return instance.param.name; });

TEST(Policies, nothing_at_all_runs) {
  ContactSolver solver;
  ParticleArrays p;
  ParticleMotion motion = p.motion();
  ContactReport report;
  StageSeconds seconds;
  EXPECT_TRUE(solver.resolve(1e-3, motion, {}, report, seconds).ok());
  SurfaceMotion sheet =
      test::make_grid(2, 2, Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 0, 1), 1, 0.001, 1, Storage::float64);
  SurfaceMotion* surfaces[] = {&sheet};
  EXPECT_TRUE(solver.resolve(1e-3, motion, surfaces, report, seconds).ok());
  p.add({0.5, 0.1, 0.5}, Vec3::Zero(), 1);
  motion = p.motion();
  EXPECT_TRUE(solver.resolve(1e-3, motion, {}, report, seconds).ok());
  EXPECT_EQ(report.contacts, 0u);
}

}  // namespace
}  // namespace oilskin
