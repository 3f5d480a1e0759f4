// Nothing acts through a surface: which pairs of neighbours stay (F.8).
#include "fluid/occlusion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "fluid/fluid_solver.h"
#include "support/random.h"
#include "support/surface_of.h"

namespace oilskin::fluid {
namespace {

using Pairs = std::set<std::pair<std::uint32_t, std::uint32_t>>;

struct Cloud {
  std::vector<Vec3> x;
  Neighbours neighbours;
  Workers workers;
  explicit Cloud(int threads = 1) : workers(threads) {}

  /// Puts the points into cell order and lists them.
  void search(double support_radius) {
    const auto& order = neighbours.cell_order(x, support_radius, workers);
    std::vector<Vec3> sorted;
    for (std::uint32_t i : order) sorted.push_back(x[i]);
    x = sorted;
    neighbours.search(x, workers);
  }
  Pairs pairs() const {
    Pairs p;
    for (std::uint32_t i = 0; i < x.size(); ++i)
      for (std::uint32_t k = 0; k < neighbours.count(i); ++k) p.insert({i, neighbours.list(i)[k]});
    return p;
  }
};

test::StaticMesh bumpy_sheet(int n, double size, double bump, unsigned seed) {
  test::StaticMesh mesh;
  mesh.add_rectangle(Vec3(0, 0, 0), Vec3(size, 0, 0), Vec3(0, 0, size), n, n);
  test::Random random(seed);
  for (Vec3& x : mesh.nodes) x.y() += bump * (random.uniform() - 0.5);
  return mesh;
}

/// An independent test: the intersection of the line with the plane, in long double. `margin` is the distance
/// from a change of the result, in units of the triangle.
bool meets(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c, double* margin) {
  using L3 = Eigen::Matrix<long double, 3, 1>;
  const L3 e1 = (b - a).cast<long double>(), e2 = (c - a).cast<long double>();
  const L3 d = (q - p).cast<long double>(), s = (p - a).cast<long double>();
  const L3 h = d.cross(e2);
  const long double det = e1.dot(h);
  if (det == 0) return false;
  const L3 w = s.cross(e1);
  const long double u = s.dot(h) / det, v = d.dot(w) / det, t = e2.dot(w) / det;
  const long double inside = std::min({u, v, 1 - u - v, t, 1 - t});
  *margin = std::min(*margin, static_cast<double>(std::abs(inside)));
  return inside >= 0;
}

TEST(Occlusion, hides_exactly_the_pairs_that_a_sheet_parts) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const test::StaticMesh mesh = bumpy_sheet(6, 0.06, 0.012, seed);
    SurfaceMotion surface = test::surface_of(mesh);
    Cloud cloud;
    test::Random random(100 + seed);
    for (int i = 0; i < 600; ++i)
      cloud.x.push_back(Vec3(0.08 * random.uniform() - 0.01, 0.04 * (random.uniform() - 0.5),
                             0.08 * random.uniform() - 0.01));
    cloud.search(0.01);
    const Pairs before = cloud.pairs();
    Pairs expected;
    double margin = 1;
    for (const auto& [i, j] : before) {
      bool hidden = false;
      for (const Triangle& t : surface.triangles)
        hidden |=
            meets(cloud.x[i], cloud.x[j], mesh.nodes[t[0]], mesh.nodes[t[1]], mesh.nodes[t[2]], &margin);
      if (!hidden) expected.insert({i, j});
    }
    ASSERT_GT(margin, 1e-12) << "a pair of this seed is undecided";
    SurfaceMotion* surfaces[] = {&surface};
    const MeshTopology topology(surface.triangles, surface.x_t0.size());
    const MeshTopology* topologies[] = {&topology};
    TriangleCells cells;
    cells.find(cloud.x, surfaces, topologies, {}, 0.01, cloud.neighbours, cloud.workers);
    const std::uint64_t hidden =
        remove_hidden_neighbours(cloud.x, surfaces, cells, 0.01, cloud.neighbours, cloud.workers);
    EXPECT_EQ(cloud.pairs(), expected) << "seed " << seed;
    EXPECT_EQ(2 * hidden, before.size() - expected.size());
    EXPECT_GT(hidden, 30u);
    for (std::uint32_t i = 0; i < cloud.x.size(); ++i)  // padding still points to the record far away
      for (std::uint32_t k = cloud.neighbours.count(i); k < (cloud.neighbours.count(i) + 7) / 8 * 8; ++k)
        EXPECT_EQ(cloud.neighbours.list(i)[k], cloud.x.size());
  }
}

TEST(Occlusion, is_watertight_at_edges_and_corners) {
  const test::StaticMesh mesh = bumpy_sheet(4, 0.04, 0.004, 7);  // flat enough that nothing overhangs
  const SurfaceMotion surface = test::surface_of(mesh);
  test::Random random(3);
  const auto blocked = [&](const Vec3& p, const Vec3& q) {
    for (std::uint32_t t = 0; t < surface.triangles.size(); ++t) {
      const SightTest test(surface, t);
      if (test.blocks(p, q, test.side(p), test.side(q))) return true;
    }
    return false;
  };
  int aimed = 0;
  for (const Triangle& t : surface.triangles)
    for (int k = 0; k < 3; ++k) {
      const Vec3 &a = mesh.nodes[t[static_cast<std::size_t>(k)]],
                 &b = mesh.nodes[t[static_cast<std::size_t>((k + 1) % 3)]];
      // Inner edges only: at the border a line may pass on either side of the edge.
      const auto inner = [](double s) { return s > 0.005 && s < 0.035; };
      for (double s : {0.0, 0.5, random.uniform()}) {
        const Vec3 at = a + s * (b - a);
        if (!inner(at.x()) || !inner(at.z())) continue;
        const Vec3 offset(0.002 * random.uniform(), 0.02, 0.002 * random.uniform());
        EXPECT_TRUE(blocked(at + offset, at - offset));
        ++aimed;
      }
    }
  EXPECT_GT(aimed, 50);
}

/// Through the middle vertex of a fan, whatever rounding makes of the volumes over its edges.
TEST(Occlusion, no_line_slips_through_a_vertex) {
  test::Random random(5);
  for (int round = 0; round < 5000; ++round) {
    const std::uint32_t n = 3 + random.below(6);
    SurfaceMotion fan;
    fan.x_t0 = {random.in_cube(1)};
    for (std::uint32_t k = 0; k < n; ++k) {
      const double angle = 2 * M_PI * k / n;
      fan.x_t0.push_back(fan.x_t0[0] + Vec3(std::cos(angle), std::sin(angle), random.uniform(-0.3, 0.3)));
      fan.triangles.push_back({0, 1 + k, 1 + (k + 1) % n});
    }
    const Vec3 along(random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3), 1);
    const Vec3 p = fan.x_t0[0] - along, q = fan.x_t0[0] + along;
    bool blocked = false;
    for (std::uint32_t t = 0; t < n; ++t) {
      const SightTest test(fan, t);
      blocked |= test.blocks(p, q, test.side(p), test.side(q));
    }
    ASSERT_TRUE(blocked) << "round " << round;
  }
}

TEST(Occlusion, decides_in_the_plane_of_a_sheet) {
  test::StaticMesh mesh;
  mesh.add_rectangle(Vec3(0, 0, 0), Vec3(0.01, 0, 0), Vec3(0, 0, 0.01));
  const SurfaceMotion surface = test::surface_of(mesh);
  const auto blocked = [&](const Vec3& p, const Vec3& q) {
    bool any = false;
    for (std::uint32_t t = 0; t < 2; ++t) {
      const SightTest test(surface, t);
      EXPECT_EQ(test.side(p), 0);
      any |= test.blocks(p, q, test.side(p), test.side(q));
    }
    return any;
  };
  EXPECT_FALSE(blocked(Vec3(-0.002, 0, 0.001), Vec3(-0.002, 0, 0.009))) << "beside the border";
  EXPECT_FALSE(blocked(Vec3(-0.002, 0, 0.009), Vec3(0.001, 0, 0.0125))) << "across a corner";
  EXPECT_TRUE(blocked(Vec3(-0.002, 0, 0.005), Vec3(0.012, 0, 0.005))) << "the sheet edge-on between them";
}

TEST(Occlusion, keeps_momentum_and_bits) {
  Vec3 sum[2];
  std::vector<Vec3> velocity[2];
  for (int threads : {1, 2}) {
    const test::StaticMesh mesh = bumpy_sheet(10, 0.06, 0.006, 2);
    SurfaceMotion surface = test::surface_of(mesh);
    SurfaceMotion* surfaces[] = {&surface};
    const MeshTopology topology(surface.triangles, surface.x_t0.size());
    const MeshTopology* topologies[] = {&topology};
    FluidSettings settings;
    settings.xsph_rate = 50;
    settings.boundary = BoundaryModel::contact_only;
    settings.viscosity = 1e-4;
    FluidSolver solver(settings, std::make_shared<Workers>(threads));
    Particles particles;
    test::Random random(11);
    for (int i = 0; i < 3000; ++i)
      particles.push_back(
          static_cast<std::uint64_t>(i + 1),
          Vec3(0.06 * random.uniform(), 0.05 * (random.uniform() - 0.5), 0.06 * random.uniform()),
          Vec3(random.uniform(), random.uniform(), random.uniform()), 1000);
    StageSeconds seconds;
    FluidReport report;
    solver.prepare(particles, seconds);
    solver.apply_surfaces(1e-3, 1e-3, Vec3::Zero(), particles, surfaces, topologies, {}, seconds);
    Vec3 before = Vec3::Zero();
    for (const Vec3& v : particles.velocity) before += v;
    solver.propose(1e-3, Vec3::Zero(), particles, {}, {}, particles.velocity, report, seconds);
    EXPECT_GT(report.hidden_pairs, 1000u);
    Vec3& after = sum[threads - 1];
    after.setZero();
    for (const Vec3& v : particles.velocity) after += v;
    EXPECT_LT((after - before).norm(), 1e-11 * before.norm());
    velocity[threads - 1] = particles.velocity;
  }
  EXPECT_EQ(velocity[0], velocity[1]);
}

}  // namespace
}  // namespace oilskin::fluid
