// Transport of absorbed liquid: ledger, bounds, any step, bad meshes, bad input, the solver.
#include <Eigen/LU>
#include <numeric>

#include "effects/wetting_sheet.h"
#include "support/record.h"

namespace oilskin {
namespace {

using namespace test;

const Vec3 down(0, -9.81, 0);

/// Irregular cotton with a warp at 20°, some of it dry and some above capacity.
WettingSheet wild_sheet(std::size_t cells, std::uint64_t seed, const Fabric& fabric) {
  WettingSheet s = wetting_grid(cells, cells, 5e-3, 5e-3);
  jitter(s, 5e-3, 0.35, seed);
  s.make(fabric);
  Random random(seed);
  for (std::size_t i = 0; i < s.x.size(); ++i)
    if (random.uniform() < 0.5) s.set_saturation(i, random.uniform(0, 1.5));
  return s;
}

Fabric oblique(Fabric f, double exponent) {
  f.anisotropy = 4;
  f.saturation_limit = 1;
  f.warp = Vec3(std::cos(0.35), std::sin(0.35), 0);
  f.mobility_exponent = exponent;
  return f;
}

// 1e-4 s to 1e6 s, and one sheet after the other within.
TEST(WettingBounds, hold_at_any_time_step) {
  for (const double a : {0.0, 0.5, 1.0, 2.0, 3.0})
    for (const double dt : {1e-4, 1e-2, 1.0, 1e3, 1e6}) {
      WettingSheet s = wild_sheet(12, 5, oblique(cotton_fabric(), a));
      const double total = s.total();
      double highest = std::max(1.0, s.highest());
      for (int k = 0; k < 12; ++k) {
        s.step(dt, down);
        EXPECT_GE(s.lowest(), 0) << a << ", " << dt;
        EXPECT_LE(s.highest(), highest * (1 + 1e-12)) << a << ", " << dt;
        highest = std::max(1.0, s.highest());
      }
      EXPECT_NEAR(s.total() / total, 1, 1e-14) << a << ", " << dt;
    }
}

TEST(WettingBounds, the_sum_of_liquid_stays_for_1e5_steps) {
  WettingSheet s = wild_sheet(4, 2, oblique(cotton_fabric(), 2));
  const double total = s.total();
  for (int k = 0; k < 100000; ++k) s.step(k % 2 == 0 ? 1e-3 : 3e-2, k % 1000 < 500 ? down : -down);
  const double error = std::abs(s.total() / total - 1);
  record("error", error);
  EXPECT_LT(error, 1e-12);
}

TEST(WettingBounds, what_a_reservoir_gives_is_counted) {
  WettingSheet s = wetting_grid(20, 4, 5e-3, 5e-3);
  jitter(s, 5e-3, 0.35, 9);
  s.make(oblique(cotton_fabric(), 2));
  s.hold_left();
  const double total = s.total();
  for (int k = 0; k < 3000; ++k) s.step(0.5, Vec3(-9.81, 0, 0));
  EXPECT_GT(s.supplied, total);
  EXPECT_NEAR((total + s.supplied) / s.total(), 1, 1e-12);
  for (const std::uint32_t i : s.held) EXPECT_EQ(s.saturation(i), 1);
}

// A longer step of the same scheme must not change what becomes of the liquid in the end.
TEST(WettingBounds, a_thousand_times_longer_step_has_the_same_end) {
  WettingSheet a = wild_sheet(8, 7, oblique(cotton_fabric(), 1)),
               b = wild_sheet(8, 7, oblique(cotton_fabric(), 1));
  for (int k = 0; k < 4000; ++k) a.step(1, Vec3::Zero());
  for (int k = 0; k < 40; ++k) b.step(1000, Vec3::Zero());
  for (std::size_t i = 0; i < a.x.size(); ++i) {
    EXPECT_NEAR(a.saturation(i), a.total() / 0.3 / 0.0016, 0.002);
    EXPECT_NEAR(b.saturation(i), a.saturation(i), 0.002);
  }
}

// With the bounds 0 and the limit in place of those of (W.14), S would stay between 0.25 and 0.78 here.
TEST(WettingBounds, long_steps_even_out_on_any_mesh) {
  for (const double a : {0.0, 1.0, 2.0}) {
    WettingSheet s = wild_sheet(20, 3, oblique(plain_fabric(1e-5, 1), a));
    for (int k = 0; k < 10; ++k) s.step(1e6);
    EXPECT_GT(s.lowest(), s.highest() - 0.005) << a;
  }
}

// Liquid above capacity flows to neighbours that have space.
TEST(WettingBounds, an_excess_flows_out) {
  WettingSheet s = wetting_grid(10, 10, 5e-3, 5e-3);
  s.make(plain_fabric(1e-5, 2));
  for (std::size_t i = 0; i < s.x.size(); ++i) s.set_saturation(i, 0.5);
  s.set_saturation(60, 4);
  for (int k = 0; k < 400; ++k) {
    const double highest = s.highest();
    s.step(1);
    EXPECT_LE(s.highest(), std::max(1.0, highest) * (1 + 1e-12)) << k;
  }
  EXPECT_LT(s.highest(), 1);
}

// Also where the neighbours are full: as a film, which takes its time.
TEST(WettingBounds, an_excess_on_full_textile_spreads_from_place_to_place) {
  WettingSheet s = wetting_grid(20, 20, 5e-3, 5e-3);
  s.make(plain_fabric(1e-5, 1));
  const std::size_t middle = 10 * 21 + 10;
  for (std::size_t i = 0; i < s.x.size(); ++i)
    s.set_saturation(i, (s.x[i] - s.x[middle]).norm() < 0.021 ? 1 : 0.5);
  s.set_saturation(middle, 3);
  for (int k = 0; k < 10; ++k) s.step(0.01);
  EXPECT_LT(s.saturation(middle), 2.99);
  EXPECT_GT(s.saturation(middle + 1), 1.001);
  EXPECT_NEAR(s.saturation(0), 0.5, 1e-12);
}

// With a limit above 1 a film gathers at the foot of a wet sheet; without it the sheet stays as it is.
TEST(WettingBounds, the_limit_decides_whether_a_film_gathers) {
  for (const double limit : {1.0, 1.2}) {
    Fabric f = plain_fabric(1e-5, 2, 0.05);
    f.saturation_limit = limit;
    WettingSheet s = wetting_grid(10, 10, 5e-3, 5e-3);
    s.make(f);
    for (std::size_t i = 0; i < s.x.size(); ++i) s.set_saturation(i, 1);
    for (int k = 0; k < 200; ++k) s.step(1, down);
    EXPECT_NEAR(s.highest(), limit, 1e-9);
    EXPECT_NEAR(s.saturation(5), limit, 1e-9) << "the foot";
    EXPECT_EQ(s.lowest() < 1 - 1e-9, limit > 1);
  }
}

TEST(WettingBounds, dry_textile_stays_dry) {
  WettingSheet s = wetting_grid(3, 3, 0.01, 0.01);
  s.make(cotton_fabric());
  s.step(1, down);
  EXPECT_EQ(s.total(), 0);
}

TEST(WettingBounds, degenerate_meshes_keep_their_liquid) {
  WettingSheet s = wetting_grid(2, 2, 0.01, 0.01);
  const auto n = static_cast<std::uint32_t>(s.x.size());
  s.x.insert(s.x.end(), {Vec3(1, 0, 0), Vec3(1.01, 0, 0), Vec3(1, 0.01, 0)});  // another part
  s.x.insert(s.x.end(), {Vec3(2, 0, 0), Vec3(2, 1, 0), Vec3(2, 2, 0)});        // on a line
  s.x.emplace_back(3, 0, 0);                                                   // of no triangle
  s.triangles.push_back({n, n + 1, n + 2});
  s.triangles.push_back({n + 3, n + 4, n + 5});
  s.triangles.push_back({0, 0, 1});
  s.triangles.push_back({s.triangles[0][1], s.triangles[0][0], s.triangles[0][2]});  // a duplicate
  s.make(cotton_fabric());
  EXPECT_NEAR(s.transport->capacity()[0], 0.3 * 1e-4 / 3, 1e-18) << "duplicates do not count";
  for (double& m : s.liquid) m = 1e-5;
  const std::vector<double> before = s.liquid;
  for (const double dt : {1e-3, 1.0, 1e6})
    for (int k = 0; k < 10; ++k) s.step(dt, down);
  const auto sum = [&](const std::vector<double>& m, std::size_t a, std::size_t b) {
    return std::accumulate(m.begin() + static_cast<long>(a), m.begin() + static_cast<long>(b), 0.0);
  };
  EXPECT_NEAR(sum(s.liquid, 0, n), sum(before, 0, n), 1e-18);
  EXPECT_NEAR(sum(s.liquid, n, n + 3), sum(before, n, n + 3), 1e-18);
  EXPECT_NE(s.liquid[0], before[0]);
  for (std::size_t i = n + 3; i < s.x.size(); ++i) EXPECT_EQ(s.liquid[i], before[i]);
}

TEST(WettingBounds, slivers_and_sheets_without_triangles_are_no_trouble) {
  WettingSheet s;
  for (int i = 0; i <= 20; ++i)
    for (const double y : {0.0, 1e-5, 0.01}) s.x.emplace_back(0.01 * i, y, 0);
  for (std::uint32_t i = 0; i < 60; i += 3)
    for (const std::uint32_t j : {0u, 1u}) {
      s.triangles.push_back({i + j, i + j + 3, i + j + 4});
      s.triangles.push_back({i + j, i + j + 4, i + j + 1});
    }
  s.make(oblique(cotton_fabric(), 2));
  for (std::size_t i = 0; i < 9; ++i) s.set_saturation(i, 1);
  const double total = s.total();
  for (const double dt : {1e-3, 1.0, 1e6})
    for (int k = 0; k < 20; ++k) s.step(dt, down);
  EXPECT_NEAR(s.total() / total, 1, 1e-14);
  EXPECT_GE(s.lowest(), 0);
  EXPECT_LE(s.highest(), 1 + 1e-12);

  WettingSheet empty;
  empty.make(cotton_fabric());
  empty.step(1, down);
}

TEST(WettingBounds, same_input_same_bits) {
  WettingSheet a = wild_sheet(12, 5, oblique(cotton_fabric(), 2)),
               b = wild_sheet(12, 5, oblique(cotton_fabric(), 2));
  b.step(1e3, down);  // leaves nothing behind in the transport
  b.liquid = a.liquid;
  for (int k = 0; k < 5; ++k) a.step(0.02, down), b.step(0.02, down);
  EXPECT_EQ(a.liquid, b.liquid);
}

TEST(WettingInput, fabrics_out_of_range_are_refused) {
  EXPECT_TRUE(Fabric().validate().ok());
  for (const Fabric& f : {cotton_fabric(), wool_fabric(), nylon_fabric()}) EXPECT_TRUE(f.validate().ok());
  for (const double bad : {-1.0, 0.0, 1e300, std::nan("")})
    for (double Fabric::*field :
         {&Fabric::capacity, &Fabric::diffusivity, &Fabric::anisotropy, &Fabric::saturation_limit,
          &Fabric::capillary_rise, &Fabric::mobility_exponent}) {
      Fabric f;
      f.*field = bad;
      const bool fine = (field == &Fabric::mobility_exponent && bad == 0) ||
                        (field == &Fabric::capillary_rise && bad == 1e300);
      EXPECT_EQ(f.validate().ok(), fine) << bad << ": " << f.validate().message;
    }
  Fabric f;
  f.warp = Vec3::Zero();
  EXPECT_FALSE(f.validate().ok());
}

TEST(WettingInput, meshes_and_steps_that_cannot_be_are_refused) {
  WettingSheet s = wetting_grid(2, 2, 0.01, 0.01);
  const std::vector<Triangle> beyond = {{0, 1, 9}};
  EXPECT_FALSE(WettingTransport::validate(s.x, beyond, Fabric()).ok());
  std::vector<Vec3> bad = s.x;
  bad[3].y() = std::nan("");
  EXPECT_FALSE(WettingTransport::validate(bad, s.triangles, Fabric()).ok());
  s.make(cotton_fabric());
  s.set_saturation(4, 1);
  const std::vector<double> before = s.liquid;
  const auto refused = [&](double dt, const std::vector<Vec3>& x, const Vec3& g, std::vector<double> liquid,
                           std::vector<std::uint32_t> held) {
    const std::vector<double> old = liquid;
    const Status status = s.transport->step(dt, x, g, liquid, held);
    return !status.ok() && (liquid == old || std::isnan(liquid[0]));
  };
  EXPECT_TRUE(refused(-1, s.x, down, s.liquid, {}));
  EXPECT_TRUE(refused(std::nan(""), s.x, down, s.liquid, {}));
  EXPECT_TRUE(refused(1, bad, down, s.liquid, {}));
  EXPECT_TRUE(refused(1, {s.x.begin(), s.x.end() - 1}, down, s.liquid, {}));
  EXPECT_TRUE(refused(1, s.x, Vec3(0, INFINITY, 0), s.liquid, {}));
  EXPECT_TRUE(refused(1, s.x, down, {1, 2}, {}));
  EXPECT_TRUE(refused(1, s.x, down, std::vector<double>(9, -1), {}));
  EXPECT_TRUE(refused(1, s.x, down, std::vector<double>(9, std::nan("")), {}));
  EXPECT_TRUE(refused(1, s.x, down, s.liquid, {9}));
  EXPECT_FALSE(refused(0, s.x, down, s.liquid, {}));
}

/// A random matrix with columns that sum to `margin`; its solution by Eigen's dense method is the reference.
SparseMatrix random_matrix(std::size_t n, double margin, std::uint64_t seed) {
  Random random(seed);
  SparseMatrix a;
  a.diagonal.assign(n, margin);
  a.begin.push_back(0);
  for (std::uint32_t i = 0; i < n; ++i) {
    for (std::uint32_t j = 0; j < n; ++j)
      if (i != j && (random.uniform() < 0.1 || (i + 1) % n == j)) {
        a.column.push_back(j);
        a.value.push_back(-random.uniform());
        a.diagonal[j] -= a.value.back();
      }
    a.begin.push_back(static_cast<std::uint32_t>(a.column.size()));
  }
  return a;
}

TEST(SparseSolver, agrees_with_a_dense_method) {
  constexpr std::size_t n = 60;
  for (const double margin : {100.0, 1.0, 1e-6}) {
    const SparseMatrix a = random_matrix(n, margin, 4);
    Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(n, n);
    for (std::uint32_t i = 0; i < n; ++i) {
      dense(i, i) = a.diagonal[i];
      for (std::uint32_t k = a.begin[i]; k < a.begin[i + 1]; ++k) dense(i, a.column[k]) = a.value[k];
    }
    std::vector<double> b(n, 0), x(n, 0);
    b[7] = 1, b[33] = 2;
    const Eigen::VectorXd exact = dense.fullPivLu().solve(Eigen::Map<Eigen::VectorXd>(b.data(), n));
    SparseSolver solver;
    ASSERT_TRUE(solver.solve(a, b, std::vector<double>(n, 1), 1e-12, 1, x));
    for (std::uint32_t i = 0; i < n; ++i) EXPECT_NEAR(x[i] / exact[i], 1, 1e-8) << margin;
  }
}

TEST(SparseSolver, says_where_there_is_no_solution) {
  SparseMatrix a;  // ((1, −1), (−1, 1))
  a.begin = {0, 1, 2};
  a.column = {1, 0};
  a.value = {-1, -1};
  a.diagonal = {1, 1};
  std::vector<double> x(2, 0);
  EXPECT_FALSE(SparseSolver().solve(a, {1, 1}, {1, 1}, 1e-12, 1, x));
}

}  // namespace
}  // namespace oilskin
