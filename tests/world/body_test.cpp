// Dynamic rigid bodies in whole worlds: momentum, determinism, saved state, and that they float.
#include <gtest/gtest.h>

#include "support/mock_body.h"
#include "support/static_mesh.h"
#include "support/world_helpers.h"

namespace oilskin {
namespace {

using test::MockBody;

struct Case {
  const char* name;
  PressureSolver solver;
  BoundaryModel boundary;
  int max_substeps;
};
void PrintTo(const Case& c, std::ostream* out) {
  *out << c.name;
}

FluidSettings fluid_of(const Case& c, double spacing = 0.01) {
  FluidSettings fluid;
  fluid.spacing = spacing;
  fluid.solver = c.solver;
  fluid.boundary = c.boundary;
  fluid.max_substeps = c.max_substeps;
  return fluid;
}

WorldSettings small_world(int threads = 1) {
  WorldSettings s;
  s.kill_box = {Vec3::Constant(-2), Vec3::Constant(2)};
  s.threads = threads;
  return s;
}

ContactSettings verified() {
  ContactSettings s;
  s.verify = true;
  return s;
}

class BodyInWater : public ::testing::TestWithParam<Case> {};

/// Without gravity: a block of water hits a tumbling box.
TEST_P(BodyInWater, keeps_momentum_and_nothing_crosses) {
  WorldSettings settings = small_world();
  settings.gravity.setZero();
  World w(settings, fluid_of(GetParam()), verified());
  MockBody body;
  body.mass = 0.2;
  body.rotation = Eigen::AngleAxisd(0.4, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  body.spin = Vec3(3, -2, 5);
  SurfaceId id;
  ASSERT_TRUE(w.attach(body, test::sheet_settings(), &id).ok());
  test::add_block(w, 8, Vec3(-0.02, 0.1, -0.03), Vec3(0.2, -2, 0.1));
  const Vec3 start = test::fluid_momentum(w) + body.momentum();
  for (int k = 0; k < 60; ++k) {
    const StepReport& r = w.step(4e-3);
    ASSERT_TRUE(r.status.ok()) << r.status.message;
    ASSERT_EQ(r.contact.crossings_found_by_verify, 0u) << "step " << k;
    EXPECT_LE(r.momentum_residual().norm(), 1e-12 * start.norm()) << "step " << k;
  }
  EXPECT_GT(body.momentum().norm(), 0.05 * start.norm()) << "it was not hit";
  EXPECT_LE((test::fluid_momentum(w) + body.momentum() - start).norm(), 1e-12 * start.norm());
}

INSTANTIATE_TEST_SUITE_P(
    Modes, BodyInWater,
    ::testing::Values(Case{"dfsph", PressureSolver::dfsph, BoundaryModel::mirrored, 1},
                      Case{"dfsph_substeps", PressureSolver::dfsph, BoundaryModel::mirrored, 8},
                      Case{"pcisph", PressureSolver::pcisph, BoundaryModel::mirrored, 4},
                      Case{"contact", PressureSolver::dfsph, BoundaryModel::contact_only, 1}),
    ::testing::PrintToStringParamName());

/// A tank of water, 0.2 m wide, with a box of 8 × 6 × 8 spacings half in it.
class Tank {
 public:
  explicit Tank(int threads = 1, double density = 500)
      : world(small_world(threads), fluid_of({"", PressureSolver::dfsph, BoundaryModel::mirrored, 4}),
              verified()) {
    walls_.add_rectangle(Vec3(-0.1, 0, -0.1), Vec3(0.2, 0, 0), Vec3(0, 0, 0.2), 4, 4);
    for (double at : {-0.1, 0.1}) {
      walls_.add_rectangle(Vec3(at, 0, -0.1), Vec3(0, 0.3, 0), Vec3(0, 0, 0.2), 4, 4);
      walls_.add_rectangle(Vec3(-0.1, 0, at), Vec3(0, 0.3, 0), Vec3(0.2, 0, 0), 4, 4);
    }
    body.half = Vec3(0.04, 0.03, 0.04);
    body.mass = density * 8 * body.half.prod();
    body.center = Vec3(0, 0.1, 0);
    body.gravity = world.settings().gravity;
    EXPECT_TRUE(world.attach(walls_, test::sheet_settings(), &walls_id_).ok());
    EXPECT_TRUE(world.attach(body, test::sheet_settings(), &id).ok());
    std::vector<Vec3> x;
    for (int i = 0; i < 20; ++i)
      for (int j = 0; j < 10; ++j)
        for (int k = 0; k < 20; ++k) {
          const Vec3 at = Vec3(-0.095, 0.005, -0.095) + 0.01 * Vec3(i, j, k);
          if (((at - body.center).cwiseAbs() - body.half).maxCoeff() > 0.004) x.push_back(at);
        }
    EXPECT_TRUE(world.add_particles(x, std::vector<Vec3>(x.size(), Vec3::Zero())).ok());
    water_ = static_cast<double>(x.size()) * 1e-6;
  }

  void run(double seconds) {
    for (const double end = world.time() + seconds; world.time() < end - 1e-9;) {
      const StepReport& r = world.step(0.005);
      ASSERT_TRUE(r.status.ok()) << r.status.message;
      ASSERT_EQ(r.contact.crossings_found_by_verify, 0u);
    }
  }
  /// Of the bottom of the box below the surface of the water [m].
  double draught() const {
    const double level = (water_ + body.mass / 1000) / (0.2 * 0.2);
    return level - (body.center.y() - body.half.y());
  }

  World world;
  MockBody body;
  SurfaceId id;

 private:
  test::StaticMesh walls_;
  SurfaceId walls_id_;
  double water_ = 0;  // [m³]
};

TEST(FloatingBody, has_the_draught_of_archimedes_and_stays_calm) {
  for (double density : {300., 700.}) {
    Tank tank(1, density);
    tank.run(0.8);
    double draught = 0, speed = 0;
    for (int k = 0; k < 40; ++k) {
      tank.run(0.005);
      draught += tank.draught() / 40;
      speed = std::max(speed, (tank.body.velocity + 0.005 * tank.body.gravity).norm());
    }
    EXPECT_NEAR(draught, density / 1000 * 0.06, 0.4 * 0.01) << density;
    EXPECT_LT(speed, 0.1) << density;
    EXPECT_GT(tank.body.rotation(1, 1), 0.99) << "it lies flat";
    EXPECT_EQ(tank.world.report().removed, 0u);
  }
}

TEST(FloatingBody, moves_alike_on_any_number_of_threads_and_after_restore) {
  Tank one(1), three(3);
  one.run(0.1);
  three.run(0.1);
  ASSERT_EQ(one.world.state_hash(), three.world.state_hash());
  EXPECT_EQ(one.body.center, three.body.center);

  std::vector<std::uint8_t> saved;
  ASSERT_TRUE(one.world.save(&saved).ok());
  const MockBody body = one.body;
  one.run(0.1);
  const std::uint64_t first = one.world.state_hash();
  one.body = body;
  ASSERT_TRUE(one.world.restore(saved).ok());
  one.run(0.1);
  EXPECT_EQ(one.world.state_hash(), first);
  three.run(0.1);
  EXPECT_EQ(three.world.state_hash(), first);
}

}  // namespace
}  // namespace oilskin
