// A trace of the world, float and double hosts, walls and cloth and emitter together, judged by the outside
// auditor.
#include <gtest/gtest.h>

#include <sstream>

#include "audit/trace_auditor.h"
#include "support/cloth_over_floor.h"
#include "support/random.h"

namespace oilskin {
namespace {

template <class Scalar>
std::string record_scene(bool promise, audit::Limits* limits) {
  ContactSettings contact;
  contact.ccd = contact.zones = promise;
  WorldSettings settings;
  settings.kill_box = {Vec3(-0.5, -0.12, -0.5), Vec3::Constant(0.5)};
  settings.threads = 2;
  FluidSettings fluid;
  fluid.max_substeps = 1;  // a record for each step
  World w(settings, fluid, contact);
  test::ClothOverFloor<Scalar> sheets;
  sheets.pin_two_borders();
  sheets.attach_to(w);
  DiscEmitter jet;
  jet.center = Vec3(0.003, 0.05, -0.002);
  jet.radius = 0.012;
  jet.speed = 4;
  jet.direction = Vec3(0.3, -1, 0.1);
  EXPECT_TRUE(w.add_emitter(jet).ok());
  test::add_block(w, 3, Vec3(0.05, 0.15, 0.05), Vec3(0, -80, 0));
  std::ostringstream out;
  TraceWriter trace(out);
  w.set_observer(&trace);
  test::Random random(4);
  for (int k = 0; k < 120; ++k) {
    if (k == 60)
      for (std::size_t i = 0; i < 17; ++i)
        sheets.cloth.x[i] += Eigen::Matrix<Scalar, 3, 1>(0, Scalar(0.01), 0);
    EXPECT_TRUE(w.step(random.uniform(2e-4, 1.5e-3)).status.ok());
  }
  *limits = sheets.limits(w);
  return out.str();
}

template <class Scalar>
audit::Summary audited(bool promise) {
  audit::Limits limits;
  std::istringstream in(record_scene<Scalar>(promise, &limits));
  audit::Summary summary;
  std::string error;
  EXPECT_TRUE(audit::audit_stream(in, limits, &summary, &error)) << error;
  EXPECT_EQ(summary.records, 120u);
  return summary;
}

TEST(AuditedTrace, passes_for_a_float_host) {
  const audit::Summary s = audited<float>(true);
  EXPECT_EQ(s.findings(), 0u) << s;
  EXPECT_GT(s.pairs, 10000u);
}

TEST(AuditedTrace, passes_for_a_double_host) {
  const audit::Summary s = audited<double>(true);
  EXPECT_EQ(s.findings(), 0u) << s;
}

TEST(AuditedTrace, finds_the_crossings_that_repulsion_alone_lets_happen) {
  const audit::Summary s = audited<float>(false);
  EXPECT_GT(s.crossings, 0u);
  EXPECT_EQ(s.jumps, 0u);
}

}  // namespace
}  // namespace oilskin
