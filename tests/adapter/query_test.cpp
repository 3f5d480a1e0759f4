// Questions of a game about water at rest in a tank.
#include <gtest/gtest.h>

#include <thread>

#include "game.h"
#include "oilskin/bullet_query.h"
#include "oilskin/wetting.h"

namespace oilskin::bullet {
namespace {

using namespace test;

const btVector3 up(0, 1, 0);
const btScalar nan_ = std::numeric_limits<btScalar>::quiet_NaN();

class Query : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    FluidSettings fluid = coarse_fluid(PressureSolver::dfsph);
    fluid.boundary = BoundaryModel::mirrored;
    game_ = new Game(1, fluid);
    tank_ = new Tank;
    EXPECT_TRUE(game_->solver.addCollisionObject(&tank_->object, bt(0.002)).ok());
    EXPECT_TRUE(game_->water.addBox({bt(-0.09), bt(0.01), bt(-0.09)}, {bt(0.09), bt(0.09), bt(0.09)}).ok());
    game_->run(500);
  }
  static void TearDownTestSuite() {
    delete game_;
    delete tank_;
  }
  static Game* game_;
  static Tank* tank_;
};
Game* Query::game_ = nullptr;
Tank* Query::tank_ = nullptr;

TEST_F(Query, volumes_are_those_of_the_particles_inside) {
  const btFluidQuery query(game_->water);
  const double all = static_cast<double>(game_->water.getVolume());
  EXPECT_NEAR(static_cast<double>(query.getVolume({-1, -1, -1}, {1, 1, 1})), all, 1e-6 * all);
  const double half = static_cast<double>(query.getVolume({-1, -1, -1}, {0, 1, 1}));
  EXPECT_GT(half, 0.35 * all);
  EXPECT_LT(half, 0.65 * all);
  btBoxShape box({bt(0.05), bt(0.05), bt(0.05)});
  const btTransform at(btQuaternion::getIdentity(), {0, bt(0.03), 0});
  const auto inside = static_cast<double>(query.getVolume(&box, at));
  EXPECT_GT(inside, 0);
  EXPECT_EQ(inside, static_cast<double>(
                        query.getVolume({bt(-0.05), bt(-0.02), bt(-0.05)}, {bt(0.05), bt(0.08), bt(0.05)})));
  btSphereShape sphere(bt(2));
  EXPECT_NEAR(static_cast<double>(query.getVolume(&sphere, at)), all, 1e-6 * all);
}

TEST_F(Query, the_level_is_that_of_the_volume) {
  const btFluidQuery query(game_->water);
  const double height = static_cast<double>(game_->water.getVolume()) / (0.2 * 0.2);
  btScalar level = 0;
  for (const double x : {-0.03, 0.0, 0.04}) {
    ASSERT_TRUE(query.getLevel({bt(x), 0, 0}, up, level));
    EXPECT_NEAR(static_cast<double>(level), height, 0.02) << "within a spacing";
    // On the line the density is half there.
    EXPECT_NEAR(static_cast<double>(query.getDensity({bt(x), level, 0})), 500, 20);
  }
  btScalar from_above = 0, scaled = 0;
  ASSERT_TRUE(query.getLevel({bt(0.04), 1, 0}, up, from_above));
  EXPECT_NEAR(static_cast<double>(from_above), static_cast<double>(level) - 1, 1e-5);
  ASSERT_TRUE(query.getLevel({bt(0.04), 0, 0}, bt(7) * up, scaled));
  EXPECT_NEAR(static_cast<double>(scaled), static_cast<double>(level), 1e-5);
  EXPECT_FALSE(query.getLevel({1, 0, 0}, up, level)) << "beside the tank";
}

TEST_F(Query, a_drop_above_the_pool_is_no_level) {
  btFluid water(coarse_fluid(), small_world(), ContactSettings{});
  std::vector<Vec3> x;
  for (int i = 0; i < 10; ++i)
    for (int j = 0; j < 10; ++j)
      for (int k = 0; k < 10; ++k) x.emplace_back(0.02 * Vec3(i + 0.5, j + 0.5, k + 0.5));
  x.emplace_back(0.1, 1, 0.1);
  ASSERT_TRUE(water.getWorld().add_particles(x, std::vector<Vec3>(x.size(), Vec3(0, -1, 0))).ok());
  const btFluidQuery query(water);
  btScalar level = 0;
  ASSERT_TRUE(query.getLevel({bt(0.1), 0, bt(0.1)}, up, level));
  EXPECT_NEAR(static_cast<double>(level), 0.2, 0.002) << "the top of the block";
  ASSERT_TRUE(query.getLevel({0, bt(0.1), bt(0.1)}, {1, 0, 0}, level));
  EXPECT_NEAR(static_cast<double>(level), 0.2, 0.002);
  EXPECT_EQ(query.findNearest({bt(0.1), bt(0.9), bt(0.1)}), 1000);
  EXPECT_NEAR(static_cast<double>(query.getVelocityAt({bt(0.1), bt(0.1), bt(0.1)}).y()), -1, 1e-6);
}

TEST_F(Query, rays_hit_the_surface_first) {
  const btFluidQuery query(game_->water);
  btFluidRayResult hit;
  // Down through the centre of a particle: between particles, a ray may pass the whole depth.
  const int below = query.findNearest({bt(0.01), 1, bt(0.01)});
  ASSERT_GE(below, 0);
  const btVector3 on = game_->water.getPosition(below);
  ASSERT_TRUE(query.rayTest({on.x(), 1, on.z()}, {on.x(), -1, on.z()}, hit));
  const Vec3 x = to_vec3(game_->water.getPosition(hit.m_particle));
  EXPECT_NEAR((to_vec3(hit.m_point) - x).norm(), 0.01, 1e-5);
  EXPECT_NEAR(static_cast<double>(hit.m_point.y()), 1 - 2 * static_cast<double>(hit.m_fraction), 1e-5);
  EXPECT_GT(hit.m_normal.y(), 0);
  for (const Vec3& p : game_->water.getWorld().positions())
    if (std::hypot(p.x() - static_cast<double>(on.x()), p.z() - static_cast<double>(on.z())) < 0.0099) {
      EXPECT_LT(p.y(), static_cast<double>(hit.m_point.y()) + 1e-5);
    }
  EXPECT_FALSE(query.rayTest({1, 1, 1}, {1, -1, 1}, hit));
}

TEST_F(Query, points_and_nearest_particles) {
  const btFluidQuery query(game_->water);
  EXPECT_TRUE(query.isWet({0, bt(0.02), 0}));
  EXPECT_FALSE(query.isWet({0, bt(0.2), 0}));
  EXPECT_NEAR(static_cast<double>(query.getDensity({0, bt(0.04), 0})), 1000, 100);
  EXPECT_LT(query.getVelocityAt({0, bt(0.03), 0}).length(), bt(0.3));
  const btVector3 p(bt(0.03), bt(0.2), bt(-0.02));
  const int nearest = query.findNearest(p);
  ASSERT_GE(nearest, 0);
  for (int i = 0; i < game_->water.getNumParticles(); ++i)
    EXPECT_LE((game_->water.getPosition(nearest) - p).length(),
              (game_->water.getPosition(i) - p).length() + bt(1e-6));
}

TEST_F(Query, is_near_is_the_same_with_and_without_cells) {
  const WaterQuery query(game_->water.getWorld());
  int near = 0;
  for (int i = 0; i < 60; ++i) {
    const Vec3 p(0.004 * i - 0.12, 0.003 * i, 0.02);
    double least = 1;
    for (const Vec3& x : query.positions()) least = std::min(least, (x - p).norm());
    for (const double distance : {0.0, 0.01, 0.02, 0.04, 0.06}) {
      bool is = false;
      ASSERT_TRUE(query.is_near(p, distance, &is).ok());
      EXPECT_EQ(is, least <= distance) << i << " " << distance;
      near += is;
    }
  }
  EXPECT_GT(near, 50);
  EXPECT_LT(near, 250);
}

TEST_F(Query, many_threads_may_ask_at_once) {
  const btFluidQuery query(game_->water);
  const auto ask = [&](std::vector<btScalar>* out) {
    for (int i = 0; i < 50; ++i) {
      btScalar level = -1;
      query.getLevel({bt(0.002 * i - 0.05), 0, 0}, up, level);
      out->push_back(level);
      out->push_back(query.getDensity({bt(0.002 * i - 0.05), bt(0.03), 0}));
    }
  };
  std::vector<btScalar> results[4];
  std::vector<std::thread> threads;
  for (auto& result : results) threads.emplace_back(ask, &result);
  for (std::thread& thread : threads) thread.join();
  for (const auto& result : results) EXPECT_EQ(result, results[0]);
}

TEST_F(Query, bad_input_is_refused) {
  const btFluidQuery query(game_->water);
  const btVector3 bad(nan_, 0, 0), o(0, 0, 0);
  btScalar level = 7;
  btFluidRayResult hit;
  hit.m_particle = 7;
  EXPECT_EQ(query.getVolume(bad, o), -1);
  EXPECT_EQ(query.getVolume({1, 0, 0}, o), -1);
  EXPECT_EQ(query.getVolume(nullptr, btTransform::getIdentity()), -1);
  btBoxShape box({1, 1, 1});
  EXPECT_EQ(query.getVolume(&box, btTransform(btQuaternion::getIdentity(), bad)), -1);
  EXPECT_FALSE(query.getLevel(bad, up, level) || query.getLevel(o, bad, level) ||
               query.getLevel(o, o, level));
  EXPECT_FALSE(query.rayTest(bad, o, hit) || query.rayTest(o, bad, hit) || query.rayTest(o, o, hit));
  EXPECT_EQ(level, 7);
  EXPECT_EQ(hit.m_particle, 7);
  EXPECT_EQ(query.getDensity(bad), 0);
  EXPECT_EQ(query.getVelocityAt(bad), o);
  EXPECT_FALSE(query.isWet(bad));
  EXPECT_EQ(query.findNearest(bad), -1);
  EXPECT_FALSE(query.isNodeWet(nullptr, 0));
  double s = 0;
  bool found = false;
  EXPECT_FALSE(query.getQuery().level(Vec3::Zero(), Vec3::UnitY(), nullptr, &found).ok());
  EXPECT_FALSE(query.getQuery().level(Vec3::Zero(), Vec3::UnitY(), &s, nullptr).ok());
  EXPECT_FALSE(query.getQuery().is_near(Vec3::Zero(), -1, &found).ok());
  EXPECT_FALSE(query.getQuery().is_near(Vec3::Zero(), 1, nullptr).ok());
  btFluid empty;
  const btFluidQuery nothing(empty);
  EXPECT_EQ(nothing.findNearest(o), -1);
  EXPECT_FALSE(nothing.getLevel(o, up, level));
}

TEST(NodeQuery, nodes_below_water_and_nodes_that_absorbed_are_wet) {
  Game game;
  btSoftBody* cloth = game.bullet.patch(11, 0.4, 0, 15);
  ASSERT_TRUE(game.solver.addCloth(cloth, bt(0.002)).ok());
  ASSERT_TRUE(game.water.addBox({bt(-0.05), bt(0.005), bt(-0.05)}, {bt(0.05), bt(0.045), bt(0.05)}).ok());
  game.run(30);
  const btFluidQuery query(game.water);
  int wet = 0;
  for (int i = 0; i < cloth->m_nodes.size(); ++i) {
    double least = 1;
    for (const Vec3& x : game.water.getWorld().positions())
      least = std::min(least, (x - to_vec3(cloth->m_nodes[i].m_x)).norm());
    EXPECT_EQ(query.isNodeWet(cloth, i), least <= 0.022) << i;
    wet += query.isNodeWet(cloth, i);
  }
  EXPECT_GT(wet, 4);
  EXPECT_LT(wet, 60);
  EXPECT_FALSE(query.isNodeWet(cloth, -1) || query.isNodeWet(cloth, cloth->m_nodes.size()));
  game.solver.removeCloth(cloth);
  EXPECT_FALSE(btFluidQuery(game.water).isNodeWet(cloth, 60));
}

}  // namespace
}  // namespace oilskin::bullet
