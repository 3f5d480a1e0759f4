// Implicit viscosity between two sheets, against the series (F.51) and (F.52).
#include <gtest/gtest.h>

#include <cmath>

#include "support/channel_flow.h"
#include "support/record.h"

namespace oilskin {
namespace {

using test::Channel;
using test::ChannelFlow;

struct Case {
  const char* name;
  BoundaryModel boundary;
  double viscosity;
  double until;  // ν t/D²
  double support_ratio = 2;
};
void PrintTo(const Case& c, std::ostream* out) {
  *out << c.name;
}
std::string name_of(const ::testing::TestParamInfo<Case>& info) {
  return info.param.name;
}

Channel channel(const Case& c) {
  Channel channel;
  channel.boundary = c.boundary;
  channel.solver = c.boundary == BoundaryModel::mirrored ? PressureSolver::dfsph : PressureSolver::pcisph;
  channel.viscosity = c.viscosity;
  channel.support_ratio = c.support_ratio;
  channel.dt = 1e-3;
  channel.implicit = true;
  return channel;
}

class ImplicitPoiseuille : public ::testing::TestWithParam<Case> {};
class ImplicitCouette : public ::testing::TestWithParam<Case> {};

// The tolerances of the explicit term in tests/world/channel_flow_test.cpp.
TEST_P(ImplicitPoiseuille, has_the_profile_and_the_wall_force) {
  const Case& c = GetParam();
  ChannelFlow flow(channel(c));
  flow.run_to(c.until);
  const bool settles = c.boundary == BoundaryModel::mirrored;
  const double stress = flow.wall_stress(0) + flow.wall_stress(1);
  test::record("largest deviation over peak", flow.max_deviation() / flow.peak());
  test::record("wall force over balance", stress / flow.stress_by_balance());
  test::record("iterations of the last step", flow.effect().report().iterations);
  EXPECT_TRUE(flow.effect().report().converged);
  EXPECT_NEAR(stress, flow.stress_by_balance(), (settles ? 0.05 : 0.02) * stress);
  EXPECT_NEAR(flow.wall_stress(0), flow.wall_stress(1), (settles ? 2e-2 : 1e-3) * stress);
  EXPECT_LT(flow.max_deviation(), (settles ? 0.06 : 0.05) * flow.peak());
}

TEST_P(ImplicitCouette, has_the_profile_and_the_wall_force) {
  const Case& c = GetParam();
  Channel couette = channel(c);
  couette.across = 8;
  couette.poiseuille = 0;
  couette.couette = 0.01;
  ChannelFlow flow(couette);
  flow.run_to(c.until);
  const double stress = flow.density * flow.viscosity * flow.moving_wall() / flow.width;
  test::record("largest deviation over V", flow.max_deviation() / flow.moving_wall());
  test::record("force of the sheet at rest, of the exact", flow.wall_stress(0) / stress);
  test::record("force of the moving sheet, of the exact", -flow.wall_stress(1) / stress);
  EXPECT_TRUE(flow.effect().report().converged);
  EXPECT_LT(flow.max_deviation(), 0.03 * flow.moving_wall());
  EXPECT_NEAR(flow.wall_stress(0), stress, 0.06 * stress);
  EXPECT_NEAR(flow.wall_stress(1), -stress, 0.06 * stress);
}

const Case contact_0p01{"contact_0p01", BoundaryModel::contact_only, 0.01, 0.5};
const Case contact_0p1{"contact_0p1", BoundaryModel::contact_only, 0.1, 0.6};
const Case contact_1{"contact_1", BoundaryModel::contact_only, 1, 1.2};
const Case mirrored_0p01{"mirrored_0p01", BoundaryModel::mirrored, 0.01, 0.5};
const Case mirrored_0p1{"mirrored_0p1", BoundaryModel::mirrored, 0.1, 0.6};
const Case mirrored_1{"mirrored_1", BoundaryModel::mirrored, 1, 1.2};
const Case contact_thin{"contact_thin", BoundaryModel::contact_only, 1e-3, 0.2};
const Case contact_wide{"contact_wide", BoundaryModel::contact_only, 0.1, 0.6, 2.5};
const Case mirrored_wide{"mirrored_wide", BoundaryModel::mirrored, 0.1, 0.6, 2.5};

INSTANTIATE_TEST_SUITE_P(Cases, ImplicitPoiseuille, ::testing::Values(contact_1, mirrored_0p1, mirrored_1),
                         name_of);
INSTANTIATE_TEST_SUITE_P(Cases, ImplicitCouette, ::testing::Values(contact_0p1, mirrored_1), name_of);
// At H = 1.6 dx (F.10) is not isotropic on a lattice.
INSTANTIATE_TEST_SUITE_P(Long, ImplicitPoiseuille,
                         ::testing::Values(contact_0p01, contact_0p1, mirrored_0p01, contact_thin,
                                           contact_wide, mirrored_wide),
                         name_of);
INSTANTIATE_TEST_SUITE_P(Long, ImplicitCouette,
                         ::testing::Values(contact_0p01, contact_1, mirrored_0p01, mirrored_0p1,
                                           mirrored_wide),
                         name_of);

}  // namespace
}  // namespace oilskin
