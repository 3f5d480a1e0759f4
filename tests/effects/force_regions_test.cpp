// Regions of force fields: what they enclose, and which fields may act at one place.
#include <gtest/gtest.h>

#include <cmath>

#include "oilskin/force_fields.h"
#include "support/random.h"

namespace oilskin::test {
namespace {

TEST(RegionBounds, have_all_points_of_the_region) {
  Random random(3);
  for (int n = 0; n < 20; ++n) {
    Region box = box_region({Vec3(-0.1, -0.2, -0.3), Vec3(0.2, 0.1, 0.4)}),
           ball = ball_region(random.in_cube(0.2), 0.3);
    for (Region* r : {&box, &ball}) {
      r->pose.position = random.in_cube(1);
      const Vec3 axis = random.direction();
      r->pose.rotation = Rotation(Eigen::AngleAxis<double>(random.uniform(0, 3), axis));
      const Box bounds = *r->bounds();
      int inside = 0;
      for (int k = 0; k < 2000; ++k) {
        const Vec3 x = r->pose.position + random.in_cube(0.6);
        if (!r->contains(x)) continue;
        ++inside;
        EXPECT_TRUE(bounds.contains(x));
      }
      EXPECT_GT(inside, 20);
      EXPECT_LT((bounds.max - bounds.min).maxCoeff(), 1.2);
    }
  }
  Region half;
  half.half_spaces.push_back({});
  EXPECT_FALSE(half.bounds());
  EXPECT_FALSE(Region().bounds());
}

UniformForce force_in(double acceleration, const std::optional<Box>& where) {
  UniformForce f;
  f.acceleration = Vec3(0, acceleration, 0);
  if (where) f.region = box_region(*where);
  return f;
}

TEST(ForceFields, limit_the_interval_by_what_may_act_at_one_place) {
  const FluidSettings fluid;
  const double height = fluid.support_ratio * fluid.spacing;
  const auto limit = [&](double acceleration) { return 0.25 * std::sqrt(height / acceleration); };
  ForceFields fields;
  for (int k = 0; k < 100; ++k)
    ASSERT_TRUE(fields.add(force_in(1, Box{Vec3(2 * k, 0, 0), Vec3(2 * k + 1, 1, 1)})).ok());
  EXPECT_NEAR(fields.longest_interval(fluid), limit(1), 1e-12) << "apart";
  ASSERT_TRUE(fields.add(force_in(3, Box{Vec3(0.5, 0, 0), Vec3(2.5, 1, 1)})).ok());
  EXPECT_NEAR(fields.longest_interval(fluid), limit(5), 1e-12) << "one that overlaps two of them";
  ASSERT_TRUE(fields.add(force_in(10, std::nullopt)).ok());
  EXPECT_NEAR(fields.longest_interval(fluid), limit(15), 1e-12) << "one that acts everywhere";
}

TEST(ForceFields, look_for_walls_in_wind_alone) {
  ForceFields fields;
  ForceId wind;
  ASSERT_TRUE(fields.add(force_in(1, std::nullopt)).ok());
  EXPECT_EQ(fields.wall_reach(), 0);
  ASSERT_TRUE(fields.add(WindForce(), &wind).ok());
  EXPECT_GT(fields.wall_reach(), 0);
  ASSERT_TRUE(fields.set_enabled(wind, false).ok());
  EXPECT_EQ(fields.wall_reach(), 0);
}

}  // namespace
}  // namespace oilskin::test
