// The continuous test on cases with known results, on public sets, and its contract.
#include "ccd/point_triangle.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "ccd/exact_query.h"
#include "ccd/queries.h"
#include "ccd_command.h"

namespace oilskin::test {
namespace {

const Vec3 kA(0, 0, 0), kB(1, 0, 0), kC(0, 1, 0);

ccd::Impact impact_of(const Corners& x) {
  return ccd::point_triangle(to_motion(x));
}

/// The unit triangle at rest and a point that moves.
Corners past_unit_triangle(const Vec3& from, const Vec3& to) {
  return {from, kA, kB, kC, to, kA, kB, kC};
}

/// A hit, not late, and early by less than a rounding or two.
void expect_hit_at(double time, const Corners& x) {
  const ccd::Impact impact = impact_of(x);
  EXPECT_TRUE(impact.hit);
  EXPECT_LE(impact.time, time);
  EXPECT_NEAR(impact.time, time, 3e-8);
}

// Cases with known results.

TEST(PointTriangle, head_on_through_the_face) {
  expect_hit_at(0.5, past_unit_triangle({.25, .25, 1}, {.25, .25, -1}));
}

TEST(PointTriangle, triangle_moves_towards_the_point) {
  const Vec3 up(0, 0, 1);
  expect_hit_at(1.0 / 3, {Vec3(.25, .25, 1), kA, kB, kC, Vec3(.25, .25, -1), kA + up, kB + up, kC + up});
}

TEST(PointTriangle, grazing_at_a_double_root_is_a_hit) {
  const ccd::Impact impact =
      impact_of({Vec3(.25, .75, .25), kA, kB, kC, Vec3(.25, -.25, 0), kA, kB, kC + Vec3(0, 0, 1)});
  EXPECT_TRUE(impact.hit);
  EXPECT_LE(impact.time, 0.5);
  EXPECT_NEAR(impact.time, 0.5, 1e-6);
}

TEST(PointTriangle, coplanar_motion_hits_the_edge) {
  expect_hit_at(0.5, past_unit_triangle({-1, .25, 0}, {1, .25, 0}));
}

TEST(PointTriangle, segment_is_hit) {
  const Vec3 middle(.5, 0, 0);
  expect_hit_at(0.5, {Vec3(.5, 0, 1), kA, kB, middle, Vec3(.5, 0, -1), kA, kB, middle});
}

TEST(PointTriangle, point_is_hit) {
  expect_hit_at(0.5, {Vec3(0, 0, 1), kA, kA, kA, Vec3(0, 0, -1), kA, kA, kA});
}

TEST(PointTriangle, passing_beside_is_no_hit) {
  EXPECT_FALSE(impact_of(past_unit_triangle({2, 2, 1}, {2, 2, -1})).hit);
}

TEST(PointTriangle, common_translation_is_no_hit) {
  const Vec3 d(10, -7, 3), p(.25, .25, .125);
  EXPECT_FALSE(impact_of({p, kA, kB, kC, p + d, kA + d, kB + d, kC + d}).hit);
}

TEST(PointTriangle, vertex_and_edge_are_hit_for_each_incident_triangle) {
  const Vec3 mirrored(-1, 0, 0), opposite(1, 1, 0);
  for (const Corners& x :
       {past_unit_triangle({0, 0, 1}, {0, 0, -1}), past_unit_triangle({.5, .5, 1}, {.5, .5, -1})}) {
    expect_hit_at(0.5, x);
  }
  expect_hit_at(0.5, {Vec3(0, 0, 1), mirrored, kC, kA, Vec3(0, 0, -1), mirrored, kC, kA});
  expect_hit_at(0.5, {Vec3(.5, .5, 1), kB, opposite, kC, Vec3(.5, .5, -1), kB, opposite, kC});
}

TEST(PointTriangle, stopping_just_above_is_no_hit) {
  EXPECT_FALSE(impact_of(past_unit_triangle({.25, .25, 1}, {.25, .25, 1e-9})).hit);
  EXPECT_FALSE(impact_of(past_unit_triangle({.25, .25, 1}, {.25, .25, 1e-15})).hit);
}

// The contract.

TEST(PointTriangle, unmoved_points_that_touch_are_an_impact_at_zero) {
  for (const Vec3& p : {Vec3(.25, .25, 0), Vec3(.5, .5, 0), Vec3(.5, 0, 0), kA, kB, kC}) {
    const ccd::Impact impact = ccd::point_triangle(to_motion(past_unit_triangle(p, p)));
    EXPECT_TRUE(impact.hit);
    EXPECT_EQ(impact.time, 0);
  }
  for (const Vec3& p : {Vec3(.25, .25, 1e-300), Vec3(.75, .75, 0), Vec3(-1, 0, 0)})
    EXPECT_FALSE(impact_of(past_unit_triangle(p, p)).hit);
}

TEST(PointTriangle, unmoved_points_are_decided_exactly) {
  Random random(7);
  int hits = 0;
  constexpr int kQueries = 4000;
  for (int i = 0; i < kQueries; ++i) {
    Corners x = families()[i % families().size()].make(random);
    for (int k = 0; k < 4; ++k) x[4 + k] = x[k];
    const ccd::Impact found = impact_of(x);
    EXPECT_EQ(found.hit, exact::point_triangle(to_exact(x)).hit);
    if (!found.hit) continue;
    EXPECT_EQ(found.time, 0);
    ++hits;
  }
  EXPECT_GT(hits, kQueries / 25);
  EXPECT_GT(kQueries - hits, kQueries / 25);
}

TEST(PointTriangle, initial_and_final_touch_are_hits) {
  expect_hit_at(0, past_unit_triangle({.25, .25, 0}, {.25, .25, 1}));
  expect_hit_at(0, past_unit_triangle(kA, {-1, -1, 1}));
  expect_hit_at(1, past_unit_triangle({.25, .25, 1}, {.25, .25, 0}));
}

TEST(PointTriangle, smallest_gaps_are_seen) {
  const double smallest = std::numeric_limits<double>::denorm_min();
  EXPECT_FALSE(impact_of(past_unit_triangle({.25, .25, 1}, {.25, .25, smallest})).hit);
  EXPECT_TRUE(impact_of(past_unit_triangle({.25, .25, 1}, {.25, .25, 0})).hit);
  EXPECT_FALSE(impact_of(past_unit_triangle({-smallest, .25, 1}, {-smallest, .25, -1})).hit);
}

TEST(PointTriangle, largest_coordinates_are_handled) {
  Corners x = past_unit_triangle({.25, .25, 1}, {.25, .25, -1});
  for (Vec3& v : x) v *= 1e89;
  expect_hit_at(0.5, x);
  Corners miss = past_unit_triangle({2, 2, 1}, {1.5, 2, -1});
  for (Vec3& v : miss) v *= 1e89;
  EXPECT_FALSE(impact_of(miss).hit);
}

/// Beyond the sizes that the contract names: the largest and the smallest numbers in one query.
TEST(PointTriangle, any_finite_coordinates_are_decided_exactly) {
  Random random(43);
  for (int i = 0; i < 24; ++i) {
    Corners x = families()[3].make(random);
    for (Vec3& v : x)
      v[random.integer(0, 2)] = std::ldexp(random.uniform(-1, 1), random.integer(0, 1) == 0 ? 1023 : -1021);
    const ccd::Impact found = ccd::detail::exact_impact(to_motion(x));
    EXPECT_EQ(found.hit, exact::point_triangle(to_exact(x)).hit);
    EXPECT_EQ(impact_of(x).hit, found.hit);
  }
}

TEST(PointTriangle, one_coordinate_that_is_not_a_number_hides_no_hit_wherever_it_stands) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (int k = 0; k < 24; ++k) {
    Corners x = past_unit_triangle({.25, .25, 1}, {.25, .25, -1});
    x[std::size_t(k) / 3][k % 3] = nan;
    EXPECT_TRUE(impact_of(x).hit) << k;
  }
}

TEST(PointTriangle, what_is_not_finite_counts_as_a_hit_unless_an_axis_separates) {
  // Beyond the contract; it must end, and must not claim that paths are disjoint.
  const double nan = std::numeric_limits<double>::quiet_NaN(),
               infinity = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(impact_of(past_unit_triangle({nan, nan, nan}, {.25, .25, -1})).hit);
  EXPECT_TRUE(impact_of(past_unit_triangle({.25, .25, infinity}, {.25, .25, -infinity})).hit);
}

TEST(PointTriangle, same_bits_give_the_same_result) {
  Random random(11);
  for (int i = 0; i < 2000; ++i) {
    const Corners x = families()[i % families().size()].make(random);
    const ccd::Impact first = impact_of(x), second = impact_of(x);
    EXPECT_EQ(first.hit, second.hit);
    EXPECT_EQ(first.time, second.time);
  }
}

/// Exact results do not depend on the order of corners, the direction of time, or the scale (by powers of
/// two).
TEST(PointTriangle, results_do_not_depend_on_order_mirroring_or_scale) {
  Random random(13);
  for (int i = 0; i < 4000; ++i) {
    const Corners x = families()[i % families().size()].make(random);
    const bool hit = impact_of(x).hit;
    EXPECT_EQ(impact_of({x[0], x[2], x[3], x[1], x[4], x[6], x[7], x[5]}).hit, hit);
    EXPECT_EQ(impact_of({x[0], x[3], x[2], x[1], x[4], x[7], x[6], x[5]}).hit, hit);
    EXPECT_EQ(impact_of({x[4], x[5], x[6], x[7], x[0], x[1], x[2], x[3]}).hit, hit);
    Corners mirrored = x, doubled = x;
    for (Vec3& v : mirrored) v = Vec3(-v[2], v[0], v[1]);
    for (Vec3& v : doubled) v *= 2;
    EXPECT_EQ(impact_of(mirrored).hit, hit);
    EXPECT_EQ(impact_of(doubled).hit, hit);
  }
}

/// Random queries, which are far from touching or clearly hit, have exact results.
TEST(PointTriangle, clear_queries_are_decided_exactly) {
  Random random(17);
  int hits = 0;
  for (int i = 0; i < 8000; ++i) {
    Corners x;
    for (Vec3& v : x) v = random.vector(1);
    const bool truth = exact::point_triangle(to_exact(x)).hit;
    EXPECT_EQ(impact_of(x).hit, truth);
    hits += truth ? 1 : 0;
  }
  EXPECT_GT(hits, 400);  // about one query in thirteen hits
}

// The public sets (see data/LICENSE), labelled by exact arithmetic.

class PublicSet : public testing::TestWithParam<const char*> {};

TEST_P(PublicSet, no_false_results) {
  std::vector<demo::LabelledQuery> queries;
  std::string error;
  ASSERT_TRUE(demo::read_queries(std::string(OILSKIN_TEST_DATA) + "/" + GetParam(), &queries, &error))
      << error;
  ASSERT_EQ(queries.size(), 250u);
  int false_negatives = 0, false_positives = 0;
  for (const demo::LabelledQuery& query : queries) {
    const bool found = ccd::point_triangle(query.motion).hit;
    false_negatives += query.hit && !found ? 1 : 0;
    false_positives += !query.hit && found ? 1 : 0;
  }
  EXPECT_EQ(false_negatives, 0);
  EXPECT_EQ(false_positives, 0);
}

INSTANTIATE_TEST_SUITE_P(Files, PublicSet,
                         testing::Values("unit-tests.csv", "erleben-spikes.csv", "erleben-wedges.csv",
                                         "erleben-sliding-spike.csv"));

}  // namespace
}  // namespace oilskin::test
