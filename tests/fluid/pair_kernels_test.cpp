// The loops over pairs against sums in double, and all versions that this machine has against each other.
#include "fluid/pairs/pair_kernels.h"

#include <gtest/gtest.h>

#include <map>

#include "core/aligned_vector.h"
#include "fluid/kernels.h"
#include "fluid/neighbours.h"
#include "fluid/random.h"
#include "tank.h"
#include "using_instruction_set.h"

namespace oilskin::fluid {
namespace {

constexpr double support_radius = 0.01;
constexpr PairFriction friction = {0.3f, 0.2f, 0.7f, 0.1f, 0.4f, 0.2f};

/// Particles at random within one chunk of lists, some at the same place, one alone.
struct Cloud {
  Neighbours neighbours;
  std::vector<Record> x, v;  // s of the pressure in x.w; with one more for the padding
  std::vector<float> mass_ratio;
  std::vector<Record> diagonal, rest;  // of tensors

  Cloud() {
    std::vector<Vec3> places;
    for (std::size_t i = 0; i < 500; ++i)
      places.push_back(0.036 *
                       Vec3(random_unit(1, 3 * i), random_unit(1, 3 * i + 1), random_unit(1, 3 * i + 2)));
    places.insert(places.end(), {places[7], places[7], Vec3(1, 0, 0)});
    const Workers workers(1);
    const std::vector<std::uint32_t> order = neighbours.cell_order(places, support_radius, workers);
    std::vector<Vec3> sorted;
    for (const std::uint32_t o : order) sorted.push_back(places[o]);
    neighbours.search(sorted, workers);
    x = neighbours.records();
    const auto random = [](std::size_t k) { return static_cast<float>(2 * random_unit(2, k) - 1); };
    for (std::size_t i = 0; i < size(); ++i) {
      x[i].w = random(5 * i) + 1;
      v.push_back({random(5 * i + 1), random(5 * i + 2), random(5 * i + 3), 0});
      mass_ratio.push_back(1.05f + random(5 * i + 4));
      const std::size_t k = 5000 + 6 * i;
      diagonal.push_back({random(k), random(k + 1), random(k + 2), 0});
      rest.push_back({random(k + 3), random(k + 4), random(k + 5), 0});
    }
    v.push_back({0, 0, 0, 0});
    mass_ratio.push_back(1);
    diagonal.push_back({0, 0, 0, 0});
    rest.push_back({0, 0, 0, 0});
  }
  Eigen::Matrix3d tensor(std::size_t i) const {
    const Record &d = diagonal[i], &r = rest[i];
    Eigen::Matrix3f k;
    k << d.x, r.x, r.y, r.x, d.y, r.z, r.y, r.z, d.z;
    return k.cast<double>();
  }
  std::size_t size() const { return neighbours.size(); }
};

/// What is computed for all particles, one after the other, by name.
using Results = std::map<std::string, std::vector<double>>;

constexpr double close_square = 0.09;

void add(Results& results, const std::string& name, std::initializer_list<double> values) {
  results[name].insert(results[name].end(), values);
}

Vec3 vector_of(const Record& r) {
  return {r.x, r.y, r.z};
}

/// The sums with corrected gradients, after start() has written the slopes of `table`.
void add_corrected(Results& r, const Cloud& cloud, const PairTable& table) {
  const std::size_t n = cloud.size();
  const GradientKernels& kernels = pair_kernels().corrected;
  const PairRange all = {0, n};
  const Tensors tensors = {cloud.diagonal.data(), cloud.rest.data()};
  std::vector<float> compression(n);
  std::vector<Change> exact(n);
  std::vector<Record> push(n);
  kernels.pressure(table, cloud.x.data(), tensors, all, push.data());
  kernels.pressure_exact(table, cloud.x.data(), tensors, all, exact.data());
  kernels.compression(table, cloud.x.data(), tensors, cloud.v.data(), all, compression.data());
  for (std::size_t i = 0; i < n; ++i) {
    add(r, "corrected pressure of the others", {push[i].x, push[i].y, push[i].z});
    add(r, "exact corrected pressure", {exact[i].x, exact[i].y, exact[i].z});
    add(r, "corrected compression", {compression[i]});
  }
}

/// By the kernels in use.
Results sums(const Cloud& cloud, bool weighted, bool with_rates, bool slopes_stored = true) {
  const std::size_t n = cloud.size();
  const PairKernels& kernels = pair_kernels();
  std::vector<float> slopes(cloud.neighbours.pair_capacity(0)), density(n), moved_density(n), compression(n);
  std::vector<Change> rubbed(n), exact(n);
  std::vector<PairRates> rates(n);
  std::vector<std::uint8_t> is_close(n);
  std::vector<Record> push(n);
  const PairTable table = cloud.neighbours.table(0, slopes_stored ? slopes.data() : nullptr,
                                                 weighted ? cloud.mass_ratio.data() : nullptr);
  const PairRange all = {0, n};
  kernels.start(table, cloud.x.data(), cloud.v.data(), friction, all,
                {density.data(), rubbed.data(), with_rates ? rates.data() : nullptr, is_close.data(),
                 static_cast<float>(close_square)});
  kernels.density(table, cloud.x.data(), all, moved_density.data());
  kernels.pressure(table, cloud.x.data(), all, push.data());
  kernels.pressure_exact(table, cloud.x.data(), all, exact.data());
  kernels.compression(table, cloud.x.data(), cloud.v.data(), all, compression.data());
  Results r;
  for (std::size_t i = 0; i < n; ++i) {
    add(r, "density", {density[i]});
    add(r, "density again", {moved_density[i]});
    add(r, "has a close neighbour", {2.0 * is_close[i]});
    add(r, "friction", {rubbed[i].x, rubbed[i].y, rubbed[i].z});
    add(r, "pressure", {push[i].x, push[i].y, push[i].z});
    add(r, "exact pressure", {exact[i].x, exact[i].y, exact[i].z});
    add(r, "compression", {compression[i]});
    if (!with_rates) continue;
    add(r, "gradient", {rates[i].gradient.x, rates[i].gradient.y, rates[i].gradient.z});
    add(r, "squares", {rates[i].gradient.w});
    add(r, "rate", {rates[i].compression});
    const SecondMoments& m = rates[i].moments;
    add(r, "moments", {m.xx, m.yy, m.zz, m.xy, m.xz, m.yz});
  }
  add_corrected(r, cloud, table);
  return r;
}

/// By their definitions, in double, over all pairs. The particle's own mass is a factor of the squares.
Results expected_sums(const Cloud& cloud, bool weighted) {
  Results r;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    double density = 0, compression = 0, squares = 0;
    double corrected_compression = 0;
    Vec3 rubbed = Vec3::Zero(), push = Vec3::Zero(), gradient = Vec3::Zero();
    Vec3 of_others = Vec3::Zero(), corrected_push = Vec3::Zero();
    Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
    bool is_close = false;
    for (std::size_t j = 0; j < cloud.size(); ++j) {
      const Vec3 delta = vector_of(cloud.x[i]) - vector_of(cloud.x[j]);
      const Vec3 dv = vector_of(cloud.v[i]) - vector_of(cloud.v[j]);
      const double q = delta.norm(), m = weighted ? cloud.mass_ratio[j] : 1;
      if (j == i || q >= 1) continue;
      is_close = is_close || q * q < close_square;
      const double w = CubicSpline::w(q), g = CubicSpline::dw_over_q(q), u = 1 - q;
      const double s = static_cast<double>(cloud.x[i].w) + static_cast<double>(cloud.x[j].w);
      density += m * w;
      gradient += m * g * delta;
      squares += m * g * g * q * q;
      compression += m * g * dv.dot(delta);
      push += m * s * g * delta;
      const Vec3 own = g * cloud.tensor(i) * delta, other = g * cloud.tensor(j) * delta;
      const double s_i = static_cast<double>(cloud.x[i].w), s_j = static_cast<double>(cloud.x[j].w);
      of_others += m * s_j * other;
      corrected_push += m * (s_i * own + s_j * other);
      corrected_compression += m * own.dot(dv);
      moments += m * g * delta * delta.transpose();
      const double smoothing = 0.1 + std::min(0.4 * std::abs(dv.dot(delta)) / std::sqrt(q * q + 0.01), 0.2);
      rubbed += m * (dv.dot(delta) * (0.3 * g / (q * q + 0.01) - 0.2 * u * u) * delta -
                     (0.7 * 6 * u + smoothing * w) * dv);
    }
    for (const char* name : {"density", "density again"}) add(r, name, {density});
    for (const char* name : {"compression", "rate"}) add(r, name, {compression});
    for (const char* name : {"pressure", "exact pressure"}) add(r, name, {push.x(), push.y(), push.z()});
    add(r, "friction", {rubbed.x(), rubbed.y(), rubbed.z()});
    add(r, "gradient", {gradient.x(), gradient.y(), gradient.z()});
    add(r, "has a close neighbour", {is_close ? 2.0 : 0.0});
    add(r, "squares", {squares * (weighted ? cloud.mass_ratio[i] : 1)});
    add(r, "moments",
        {moments(0, 0), moments(1, 1), moments(2, 2), moments(0, 1), moments(0, 2), moments(1, 2)});
    add(r, "corrected pressure of the others", {of_others.x(), of_others.y(), of_others.z()});
    add(r, "exact corrected pressure", {corrected_push.x(), corrected_push.y(), corrected_push.z()});
    add(r, "corrected compression", {corrected_compression});
  }
  return r;
}

TEST(PairKernels, sum_what_they_are_defined_to) {
  const Cloud cloud;
  for (const bool weighted : {false, true}) {
    const Results found = sums(cloud, weighted, true), expected = expected_sums(cloud, weighted);
    ASSERT_EQ(found.size(), expected.size());
    for (const auto& [name, values] : found) {
      const std::vector<double>& right = expected.at(name);
      ASSERT_EQ(values.size(), right.size());
      double largest = 0;
      for (const double value : right) largest = std::max(largest, std::abs(value));
      EXPECT_GT(largest, 1) << name;
      for (std::size_t k = 0; k < values.size(); ++k)
        ASSERT_NEAR(values[k], right[k], 1e-5 * largest) << name << " " << k << " weighted " << weighted;
    }
  }
}

void expect_the_same_bits(const Results& a, const Results& b, bool weighted) {
  for (const auto& [name, values] : a)
    for (std::size_t k = 0; k < values.size(); ++k)
      ASSERT_EQ(bits(values[k]), bits(b.at(name)[k])) << name << " " << k << " weighted " << weighted;
}

/// The sets apart from the baseline that this machine has.
TEST(PairKernels, give_the_same_bits_for_all_instruction_sets) {
  if (others().empty()) GTEST_SKIP() << "only the baseline";
  const Cloud cloud;
  const auto sums_with = [&](InstructionSet set, bool weighted, bool with_rates) {
    const Using chosen(set);
    EXPECT_EQ(instruction_set(), set);
    return sums(cloud, weighted, with_rates);
  };
  for (const InstructionSet set : others())
    for (const bool weighted : {false, true})
      for (const bool with_rates : {false, true}) {
        const Results a = sums_with(InstructionSet::baseline, weighted, with_rates);
        const Results b = sums_with(set, weighted, with_rates);
        ASSERT_NO_FATAL_FAILURE(expect_the_same_bits(a, b, weighted));
      }
}

TEST(PairKernels, give_the_same_bits_whether_slopes_are_stored_or_computed) {
  const Cloud cloud;
  for (const InstructionSet set : all_instruction_sets) {
    if (!is_available(set)) continue;
    const Using chosen(set);
    for (const bool weighted : {false, true})
      ASSERT_NO_FATAL_FAILURE(expect_the_same_bits(sums(cloud, weighted, true, true),
                                                   sums(cloud, weighted, true, false), weighted));
  }
}

TEST(PairKernels, columns_have_the_places_of_the_records) {
  const Cloud cloud;
  for (const InstructionSet set : all_instruction_sets) {
    if (!is_available(set)) continue;
    const Using chosen(set);
    for (std::size_t begin = 0; begin < 20; ++begin)
      for (std::size_t end = begin; end < begin + 30; ++end) {
        std::vector<float> x(end - begin + 8), y(x.size()), z(x.size());
        pair_kernels().columns(cloud.x.data(), {begin, end}, x.data(), y.data(), z.data());
        for (std::size_t k = 0; k < end - begin; ++k)
          ASSERT_EQ(Vec3(x[k], y[k], z[k]), vector_of(cloud.x[begin + k])) << begin << " " << end;
      }
  }
}

/// The particles nearer than 1 to p, of candidates in columns.
std::vector<std::uint32_t> near_to(const Record& p, const Cloud& cloud, std::size_t count) {
  AlignedVector<float> x(count + candidate_padding, 1e18f), y(x.size()), z(x.size());
  AlignedVector<std::uint32_t> particle(x.size());
  std::vector<std::uint32_t> found(count + 16);
  for (std::size_t i = 0; i < count; ++i) {
    x[i] = cloud.x[i].x, y[i] = cloud.x[i].y, z[i] = cloud.x[i].z;
    particle[i] = static_cast<std::uint32_t>(3 * i);
  }
  found.resize(pair_kernels().near({x.data(), y.data(), z.data(), particle.data(), count}, p, found.data()));
  return found;
}

TEST(PairKernels, find_the_candidates_that_are_near_in_their_order) {
  const Cloud cloud;
  for (const InstructionSet set : all_instruction_sets) {
    if (!is_available(set)) continue;
    const Using chosen(set);
    for (std::size_t count = 0; count < 500; count += count < 20 ? 1 : 37) {
      const Record& p = cloud.x[count / 2];
      std::vector<std::uint32_t> expected;
      for (std::size_t i = 0; i < count; ++i)
        if ((vector_of(cloud.x[i]) - vector_of(p)).norm() < 1)
          expected.push_back(static_cast<std::uint32_t>(3 * i));
      EXPECT_EQ(near_to(p, cloud, count), expected) << count;
    }
  }
}

class EverySolver : public testing::TestWithParam<PressureSolver> {};
INSTANTIATE_TEST_SUITE_P(PairKernels, EverySolver,
                         testing::Values(PressureSolver::mcg03, PressureSolver::pcisph,
                                         PressureSolver::dfsph),
                         [](const auto& test) { return solver_name(test.param); });

TEST_P(EverySolver, moves_water_by_the_same_bits_for_all_instruction_sets) {
  if (others().empty()) GTEST_SKIP() << "only the baseline";
  FluidSettings s = water();
  s.solver = GetParam();
  s.viscosity = 1e-4;
  const auto hash_with = [&](InstructionSet set) {
    const Using chosen(set);
    Tank tank(s, 2);
    tank.fill(12, 12, 12, 0.0048);
    tank.box = {Vec3::Zero(), Vec3(0.08, 1, 0.06)};
    for (int step = 0; step < 20; ++step) tank.step(1e-3);
    return tank.hash();
  };
  for (const InstructionSet set : others()) EXPECT_EQ(hash_with(InstructionSet::baseline), hash_with(set));
}

}  // namespace
}  // namespace oilskin::fluid
