// The oracle itself: its integers, and its results against the labels of the public sets and known cases.
#include <gtest/gtest.h>

#include <cmath>

#include "ccd/queries.h"
#include "ccd_command.h"
#include "support/exact.h"

namespace oilskin::test {
namespace {

using exact::Integer;
using exact::nearer_than;

TEST(Integer, agrees_with_built_in_arithmetic) {
  Random random(3);
  for (int i = 0; i < 20000; ++i) {
    const std::int64_t a = random.integer(-1000000000, 1000000000),
                       b = random.integer(-1000000000, 1000000000);
    EXPECT_TRUE(Integer(a) + Integer(b) == Integer(a + b));
    EXPECT_TRUE(Integer(a) - Integer(b) == Integer(a - b));
    EXPECT_TRUE(Integer(a) * Integer(b) == Integer(a * b));
    const int shift = random.integer(0, 30);
    EXPECT_TRUE((Integer(a) << shift) == Integer(a * (std::int64_t{1} << shift)));
    EXPECT_TRUE(((Integer(a) << 100) >> 100) == Integer(a));
  }
}

TEST(Integer, keeps_the_laws_of_arithmetic_when_long) {
  Random random(5);
  const auto large = [&] {
    Integer x(random.integer(-1000, 1000));
    for (int i = random.integer(0, 8); i > 0; --i)
      x = x * Integer(random.integer(-1000000000, 1000000000)) + Integer(i);
    return x << random.integer(0, 70);
  };
  for (int i = 0; i < 2000; ++i) {
    const Integer a = large(), b = large(), c = large();
    EXPECT_TRUE(a * (b + c) == a * b + a * c);
    EXPECT_TRUE((a - b) * (a + b) == a * a - b * b);
    EXPECT_EQ((a - b).sign(), -(b - a).sign());
  }
}

TEST(Integer, holds_doubles_exactly) {
  EXPECT_TRUE(Integer::from_double(-3.5, 1) == Integer(-7));
  EXPECT_TRUE(Integer::from_double(0x1p-1074, 1074) == Integer(1));
  EXPECT_TRUE(Integer::from_double(0x1p300, -290) == Integer(1024));
  EXPECT_THROW(Integer::from_double(0.5, 0), std::invalid_argument);
  EXPECT_THROW(Integer::from_double(std::nan(""), 0), std::invalid_argument);
}

TEST(Oracle, agrees_with_the_labels_of_the_public_sets) {
  for (const char* name : {"unit-tests", "erleben-spikes", "erleben-wedges", "erleben-sliding-spike"}) {
    std::vector<demo::LabelledQuery> queries;
    std::string error;
    const std::string file = std::string(OILSKIN_TEST_DATA) + "/" + name + ".csv";
    ASSERT_TRUE(demo::read_queries(file, &queries, &error)) << error;
    for (std::size_t i = 0; i < queries.size(); ++i) {
      const ccd::PointTriangleMotion& m = queries[i].motion;
      const Corners x{m.p_t0, m.a_t0, m.b_t0, m.c_t0, m.p_t1, m.a_t1, m.b_t1, m.c_t1};
      EXPECT_EQ(exact::point_triangle(to_exact(x)).hit, queries[i].hit) << name << ", query " << i;
    }
  }
}

exact::Answer past_unit_triangle(const Vec3& from, const Vec3& to, const Vec3& lift_of_c = Vec3::Zero()) {
  const Vec3 a(0, 0, 0), b(1, 0, 0), c(0, 1, 0);
  return exact::point_triangle(to_exact({from, a, b, c, to, a, b, c + lift_of_c}));
}

TEST(Oracle, finds_the_time_of_first_touch) {
  const exact::Answer half = past_unit_triangle({.25, .25, 1}, {.25, .25, -1});
  EXPECT_TRUE(half.hit);
  EXPECT_FALSE(half.coplanar);
  EXPECT_EQ(half.touch_lower, 0.5);
  EXPECT_EQ(half.touch_upper, 0.5);
  const exact::Answer third = past_unit_triangle({.25, .25, 1}, {.25, .25, -2});
  EXPECT_TRUE(third.hit);
  EXPECT_LE(third.touch_lower, 1.0 / 3);
  EXPECT_GE(third.touch_upper, 1.0 / 3);
  EXPECT_LE(third.touch_upper - third.touch_lower, 0x1p-54);
  const exact::Answer grazing = past_unit_triangle({.25, .75, .25}, {.25, -.25, 0}, {0, 0, 1});
  EXPECT_TRUE(grazing.hit);
  EXPECT_EQ(grazing.touch_lower, 0.5);
}

TEST(Oracle, decides_by_the_last_bit) {
  const double smallest = 0x1p-1074;
  EXPECT_TRUE(past_unit_triangle({0, 0, 1}, {0, 0, -1}).hit);
  EXPECT_FALSE(past_unit_triangle({-smallest, 0, 1}, {-smallest, 0, -1}).hit);
  EXPECT_FALSE(past_unit_triangle({.5, std::nextafter(.5, 1), 1}, {.5, std::nextafter(.5, 1), -1}).hit);
  EXPECT_TRUE(past_unit_triangle({.5, .5, 1}, {.5, .5, -1}).hit);
  EXPECT_FALSE(past_unit_triangle({.25, .25, 1}, {.25, .25, smallest}).hit);
}

TEST(Oracle, handles_coplanar_and_degenerate_motion) {
  const exact::Answer flat = past_unit_triangle({-1, .25, 0}, {1, .25, 0});
  EXPECT_TRUE(flat.hit);
  EXPECT_TRUE(flat.coplanar);
  EXPECT_EQ(flat.touch_lower, 0.5);
  EXPECT_FALSE(past_unit_triangle({-1, 1.5, 0}, {1, 1.5, 0}).hit);
  EXPECT_EQ(past_unit_triangle({.1, .1, 0}, {5, 5, 0}).touch_lower, 0);
  const Vec3 o(0, 0, 0), b(1, 0, 0), m(.5, 0, 0), above(.5, 0, 1), below(.5, 0, -1), past(2, 0, -1);
  EXPECT_EQ(exact::point_triangle(to_exact({above, o, b, m, below, o, b, m})).touch_lower, 0.5);
  EXPECT_FALSE(exact::point_triangle(to_exact({Vec3(2, 0, 1), o, b, m, past, o, b, m})).hit);
  EXPECT_EQ(exact::point_triangle(to_exact({above, m, m, m, below, m, m, m})).touch_lower, 0.5);
  // Along the line of a segment: the first touch is its end.
  EXPECT_EQ(exact::point_triangle(to_exact({Vec3(-1, 0, 0), o, b, m, Vec3(3, 0, 0), o, b, m})).touch_lower,
            0.25);
}

TEST(Oracle, compares_distances_exactly) {
  const exact::Point a{0, 0, 0}, b{1, 0, 0}, c{0, 1, 0};
  const double limit = 0x1p-10, more = std::nextafter(limit, 1);
  for (const exact::Point& p : {exact::Point{.25, .25, limit}, exact::Point{.5, -limit, 0},
                                exact::Point{1 + limit, 0, 0}, exact::Point{0, 0, -limit}}) {
    EXPECT_FALSE(nearer_than(p, a, b, c, limit));
    EXPECT_TRUE(nearer_than(p, a, b, c, more));
    EXPECT_FALSE(nearer_than(p, c, a, b, limit));
    EXPECT_TRUE(nearer_than(p, b, c, a, more));
  }
  EXPECT_FALSE(nearer_than({.25, .25, 0}, a, b, c, 0));
  EXPECT_TRUE(nearer_than({.25, .25, 0}, a, b, c, 0x1p-1074));
  EXPECT_TRUE(nearer_than({0, 3, 4}, a, a, a, 5.0000001));
  EXPECT_FALSE(nearer_than({0, 3, 4}, a, a, a, 5));
  EXPECT_FALSE(nearer_than({.5, 3, 4}, a, b, {.25, 0, 0}, 5));
  EXPECT_TRUE(nearer_than({.5, 3, 4}, a, b, {.25, 0, 0}, 5.0000001));
}

/// The distance of random points against plain arithmetic, away from the limit.
TEST(Oracle, agrees_with_sampled_distances) {
  Random random(19);
  for (int i = 0; i < 500; ++i) {
    const Vec3 p = random.vector(1), a = random.vector(1), b = random.vector(1), c = random.vector(1);
    double sampled = 10;
    for (int j = 0; j <= 100; ++j) {
      for (int k = 0; j + k <= 100; ++k)
        sampled = std::min(sampled, (p - (a + (b - a) * j / 100 + (c - a) * k / 100)).norm());
    }
    const auto point = [](const Vec3& v) { return exact::Point{v[0], v[1], v[2]}; };
    EXPECT_TRUE(nearer_than(point(p), point(a), point(b), point(c), sampled + 1e-9));
    EXPECT_FALSE(nearer_than(point(p), point(a), point(b), point(c), sampled - 0.03));
  }
}

}  // namespace
}  // namespace oilskin::test
