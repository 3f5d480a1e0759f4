// The counter of leaks against the exact auditor of motion traces, with which it shares no code.
#include <gtest/gtest.h>

#include "audit/trace_auditor.h"
#include "method_helpers.h"
#include "study/comparators/leak_table.h"
#include "study/comparators/run_clock.h"
#include "support/random.h"

namespace oilskin::study {
namespace {

audit::Point point(const Vec3& x) {
  return {x.x(), x.y(), x.z()};
}

audit::Record record_of(const Interval& interval) {
  audit::Record record;
  record.length = interval.length;
  for (std::size_t i = 0; i < interval.id.size(); ++i) {
    record.ids.push_back(interval.id[i]);
    record.start.push_back(point(interval.x_t0[i]));
    record.end.push_back(point(interval.x_t1[i]));
  }
  for (const SurfaceMotion* m : interval.surfaces) {
    audit::Surface surface;
    surface.id = m->id;
    for (const Vec3& x : m->x_t0) surface.start.push_back(point(x));
    for (const Vec3& x : m->x_t1) surface.end.push_back(point(x));
    surface.triangles.assign(m->triangles.begin(), m->triangles.end());
    record.surfaces.push_back(surface);
  }
  return record;
}

audit::Summary audited(const Interval& interval) {
  audit::Auditor auditor{audit::Limits()};
  auditor.audit(record_of(interval));
  return auditor.summary();
}

/// One triangle and one particle.
struct Pair {
  SurfaceMotion surface;
  std::vector<Vec3> x_t0, x_t1;
  std::vector<std::uint64_t> id;
  std::vector<SurfaceMotion*> surfaces;

  Interval interval() {
    Interval all;
    surfaces = {&surface};
    all.length = 1, all.id = id, all.x_t0 = x_t0, all.x_t1 = x_t1;
    all.surfaces = Span<SurfaceMotion* const>(surfaces.data(), 1);
    return all;
  }
};

Pair flat_square() {
  Pair pair;
  pair.surface.id = 1;
  pair.surface.triangles = {{0, 2, 1}, {0, 3, 2}};  // normals towards +y
  pair.surface.x_t0 = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 0, 1), Vec3(0, 0, 1)};
  pair.surface.x_t1 = pair.surface.x_t0;
  return pair;
}

std::vector<Passage> path(const Vec3& from, const Vec3& to) {
  Pair pair = flat_square();
  pair.id = {7}, pair.x_t0 = {from}, pair.x_t1 = {to};
  return count_leaks(pair.interval());
}

TEST(LeakCounter, agrees_with_exact_arithmetic_on_random_moving_triangles) {
  test::Random random(5);
  const auto somewhere = [&] {
    return Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
  };
  std::uint64_t hits = 0;
  for (int k = 0; k < 4000; ++k) {
    Pair pair;
    pair.surface.id = 1;
    pair.surface.triangles = {{0, 1, 2}};
    for (int i = 0; i < 3; ++i) {
      pair.surface.x_t0.push_back(somewhere());
      pair.surface.x_t1.push_back(pair.surface.x_t0.back() + 0.7 * somewhere());
    }
    pair.id = {1}, pair.x_t0 = {somewhere()}, pair.x_t1 = {somewhere()};
    const Interval interval = pair.interval();
    const audit::Summary exact = audited(interval);
    ASSERT_EQ(count_leaks(interval).empty(), exact.crossings + exact.touchings == 0) << "pair " << k;
    hits += exact.crossings;
  }
  EXPECT_GT(hits, 100u);
}

TEST(LeakCounter, a_path_through_an_edge_or_vertex_counts_once_and_one_around_the_border_not) {
  ASSERT_EQ(path(Vec3(0.25, 1, 0.5), Vec3(0.25, -1, 0.5)).size(), 1u);
  EXPECT_EQ(path(Vec3(0.25, 1, 0.5), Vec3(0.25, -1, 0.5))[0].direction, -1);
  EXPECT_EQ(path(Vec3(0.5, 1, 0.5), Vec3(0.5, -1, 0.5)).size(), 1u) << "the diagonal";
  EXPECT_EQ(path(Vec3(0, -1, 0), Vec3(0, 1, 0)).size(), 1u) << "a node";
  EXPECT_TRUE(path(Vec3(-0.01, 1, 0.5), Vec3(-0.01, -1, 0.5)).empty());
  EXPECT_TRUE(path(Vec3(0.5, 1, 0.5), Vec3(0.5, 0.1, 0.5)).empty());
}

TEST(LeakCounter, who_comes_back_has_passed_but_is_not_beyond) {
  LeakCounter counter;
  Pair pair = flat_square();
  pair.id = {7, 8};
  pair.x_t0 = {Vec3(0.2, 1, 0.5), Vec3(0.3, 1, 0.5)}, pair.x_t1 = {Vec3(0.2, -1, 0.5), Vec3(0.3, -1, 0.5)};
  counter.on_interval(pair.interval());
  pair.x_t0 = pair.x_t1, pair.x_t1 = {Vec3(0.2, 1, 0.5), Vec3(0.3, -2, 0.5)};
  counter.on_interval(pair.interval());
  EXPECT_EQ(counter.count().passages, 3u);
  EXPECT_EQ(counter.count().particles, 2u);
  EXPECT_EQ(counter.count().beyond, 1u);
}

/// Counts every interval of a run twice.
class BothCounters : public IntervalObserver {
 public:
  void on_interval(const Interval& interval) override {
    passages += count_leaks(interval).size();
    exact += audited(interval).crossings;
  }
  std::uint64_t passages = 0, exact = 0;
};

/// A block at 10 m/s on a sheet, which is struck for `steps` of 2 ms.
void expect_agreement(Method which, Held held, int steps) {
  const std::unique_ptr<CouplingMethod> method = make_method(which, {});
  SheetSettings shape;
  shape.held = held;
  Sheet sheet(shape);
  ASSERT_TRUE(method->attach(sheet.host()).ok());
  add_water(*method, {Vec3(-0.0213, 0.006, -0.0207), Vec3(0.02, 0.03, 0.02)}, Vec3(0.3, -10, 0.2));
  BothCounters both;
  method->set_observer(&both);
  for (int k = 0; k < steps; ++k) {
    sheet.advance(2e-3, Vec3(0, -9.81, 0));
    ASSERT_TRUE(method->step(2e-3).ok());
  }
  EXPECT_EQ(both.passages, both.exact) << name_of(which);
  EXPECT_GT(both.exact, 10u) << name_of(which);
}

TEST(LeakCounter, agrees_with_exact_arithmetic_on_runs_of_leaking_methods) {
  for (Method which :
       {Method::repulsion, Method::penalty, Method::boundary_particles, Method::position_based})
    expect_agreement(which, Held::border, 12);
  expect_agreement(Method::paper, Held::none, 30);
}

}  // namespace
}  // namespace oilskin::study
