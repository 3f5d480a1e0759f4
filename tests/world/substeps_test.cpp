// Steps cut into sub-steps: each is certified on its own, and the host sees one step.
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "audit/trace_auditor.h"
#include "support/cloth_over_floor.h"
#include "world/driven_sheet.h"

namespace oilskin::test {
namespace {

ContactSettings verified() {
  ContactSettings s;
  s.verify = true;
  return s;
}

Vec3 sum(const std::vector<Vec3>& values) {
  Vec3 total = Vec3::Zero();
  for (const Vec3& v : values) total += v;
  return total;
}

struct Jet {
  std::uint64_t hash = 0, emitted = 0, intervals = 0, crossings = 0;
  int maximum = 0, minimum = 1000;  ///< sub-steps of a step
  std::string trace;
  audit::Limits limits;
};

template <class Scalar>
Jet run_jet(const FluidSettings& fluid, int threads, double dt, double duration, bool with_trace) {
  World w(box(0.5, Vec3(0, -9.81, 0), threads), fluid, verified());
  ClothOverFloor<Scalar> sheets;
  for (std::size_t corner : {0u, 16u, 272u, 288u}) sheets.cloth.pin(corner);
  sheets.attach_to(w);
  DiscEmitter nozzle;
  nozzle.center = Vec3(0.003, 0.03, -0.002);
  nozzle.radius = 0.008;
  nozzle.speed = 8;
  nozzle.direction = Vec3(0.3, -1, 0.1);
  EXPECT_TRUE(w.add_emitter(nozzle).ok());
  std::ostringstream out;
  TraceWriter trace(out);
  if (with_trace) w.set_observer(&trace);
  Jet jet;
  for (int k = 0; k < static_cast<int>(duration / dt + 0.5); ++k) {
    sheets.cloth.x[16].x() += Scalar(0.0002);
    const StepReport& r = w.step(dt);
    EXPECT_TRUE(r.status.ok());
    EXPECT_EQ(r.flags & (flag_scatter_mismatch | flag_no_promise), 0u);
    jet.emitted += r.emitted;
    jet.intervals += static_cast<std::uint64_t>(r.substeps);
    jet.crossings += r.contact.crossings_found_by_verify;
    jet.maximum = std::max(jet.maximum, r.substeps);
    jet.minimum = std::min(jet.minimum, r.substeps);
  }
  jet.hash = w.state_hash();
  jet.trace = out.str();
  jet.limits = sheets.limits(w);
  return jet;
}

TEST(Substeps, one_at_most_is_the_step_as_it_was) {
  const Jet a = run_jet<float>(cut_into(1, 0.4), 1, 1e-3, 0.03, false);
  const Jet b = run_jet<float>(cut_into(1, 0.01), 1, 1e-3, 0.03, false);
  EXPECT_EQ(a.hash, b.hash);
  EXPECT_EQ(a.intervals, 30u);
  // Slow enough for one sub-step, the limit does not matter either.
  const Jet c = run_jet<float>(cut_into(100, 1000), 1, 1e-3, 0.03, false);
  EXPECT_EQ(c.maximum, 1);
  EXPECT_EQ(a.hash, c.hash);
}

template <class Scalar>
void expect_certified_intervals() {
  const Jet jet = run_jet<Scalar>(cut_into(12), 2, 2e-3, 0.04, true);
  EXPECT_GT(jet.maximum, 8);
  EXPECT_EQ(jet.crossings, 0u);
  std::istringstream in(jet.trace);
  audit::Summary summary;
  std::string error;
  ASSERT_TRUE(audit::audit_stream(in, jet.limits, &summary, &error)) << error;
  EXPECT_EQ(summary.records, jet.intervals);
  EXPECT_EQ(summary.findings(), 0u) << summary;
  EXPECT_GT(summary.pairs, 3000u);
}

TEST(Substeps, each_is_a_record_of_the_trace_that_the_auditor_accepts_float) {
  expect_certified_intervals<float>();
}
TEST(Substeps, each_is_a_record_of_the_trace_that_the_auditor_accepts_double) {
  expect_certified_intervals<double>();
}

TEST(Substeps, same_bits_on_any_number_of_threads) {
  const Jet one = run_jet<float>(cut_into(12), 1, 2e-3, 0.03, false);
  for (int threads : {2, 3})
    EXPECT_EQ(run_jet<float>(cut_into(12), threads, 2e-3, 0.03, false).hash, one.hash) << threads;
}

TEST(Substeps, emit_as_many_as_the_whole_step) {
  const Jet whole = run_jet<double>(cut_into(1), 1, 2e-3, 0.03, false);
  const Jet cut = run_jet<double>(cut_into(12), 1, 2e-3, 0.03, false);
  EXPECT_GT(cut.maximum, 1);
  EXPECT_EQ(cut.emitted, whole.emitted);
  EXPECT_GT(cut.emitted, 300u);
}

TEST(Substeps, lengths_of_intervals_add_up_to_the_step) {
  class Watch : public IntervalObserver {
   public:
    double length = 0;
    void on_interval(const Interval& i) override { length += i.length; }
  } watch;
  World w(box(1), cut_into(7));
  add_block(w, 3, Vec3::Zero(), Vec3(3, 0, 0));
  w.set_observer(&watch);
  EXPECT_EQ(w.step(3e-3).substeps, 5);
  EXPECT_NEAR(watch.length, 3e-3, 1e-17);
  EXPECT_EQ(w.time(), 3e-3);
  EXPECT_EQ(w.report().time, 3e-3);
  EXPECT_EQ(w.step_count(), 1u);
}

TEST(Substeps, the_ledger_closes_and_impulses_are_those_of_the_whole_step) {
  World w(box(1, Vec3(0, -9.81, 0)), cut_into(8), verified());
  GridShape g;
  g.nu = g.nv = 17;
  g.origin = Vec3(-0.1, 0, -0.1);
  g.u = Vec3(0.2, 0, 0);
  g.v = Vec3(0, 0, 0.2);
  MockCloth<double> cloth(g);
  for (std::size_t i = 0; i < 17; ++i) cloth.pin(i);
  SurfaceId id;
  ASSERT_TRUE(w.attach(cloth, sheet_settings(), &id).ok());
  DiscEmitter nozzle;
  nozzle.center = Vec3(-0.08, 0.03, 0);
  nozzle.speed = 5;
  nozzle.radius = 0.012;
  ASSERT_TRUE(w.add_emitter(nozzle).ok());
  add_block(w, 4, Vec3(0.01, 0.003, -0.013), Vec3(0, -4, 0));
  // Every spring force of the host is internal or holds a pin, so its own part of the momentum is known.
  double given = 0;
  int maximum = 0;
  for (int k = 0; k < 40; ++k) {
    const StepReport& r = w.step(2e-3);
    ASSERT_TRUE(r.status.ok());
    maximum = std::max(maximum, r.substeps);
    const double scale = r.momentum_before.norm() + r.momentum_emitted.norm();
    EXPECT_LE(r.momentum_residual().norm(), 1e-12 * scale) << "step " << k;
    EXPECT_NEAR((r.momentum_after - fluid_momentum(w)).norm(), 0, 1e-13 * scale);
    const SurfaceMotion& s = *w.surface(id);
    const Vec3 booked = r.contact.impulse_on_free_nodes + r.contact.impulse_on_prescribed;
    EXPECT_LE((sum(s.impulse) - booked).norm(), 1e-13 * scale);
    given += booked.norm();
    EXPECT_EQ(r.contact.crossings_found_by_verify, 0u);
  }
  EXPECT_GT(maximum, 4);
  EXPECT_GT(given, 0.01);
}

TEST(Substeps, the_host_gets_the_impulses_of_all_of_them) {
  World w(box(1), cut_into(8), verified());
  GridShape g;
  g.nu = g.nv = 17;
  g.origin = Vec3(-0.1, 0, -0.1);
  g.u = Vec3(0.2, 0, 0);
  g.v = Vec3(0, 0, 0.2);
  MockCloth<double> cloth(g);
  ASSERT_TRUE(w.attach(cloth, sheet_settings(), nullptr).ok());
  add_block(w, 4, Vec3(-0.01, 0.003, -0.013), Vec3(0, -4, 0));
  const Vec3 start = fluid_momentum(w);
  for (int k = 0; k < 20; ++k) ASSERT_TRUE(w.step(2e-3).status.ok());
  EXPECT_LE((fluid_momentum(w) + cloth.momentum() - start).norm(), 1e-12 * start.norm());
  EXPECT_GT(cloth.momentum().norm(), 0.1 * start.norm());
}

TEST(Substeps, reports_add_up) {
  FluidReport a, b;
  a.iterations = 3, b.iterations = 4;
  a.divergence_iterations = 2, b.divergence_iterations = 6;
  a.density_error_mean = 0.2, b.density_error_mean = 0.1;
  a.density_error_max = 0.3, b.density_error_max = 0.5;
  a.converged = false;
  b.diverged = true;
  const FluidReport both = worst_of(a, b);
  EXPECT_EQ(both.iterations, 7);
  EXPECT_EQ(both.divergence_iterations, 8);
  EXPECT_EQ(both.density_error_mean, 0.2);
  EXPECT_EQ(both.density_error_max, 0.5);
  EXPECT_FALSE(both.converged);
  EXPECT_TRUE(both.diverged);
}

void expect_exact_arrival(Storage storage) {
  World w(box(1), cut_into(50), verified());
  Driven sheet(0.1);
  sheet.storage = storage;
  SurfaceId id;
  ASSERT_TRUE(w.attach(sheet, sheet_settings(), &id).ok());
  add_block(w, 4, Vec3(-0.01, 0.01, -0.01), Vec3::Zero());
  class Watch : public IntervalObserver {
   public:
    std::vector<Vec3> begin;
    double longest = 0;
    void on_interval(const Interval& i) override {
      const SurfaceMotion& s = *i.surfaces[0];
      if (begin.empty()) begin = s.x_t0;
      for (int k = 0; k < 4; ++k) longest = std::max(longest, (s.x_t1[k] - s.x_t0[k]).norm());
    }
  } watch;
  w.set_observer(&watch);
  for (int k = 0; k < 20; ++k) {
    const std::vector<Vec3> before = sheet.nodes;
    sheet.move(Vec3(0.0011, 0.0163, -0.0007) / (1 + 0.1 * k));
    const std::vector<Vec3> target = sheet.nodes;
    watch = {};
    const StepReport& r = w.step(1e-3);
    EXPECT_GT(r.substeps, 1);
    EXPECT_LE(watch.longest, 0.4 * 0.005 * 1.001);
    EXPECT_EQ(watch.begin, before);
    const SurfaceMotion& s = *w.surface(id);
    EXPECT_EQ(s.x_t0, before);
    EXPECT_EQ(s.x_t1, target);
    EXPECT_EQ(sheet.nodes, target);
    EXPECT_EQ(r.contact.crossings_found_by_verify, 0u);
  }
  w.set_observer(nullptr);
  EXPECT_EQ(sheet.writes, 0);
  EXPECT_EQ(w.particle_count(), 64u);
  for (const Vec3& x : w.positions()) EXPECT_GT(x.y(), sheet.nodes[0].y());
}

TEST(Substeps, a_driven_surface_arrives_exactly_float) {
  expect_exact_arrival(Storage::float32);
}
TEST(Substeps, a_driven_surface_arrives_exactly_double) {
  expect_exact_arrival(Storage::float64);
}

TEST(Substeps, a_fast_wall_is_cut_where_it_meets_the_water_and_nowhere_else) {
  for (double at : {0.01, 0.3}) {  // the water's height above the sheet
    World w(box(1), cut_into(50));
    Driven sheet(0.1);
    ASSERT_TRUE(w.attach(sheet, sheet_settings(), nullptr).ok());
    add_block(w, 3, Vec3(0, at, 0), Vec3::Zero());
    sheet.move(Vec3(0, 0.005, 0));
    EXPECT_EQ(w.step(1e-3).substeps, at < 0.1 ? 3 : 1) << at;
  }
}

TEST(Substeps, two_pinned_sheets_that_close_on_water_hold_and_lose_nothing) {
  World w(box(10), cut_into(10), verified());
  Driven low(0.1), high(0.1);
  low.holdable = high.holdable = true;
  high.move(Vec3(0, 0.03, 0));
  ASSERT_TRUE(w.attach(low, sheet_settings(), nullptr).ok());
  ASSERT_TRUE(w.attach(high, sheet_settings(), nullptr).ok());
  add_block(w, 3, Vec3(0, 0.008, 0), Vec3::Zero());
  std::uint64_t stalled = 0;
  for (int k = 0; k < 12; ++k) {
    low.move(Vec3(0, 0.002, 0));
    high.move(Vec3(0.0001, -0.002, 0));
    const StepReport& r = w.step(1e-3);
    stalled += r.contact.stalled;
    EXPECT_EQ(r.contact.crossings_found_by_verify, 0u);
    EXPECT_EQ(r.flags & flag_scatter_mismatch, 0u);
    EXPECT_LE(r.momentum_residual().norm(), 1e-12 * 27 * w.particle_mass() * 100);
  }
  EXPECT_GT(stalled, 0u);
  EXPECT_EQ(w.particle_count(), 27u);
}

}  // namespace
}  // namespace oilskin::test
