// Boundary terms: walls continue the water as its mirror image.
#include "fluid/boundary/boundary.h"

#include <gtest/gtest.h>

#include <cmath>

#include "fluid/boundary/visible_part.h"
#include "fluid/boundary/wall_integral.h"
#include "fluid/lattice.h"
#include "support/find_boundary.h"
#include "support/random.h"
#include "support/surface_of.h"

namespace oilskin::fluid {
namespace {

/// A lattice on a sheet, and what the boundary finds.
struct Layer {
  static constexpr double dx = 0.005, h = 2 * dx, mass = 1.25e-4;
  Workers workers;
  std::vector<Vec3> x;
  SurfaceMotion surface;
  Boundary boundary{2.0};

  Layer(const test::StaticMesh& mesh, double inverse_mass, int threads = 1)
      : workers(threads), surface(test::surface_of(mesh, inverse_mass)) {}
  void fill(int n, int layers, double first, const Vec3& corner = Vec3::Zero()) {
    for (int c = 0; c < n; ++c)
      for (int b = 0; b < layers; ++b)
        for (int a = 0; a < n; ++a)
          x.push_back(corner + Vec3((a + 0.5) * dx, first + b * dx, (c + 0.5) * dx));
  }
  void find() {
    SurfaceMotion* surfaces[] = {&surface};
    test::find_boundary(boundary, x, surfaces, {mass, h, Vec3(0, -1, 0)}, workers);
  }
};

test::StaticMesh plate(double size, std::uint32_t cells, double from = 0) {
  test::StaticMesh mesh;
  mesh.add_rectangle(Vec3(from, 0, from), Vec3(size, 0, 0), Vec3(0, 0, size), cells, cells);
  return mesh;
}

TEST(Boundary, a_lattice_on_a_sheet_lacks_nothing) {
  Layer water(plate(0.12, 14, -0.03), 0);
  water.fill(12, 4, Layer::dx / 2);
  water.find();
  EXPECT_EQ(water.boundary.points().size(), 144u) << "the first layer";
  for (const WallPoint& p : water.boundary.points()) {
    EXPECT_NEAR(p.lambda, lattice_mass_beyond<CubicSpline>(2), 2e-5);
    EXPECT_NEAR(p.gamma.y(), MirrorImage::settled_pull * 2 * lattice_pull_beyond<CubicSpline>(2), 2e-4)
        << "as much as the layer above of settled water";
    EXPECT_NEAR(p.gamma.x(), 0, 1e-5);
  }
}

TEST(Boundary, both_sides_are_alike_and_the_force_is_the_slope) {
  // A sheet of many small triangles that is bent a little: no shortcut for planes.
  test::StaticMesh mesh = plate(0.06, 12, -0.03);
  for (Vec3& n : mesh.nodes) n.y() = 1.5 * n.x() * n.x();
  for (double z : {0.001, 0.002, 0.0025, 0.004}) {
    const auto lambda_at = [&](double y) {
      Layer water(mesh, 0);
      water.x = {Vec3(0, y, 0)};
      water.find();
      return water.boundary.points().empty() ? WallPoint() : water.boundary.points()[0];
    };
    const double e = 1e-5;
    const WallPoint above = lambda_at(z), below = lambda_at(-z);
    EXPECT_NEAR(above.lambda, below.lambda, 0.04) << "the hollow side is nearer to more of the sheet";
    EXPECT_GT(above.gamma.y(), 0);
    EXPECT_LT(below.gamma.y(), 0);
    const double slope = static_cast<double>(lambda_at(z - e).lambda - lambda_at(z + e).lambda) / (2 * e);
    EXPECT_NEAR(above.gamma.y() / Layer::h, slope, 0.06 * slope + 2) << "z " << z;
  }
}

TEST(Boundary, ends_with_the_sheet) {
  const double z = 0.0025;
  float last = 1;
  for (double beyond : {-0.012, -0.005, 0.0, 0.003, 0.006, 0.012}) {
    Layer water(plate(0.06, 9, -0.06), 0);
    water.x = {Vec3(beyond, z, -0.03)};
    water.find();
    const float lambda = water.boundary.empty() ? 0 : water.boundary.points()[0].lambda;
    EXPECT_LE(lambda, last + 1e-6f) << beyond;
    if (beyond == 0.0) {
      EXPECT_NEAR(lambda, 0.5 * lattice_mass_beyond<CubicSpline>(2), 2e-3);
    }
    last = lambda;
  }
  EXPECT_EQ(last, 0);
}

/// What a single particle finds; a point without walls where there are none.
WallPoint point_at(const test::StaticMesh& mesh, const Vec3& x) {
  Layer water(mesh, 0);
  water.x = {x};
  water.find();
  return water.boundary.points().empty() ? WallPoint() : water.boundary.points()[0];
}

TEST(Boundary, the_top_of_a_box_ends_as_a_sheet_does_and_its_sides_do_not_count) {
  test::StaticMesh box, apart, top;
  box.nodes = {Vec3(0, 0, 0),    Vec3(0.1, 0, 0),    Vec3(0.1, 0, 0.1),    Vec3(0, 0, 0.1),
               Vec3(0, -0.1, 0), Vec3(0.1, -0.1, 0), Vec3(0.1, -0.1, 0.1), Vec3(0, -0.1, 0.1)};
  for (const auto& [a, b, c, d] : std::vector<std::array<std::uint32_t, 4>>{
           {0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}) {
    box.triangles.push_back({a, b, c});
    box.triangles.push_back({a, c, d});
  }
  apart.add_box({Vec3(0, -0.1, 0), Vec3(0.1, 0, 0.1)}, 0.1);  // its faces share no nodes
  top.add_rectangle(Vec3::Zero(), Vec3(0.1, 0, 0), Vec3(0, 0, 0.1));
  for (double z : {0.0011, 0.0025, 0.0044})
    for (double inwards : {0.0001, 0.0007, 0.002, 0.0046, 0.008}) {
      const Vec3 x(inwards, z, 0.052);
      const WallPoint sheet = point_at(top, x);
      for (const test::StaticMesh& mesh : {box, apart}) {
        const WallPoint found = point_at(mesh, x);
        EXPECT_NEAR(found.lambda, sheet.lambda, 1e-4) << inwards << " from the edge, " << z << " above";
        EXPECT_LT((found.gamma - sheet.gamma).norm(), 1e-3) << "no push to the side";
      }
    }
  EXPECT_EQ(point_at(box, Vec3(0.0007, 0.0062, 0.052)).lambda, 0) << "the top is out of reach, and hides";
}

// Triangles beyond triangle_reach are left out: a sheet of tiny ones misses none of its effect, and nothing
// jumps where its border comes within reach.
TEST(Boundary, what_is_far_away_does_not_count) {
  for (const double z : {0.1, 0.25, 0.4}) {
    const float whole = MirrorImage(2.0).lambda(static_cast<float>(z), 1);
    float last = whole;
    for (double border = 1.02; border > 0.3; border -= 0.02) {
      test::StaticMesh sheet;  // triangles of 0.08 H, and a hidden one, so that it is not taken for one plane
      sheet.add_rectangle(Layer::h * Vec3(-border, 0, -1.2), Layer::h * Vec3(2, 0, 0),
                          Layer::h * Vec3(0, 0, 2.4), 25, 30);
      sheet.add_rectangle(Layer::h * Vec3(0, -0.05, 0), Layer::h * Vec3(0.05, 0, 0),
                          Layer::h * Vec3(0, 0, 0.05));
      const float lambda = point_at(sheet, Layer::h * Vec3(0, z, 0)).lambda;
      EXPECT_NEAR(lambda, last, 0.02f * whole) << "z " << z << ", border " << border;
      if (border > 0.84) {
        EXPECT_NEAR(lambda, whole, 1e-3f * whole) << "z " << z << ", border " << border;
      }
      last = lambda;
    }
    EXPECT_LT(last, 0.99f * whole) << "the border is seen";
  }
}

TEST(Boundary, walls_change_without_a_jump_around_an_edge) {
  test::StaticMesh step;
  step.add_rectangle(Vec3(0, 0, -0.05), Vec3(0.05, 0, 0), Vec3(0, 0, 0.1));
  step.add_rectangle(Vec3(0, -0.05, -0.05), Vec3(0, 0.05, 0), Vec3(0, 0, 0.1));
  float last = -1;
  for (int k = 30; k <= 240; ++k) {  // from above the top around the edge to beside the side
    const double phi = k * pi / 180, r = 0.003;
    const float lambda = point_at(step, r * Vec3(std::cos(phi), std::sin(phi), 0)).lambda;
    if (last >= 0) {
      EXPECT_NEAR(lambda, last, 0.02) << k << " degrees";
    }
    last = lambda;
  }
}

TEST(Boundary, layers_behind_a_layer_do_not_count) {
  test::StaticMesh mesh = plate(0.06, 7, -0.03);
  for (int layer = 1; layer <= 3; ++layer)
    mesh.add_rectangle(Vec3(-0.03, -0.0005 * layer, -0.03), Vec3(0.06, 0, 0), Vec3(0, 0, 0.06), 5, 5);
  Layer water(mesh, 0);
  water.fill(4, 1, Layer::dx / 2, Vec3(-0.01, 0, -0.01));
  water.find();
  ASSERT_EQ(water.boundary.points().size(), 16u);
  for (const WallPoint& p : water.boundary.points())
    EXPECT_NEAR(p.lambda, lattice_mass_beyond<CubicSpline>(2), 2e-3);
}

TEST(Boundary, sheets_that_lie_on_each_other_count_once) {
  test::StaticMesh mesh = plate(0.06, 7, -0.03);
  const std::vector<Triangle> once = mesh.triangles;
  for (const Triangle& t : once) mesh.triangles.push_back({t[1], t[0], t[2]});
  Layer doubled(mesh, 0);
  doubled.fill(4, 1, Layer::dx / 2, Vec3(-0.01, 0, -0.01));
  doubled.find();
  ASSERT_EQ(doubled.boundary.points().size(), 16u);
  for (const WallPoint& p : doubled.boundary.points())
    EXPECT_NEAR(p.lambda, lattice_mass_beyond<CubicSpline>(2), 2e-4);

  Layer twice(plate(0.06, 7, -0.03), 0);
  twice.fill(4, 1, Layer::dx / 2, Vec3(-0.01, 0, -0.01));
  SurfaceMotion other = test::surface_of(plate(0.06, 7, -0.03), 0, 2);
  SurfaceMotion* surfaces[] = {&twice.surface, &other};
  test::find_boundary(twice.boundary, twice.x, surfaces, {Layer::mass, Layer::h}, twice.workers);
  ASSERT_EQ(twice.boundary.points().size(), 16u);
  for (const WallPoint& p : twice.boundary.points())
    EXPECT_NEAR(p.lambda, lattice_mass_beyond<CubicSpline>(2), 5e-3);
}

TEST(Boundary, what_particles_get_nodes_lose) {
  for (double inverse_mass : {0.0, 2e4}) {
    test::StaticMesh mesh = plate(0.06, 7);
    test::Random random(4);
    for (Vec3& n : mesh.nodes) n.y() += 0.002 * random.uniform();
    Layer water(mesh, inverse_mass);
    water.fill(12, 2, 0.004);
    water.find();
    std::vector<WallLoad<double>> load;
    for (std::size_t k = 0; k < water.boundary.points().size(); ++k)
      load.push_back({random.uniform(), random.uniform()});
    std::vector<Vec3> dv(water.x.size(), Vec3::Zero());
    water.boundary.apply_load(load, {}, dv, water.workers);
    Vec3 given = Vec3::Zero(), taken = Vec3::Zero(), nodes = Vec3::Zero();
    for (const Vec3& v : dv) given += Layer::mass * v;
    for (const Vec3& j : water.surface.impulse) taken += j;
    EXPECT_GT(given.y(), 0);
    EXPECT_LT((given + taken).norm(), 1e-14 * given.norm());
    for (const Vec3& v : water.surface.velocity) nodes += v;
    if (inverse_mass == 0) {
      EXPECT_TRUE(nodes.isZero(0));
    } else {
      EXPECT_LT((nodes / inverse_mass - taken).norm(), 1e-12 * taken.norm());
    }
  }
}

TEST(Boundary, a_floor_carries_what_the_water_down_to_it_weighs_and_a_ceiling_does_not) {
  for (const double side : {1.0, -1.0}) {
    Layer water(plate(0.12, 14, -0.03), 0);
    water.fill(12, 1, side * 0.4 * Layer::dx);
    water.find();
    ASSERT_EQ(water.boundary.points().size(), 144u);
    for (const WallPoint& p : water.boundary.points()) {
      const float depth = static_cast<float>(side * 0.4 * Layer::dx / Layer::h);
      EXPECT_NEAR(p.depth_gamma.y(), depth * p.gamma.y(), 1e-6f);
      EXPECT_GT(p.depth_gamma.y(), 0.1f) << "upwards: a floor pushes more, a ceiling less";
      EXPECT_NEAR(p.max_depth, std::abs(depth), 1e-6f);
    }
    std::vector<Vec3> dv(water.x.size(), Vec3::Zero());
    water.boundary.apply_load({water.boundary.points().size(), {0.5, 2}}, {}, dv, water.workers);
    for (const WallPoint& p : water.boundary.points())
      EXPECT_LT((dv[p.particle] - p.velocity_change({0.5f, 2}).cast<double>()).norm(), 1e-6);
  }
}

TEST(Boundary, light_walls_yield_and_heavy_ones_keep_their_motion) {
  test::StaticMesh mesh = plate(0.12, 14, -0.03);
  for (double inverse_mass : {0.0, 6e4}) {
    Layer water(mesh, inverse_mass);
    for (Vec3& x : water.surface.x_t1) x.y() += 2e-4;  // 0.2 m/s upwards
    water.fill(12, 1, Layer::dx / 2);
    water.find();
    const std::vector<float> still = water.boundary.normal_flux();
    water.boundary.compliance().predict_wall_velocity(std::vector<float>(still.size(), 0.01f), {},
                                                      water.workers);
    for (std::size_t k = 0; k < still.size(); ++k) {
      const WallPoint& p = water.boundary.points()[k];
      EXPECT_NEAR(still[k], 0.2f * p.gamma.y(), 1e-4f);
      const float fallen = (still[k] - water.boundary.normal_flux()[k]) / 0.01f;
      EXPECT_NEAR(fallen, water.boundary.compliance().row_sums()[k], 1e-3f * fallen + 1e-3f);
      if (inverse_mass > 0) {
        EXPECT_GT(fallen, 1);
      }
    }
  }
}

/// The distance of a guess from the solution of A x = b over the distance of 0, in the norm of A.
double relative_error(const Eigen::MatrixXd& a, const Eigen::VectorXd& b, const Eigen::VectorXd& guess) {
  const Eigen::VectorXd x = a.ldlt().solve(b), error = guess - x;
  return std::sqrt(error.dot(a * error) / x.dot(a * x));
}

TEST(Boundary, the_response_of_light_walls_is_solved_for) {
  test::StaticMesh mesh = plate(0.12, 14, -0.03);
  constexpr float scale = 0.3f;
  for (double inverse_mass : {0.0, 1e3, 6e4, 1e9}) {
    Layer water(mesh, inverse_mass);
    water.fill(12, 1, Layer::dx / 2);
    water.find();
    const auto n = static_cast<Eigen::Index>(water.boundary.points().size());
    ASSERT_EQ(n, 144);
    Eigen::MatrixXd a(n, n);
    const std::vector<float> still = water.boundary.normal_flux();
    for (Eigen::Index l = 0; l < n; ++l) {
      std::vector<float> theta(static_cast<std::size_t>(n), 0);
      theta[static_cast<std::size_t>(l)] = 1;
      water.boundary.compliance().predict_wall_velocity(theta, {}, water.workers);
      for (Eigen::Index k = 0; k < n; ++k) {
        const auto at = static_cast<std::size_t>(k);
        a(k, l) = scale * (still[at] - water.boundary.normal_flux()[at]);
      }
    }
    test::Random random(17);
    std::vector<float> step, change;
    Eigen::VectorXd residual(n);
    for (Eigen::Index k = 0; k < n; ++k) {
      step.push_back(k % 5 == 0 ? 0.0f : 0.1f + 0.3f * static_cast<float>(random.uniform()));
      change.push_back(static_cast<float>(random.uniform() - 0.3));
      residual[k] = static_cast<double>(change.back());
    }
    water.boundary.compliance().solve(scale, step, change, water.workers);
    // Where the step is 0 the pressure stays, and the others do not count on it.
    std::vector<Eigen::Index> moved;
    Eigen::VectorXd solved(n), by_row_sums(n);
    for (Eigen::Index k = 0; k < n; ++k) {
      const auto at = static_cast<std::size_t>(k);
      solved[k] = static_cast<double>(change[at]);
      if (step[at] > 0) {
        const double stiffness = 1 / static_cast<double>(step[at]);
        moved.push_back(k);
        a(k, k) += stiffness;
        by_row_sums[k] =
            residual[k] /
            (stiffness + static_cast<double>(scale * water.boundary.compliance().row_sums()[at]));
      } else {
        EXPECT_EQ(solved[k], 0);
      }
    }
    const double error = relative_error(a(moved, moved), residual(moved), solved(moved)),
                 without = relative_error(a(moved, moved), residual(moved), by_row_sums(moved));
    if (inverse_mass == 0) {
      EXPECT_LT(error, 1e-6) << "the step is all there is to do";
    } else if (inverse_mass < 1e8) {
      EXPECT_LT(error, 0.3) << inverse_mass;
    } else {
      EXPECT_LT(error, 1) << "what is too stiff is approached";
    }
    EXPECT_LE(error, without + 1e-6) << "as row sums would do";
  }
}

TEST(Boundary, does_not_depend_on_threads) {
  std::vector<float> lambda[2], row_sums[2], change[2];
  for (int threads : {1, 2}) {
    test::StaticMesh mesh = plate(0.1, 17);
    test::Random random(8);
    for (Vec3& n : mesh.nodes) n.y() += 0.003 * random.uniform();
    Layer water(mesh, 1e4, threads);
    for (int i = 0; i < 4000; ++i)
      water.x.push_back(Vec3(0.1 * random.uniform(), 0.03 * random.uniform() - 0.01, 0.1 * random.uniform()));
    water.find();
    for (const WallPoint& p : water.boundary.points()) lambda[threads - 1].push_back(p.lambda);
    row_sums[threads - 1] = water.boundary.compliance().row_sums();
    change[threads - 1] = lambda[threads - 1];
    water.boundary.compliance().solve(0.3f, std::vector<float>(change[0].size(), 0.2f), change[threads - 1],
                                      water.workers);
  }
  EXPECT_GT(lambda[0].size(), 1000u);
  EXPECT_EQ(lambda[0], lambda[1]);
  EXPECT_EQ(row_sums[0], row_sums[1]);
  EXPECT_EQ(change[0], change[1]);
  EXPECT_NE(change[0], lambda[0]);
}

}  // namespace
}  // namespace oilskin::fluid
