#include "fluid/neighbours.h"

#include <gtest/gtest.h>

#include <set>

#include "fluid/particles.h"
#include "fluid/random.h"

namespace oilskin::fluid {
namespace {

std::vector<Vec3> random_points(std::size_t n, double size, std::uint64_t seed) {
  std::vector<Vec3> x(n);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t k = 0; k < 3; ++k)
      x[i][static_cast<int>(k)] = size * (2 * random_unit(seed, 3 * i + k) - 1);
  return x;
}

std::vector<Vec3> lattice_points(int n, double spacing) {
  std::vector<Vec3> x;
  for (int a = 0; a < n; ++a)
    for (int b = 0; b < n; ++b)
      for (int c = 0; c < n; ++c) x.push_back(spacing * Vec3(a, b, c));
  return x;
}

/// Sorted positions and their neighbours.
struct Searched {
  std::vector<Vec3> x;
  std::vector<std::uint32_t> order;
  Neighbours neighbours;

  Searched(const std::vector<Vec3>& points, double radius, int threads = 1) {
    const Workers workers(threads);
    order = neighbours.cell_order(points, radius, workers);
    for (const std::uint32_t o : order) x.push_back(points[o]);
    neighbours.search(x, workers);
  }
  std::set<std::uint32_t> of(std::size_t i) const {
    const std::uint32_t* j = neighbours.list(i);
    return {j, j + neighbours.count(i)};
  }
};

/// Lists must hold every pair nearer than the radius, and none farther. What is within `slack` of it may be
/// in or out (kernels vanish there) but must be the same from both sides.
void expect_like_brute_force(const Searched& s, double radius, double slack = 1e-5) {
  const std::size_t n = s.x.size();
  ASSERT_EQ(s.neighbours.size(), n);
  for (std::size_t i = 0; i < n; ++i) {
    const std::set<std::uint32_t> listed = s.of(i);
    ASSERT_EQ(listed.size(), s.neighbours.count(i)) << "listed twice";
    ASSERT_EQ(listed.count(static_cast<std::uint32_t>(i)), 0u);
    for (std::size_t j = 0; j < n; ++j) {
      if (j == i) continue;
      const double r = (s.x[i] - s.x[j]).norm();
      const bool found = listed.count(static_cast<std::uint32_t>(j)) > 0;
      if (std::abs(r - radius) > slack * radius) {
        ASSERT_EQ(found, r < radius) << i << " " << j << " at " << r;
      }
      ASSERT_EQ(found, s.of(j).count(static_cast<std::uint32_t>(i)) > 0) << "not mutual";
    }
    for (std::size_t k = s.neighbours.count(i); k < (s.neighbours.count(i) + 7) / 8 * 8; ++k)
      ASSERT_EQ(s.neighbours.list(i)[k], n) << "padding";
  }
}

TEST(Neighbours, random_points_like_brute_force) {
  expect_like_brute_force(Searched(random_points(700, 0.05, 1), 0.02), 0.02);
  expect_like_brute_force(Searched(random_points(400, 1, 2), 0.15), 0.15);
}

TEST(Neighbours, lattice_with_points_at_the_support_radius) {
  for (const double ratio : {1.5, 2.0, 2.2, 3.0})
    expect_like_brute_force(Searched(lattice_points(8, 0.005), ratio * 0.005), ratio * 0.005);
}

TEST(Neighbours, full_lattice_has_26_at_two_spacings) {
  const Searched s(lattice_points(9, 0.005), 0.0099999);
  std::size_t inner = 0;
  for (std::size_t i = 0; i < s.x.size(); ++i) {
    if (((s.x[i].array() < 0.0075) || (s.x[i].array() > 0.0325)).any()) continue;
    EXPECT_EQ(s.neighbours.count(i), 26u);
    ++inner;
  }
  EXPECT_EQ(inner, 125u);
}

TEST(Neighbours, coincident_points) {
  std::vector<Vec3> x(30, Vec3(1, 2, 3));
  for (const Vec3& p : random_points(50, 0.01, 3)) x.push_back(Vec3(1, 2, 3) + p);
  expect_like_brute_force(Searched(x, 0.01), 0.01);
}

TEST(Neighbours, far_spray_keeps_the_bulk_accurate) {
  std::vector<Vec3> x = random_points(400, 0.04, 4);
  for (Vec3& p : x) p += Vec3(-99.5, 99.5, 99.5);
  for (const Vec3& p : random_points(40, 100, 5)) x.push_back(p);
  x.push_back(Vec3(100, -100, 100));
  x.push_back(Vec3(100, -100, 99.995));
  const Searched s(x, 0.02);
  EXPECT_LT((s.neighbours.origin() - Vec3(-99.5, 99.5, 99.5)).norm(), 0.1);
  expect_like_brute_force(s, 0.02, 1e-5);
}

TEST(Neighbours, beyond_the_largest_cell_index) {
  std::vector<Vec3> x = {Vec3(5e6, 0, 0), Vec3(5e6, 0.005, 0), Vec3(-9e6, 0, 0), Vec3(0, 0, 0),
                         Vec3(0.004, 0, 0)};
  const Searched s(x, 0.01);
  std::size_t pairs = 0;
  for (std::size_t i = 0; i < x.size(); ++i) pairs += s.neighbours.count(i);
  EXPECT_EQ(pairs, 4u);
}

TEST(Neighbours, none_and_one) {
  EXPECT_EQ(Searched({}, 0.01).neighbours.size(), 0u);
  const Searched one({Vec3(3, 4, 5)}, 0.01);
  EXPECT_EQ(one.neighbours.count(0), 0u);
}

TEST(Neighbours, many_points_like_the_cells_around_them) {
  // Larger than a chunk of the sort and of the lists; checked on a sample.
  const std::vector<Vec3> x = random_points(20000, 0.1, 6);
  const Searched s(x, 0.01, 2);
  for (std::size_t i = 0; i < x.size(); i += 97) {
    std::set<std::uint32_t> expected;
    for (std::size_t j = 0; j < x.size(); ++j)
      if (j != i && (s.x[i] - s.x[j]).norm() < 0.01) expected.insert(static_cast<std::uint32_t>(j));
    EXPECT_EQ(s.of(i), expected);
  }
}

TEST(Neighbours, order_is_a_stable_permutation) {
  std::vector<Vec3> x = random_points(3000, 0.05, 7);
  for (std::size_t i = 0; i < 100; ++i) x.push_back(x[7]);
  const Searched s(x, 0.01);
  std::set<std::uint32_t> all(s.order.begin(), s.order.end());
  EXPECT_EQ(all.size(), x.size());
  for (std::size_t i = 1; i < s.order.size(); ++i)
    if (s.x[i] == s.x[i - 1]) {
      EXPECT_LT(s.order[i - 1], s.order[i]);
    }
  // Sorted input stays as it is.
  const Searched again(s.x, 0.01);
  for (std::size_t i = 0; i < again.order.size(); ++i) EXPECT_EQ(again.order[i], i);
}

TEST(Neighbours, same_lists_for_any_number_of_threads) {
  const std::vector<Vec3> x = random_points(30000, 0.1, 8);
  const Searched a(x, 0.01, 1), b(x, 0.01, 2), c(x, 0.01, 3);
  EXPECT_EQ(a.order, b.order);
  EXPECT_EQ(a.order, c.order);
  for (std::size_t i = 0; i < x.size(); ++i) {
    ASSERT_EQ(a.neighbours.count(i), b.neighbours.count(i));
    ASSERT_EQ(a.neighbours.count(i), c.neighbours.count(i));
    for (std::size_t k = 0; k < a.neighbours.count(i); ++k) {
      ASSERT_EQ(a.neighbours.list(i)[k], b.neighbours.list(i)[k]);
      ASSERT_EQ(a.neighbours.list(i)[k], c.neighbours.list(i)[k]);
    }
  }
}

/// Also where chunks of a loop part the cells of a block.
TEST(Neighbours, boxes_of_many_points_are_one_for_each_block) {
  const double radius = 0.01;
  const Searched s(random_points(30000, 0.1, 8), radius);  // 20³ cells
  const std::vector<Box> one = s.neighbours.boxes(s.x, Workers(1)),
                         three = s.neighbours.boxes(s.x, Workers(3));
  ASSERT_EQ(one.size(), three.size());
  EXPECT_LE(one.size(), 6u * 6 * 6) << "blocks of four cells";
  for (std::size_t k = 0; k < one.size(); ++k) {
    EXPECT_EQ(one[k].min, three[k].min);
    EXPECT_EQ(one[k].max, three[k].max);
    EXPECT_LE((one[k].max - one[k].min).maxCoeff(), 4 * radius);
  }
  for (const Vec3& x : s.x)
    ASSERT_EQ(std::count_if(one.begin(), one.end(), [&](const Box& b) { return b.contains(x); }), 1);
}

TEST(Particles, compress_and_permute_keep_fields_together) {
  Particles p;
  for (std::uint64_t i = 0; i < 5; ++i) {
    const double d = static_cast<double>(i);
    p.push_back(10 + i, Vec3(d, 0, 0), Vec3(0, d, 0), 1000);
    p.density.back() = d;
    p.pressure.back() = -d;
  }
  const std::vector<std::uint32_t> order = {4, 2, 0, 1, 3};
  Particles::Scratch scratch;
  p.permute(order, Workers(1), scratch);
  const std::vector<std::uint8_t> keep = {1, 0, 1, 1, 0};
  p.compress(keep);
  ASSERT_EQ(p.size(), 3u);
  const std::array<double, 3> expected = {4, 0, 1};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(p.id[i], 10 + static_cast<std::uint64_t>(expected[i]));
    EXPECT_EQ(p.position[i].x(), expected[i]);
    EXPECT_EQ(p.velocity[i].y(), expected[i]);
    EXPECT_EQ(p.density[i], expected[i]);
    EXPECT_EQ(p.pressure[i], -expected[i]);
  }
}

TEST(Particles, many_are_permuted_copied_and_compressed_by_any_number_of_threads) {
  constexpr std::size_t n = 10000;  // larger than a chunk of these loops
  for (const int threads : {1, 3}) {
    const Workers workers(threads);
    Particles p;
    std::vector<std::uint32_t> order(n);
    for (std::size_t i = 0; i < n; ++i) {
      const double d = static_cast<double>(i);
      p.push_back(i + 1, Vec3(d, 0, 0), Vec3(0, d, 0), 1000);
      p.pressure.back() = d;
      order[i] = static_cast<std::uint32_t>(7 * i % n);
    }
    Particles::Scratch scratch;
    p.permute(order, workers, scratch);
    Particles copy;
    copy.push_back(77, Vec3::Zero(), Vec3::Zero(), 1);
    p.copy_to(copy, workers);
    ASSERT_EQ(copy.size(), n);
    std::vector<std::uint8_t> keep(n, 1);
    p.compress(keep);
    ASSERT_EQ(p.size(), n) << "all stay";
    for (std::size_t i = 0; i < n; ++i) {
      ASSERT_EQ(p.id[i], order[i] + 1);
      ASSERT_EQ(copy.id[i], p.id[i]);
      ASSERT_EQ(copy.position[i].x(), order[i]);
      ASSERT_EQ(copy.motion[i].y(), order[i]);
      ASSERT_EQ(copy.pressure[i], order[i]);
      keep[i] = order[i] % 3 != 0;
    }
    p.compress(keep);
    ASSERT_EQ(p.size(), n - (n + 2) / 3);
    for (std::size_t i = 0; i < p.size(); ++i) {
      ASSERT_NE((p.id[i] - 1) % 3, 0u);
      ASSERT_EQ(p.position[i].x(), p.pressure[i]);
      ASSERT_EQ(p.velocity[i].y() + 1, static_cast<double>(p.id[i]));
    }
    const Vec3 sum = copy.sum_of_velocities(workers);
    EXPECT_EQ(sum.y(), 0.5 * static_cast<double>(n) * static_cast<double>(n - 1));
  }
}

}  // namespace
}  // namespace oilskin::fluid
