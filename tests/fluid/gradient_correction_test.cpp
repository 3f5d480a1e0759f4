/// Corrected kernel gradients: what they promise of one step of DFSPH.
#include "fluid/pressure/gradient_correction.h"

#include <gtest/gtest.h>

#include "fluid/pressure/incompressible.h"
#include "fluid/random.h"
#include "tank.h"

namespace oilskin::fluid {
namespace {

constexpr double dx = 0.005;

/// A block of 12³ particles off a lattice by up to 0.15 dx, with the sums at the start of a step.
struct Block {
  const IncompressibleFluid fluid;
  const Workers workers;
  StepState state;
  std::vector<Record> sums, own;  // Σ_j m_j w'/q Δ, and K_i times it
  GradientCorrection correction;

  explicit Block(double share, bool masses_differ = false)
      : fluid(water()), workers(1), state(workers, 2), correction(share) {
    std::vector<Vec3> places, sorted;
    for (std::size_t k = 0; k < 12 * 12 * 12; ++k) {
      const auto offset = [&](std::size_t axis) { return 0.3 * (random_unit(3, 3 * k + axis) - 0.5); };
      places.push_back(dx * Vec3(static_cast<double>(k % 12) + offset(0),
                                 static_cast<double>(k / 12 % 12) + offset(1),
                                 static_cast<double>(k / 144) + offset(2)));
    }
    for (const std::uint32_t o : state.neighbours.cell_order(places, fluid.support_radius, workers))
      sorted.push_back(places[o]);
    state.neighbours.search(sorted, workers);
    state.dt = 1e-3;
    state.velocity.resize(size() + 1);
    state.relative_density.resize(size());
    state.dv.assign(size(), Vec3::Zero());
    sums.resize(size());
    correction.moments().resize(size());
    if (masses_differ)
      for (std::size_t i = 0; i <= size(); ++i)
        state.mass_ratio.push_back(0.9f + 0.2f * static_cast<float>(random_unit(4, i)));
    run_explicit_sums(state, fluid.explicit_model(state.dt), true,
                      [&](const PairRates& rates, std::size_t i) {
                        sums[i] = rates.gradient;
                        correction.moments().set(i, rates.moments);
                      });
    own = sums;
    correction.begin_step(state, own, fluid.density_scale);
  }
  std::size_t size() const { return state.size(); }
  Vec3 place(std::size_t i) const { return to_vector(state.position()[i]); }

  /// Whether the weight c_i of (F.77) is 1: far from the surface of the block.
  bool has_all(std::size_t i) const {
    const double pull = static_cast<double>(fluid.density_scale) * to_vector(sums[i]).norm();
    return state.relative_density[i] > 0.96f && pull < 0.29;
  }
  /// The compression of displacements, f(place) → displacement [H].
  template <class F>
  std::vector<float> compression(const F& f) {
    std::vector<Record> y(size() + 1, Record{0, 0, 0, 0});
    for (std::size_t i = 0; i < size(); ++i) y[i] = to_record(f(place(i)));
    std::vector<float> result(size());
    state.for_chunks([&](std::size_t begin, std::size_t end) {
      correction.compression(state, y, {begin, end}, &result[begin]);
    });
    for (float& value : result) value *= fluid.density_scale;
    return result;
  }
  /// Positions with random pressures up to 1.
  std::vector<Record> with_pressures() const {
    std::vector<Record> x_phi = state.position();
    for (std::size_t i = 0; i < size(); ++i) x_phi[i].w = static_cast<float>(random_unit(5, i));
    return x_phi;
  }
};

/// The largest |compression| of particles whose gradient is corrected entirely, and their number.
template <class F>
std::pair<double, int> largest_compression(Block& block, const F& f) {
  const std::vector<float> found = block.compression(f);
  std::pair<double, int> result = {0, 0};
  for (std::size_t i = 0; i < block.size(); ++i)
    if (block.has_all(i)) {
      result.first = std::max(result.first, std::abs(static_cast<double>(found[i])));
      ++result.second;
    }
  return result;
}

TEST(GradientCorrection, shear_and_stretch_without_dilation_are_no_compression) {
  Block whole(1), part(0.8), hardly(1e-9);
  const auto shear = [](const Vec3& x) { return Vec3(0.1 * x.y(), 0.05 * x.z(), 0); };
  const auto stretch = [](const Vec3& x) { return Vec3(0.1 * x.x(), -0.1 * x.y(), 0); };
  for (const auto& [with, expected] : {std::pair<Block*, double>(&whole, 0), {&part, 0.2}}) {
    const auto [of_shear, counted] = largest_compression(*with, shear);
    const double uncorrected = largest_compression(hardly, shear).first;
    EXPECT_GT(counted, 200);
    EXPECT_GT(uncorrected, 3e-3);
    EXPECT_NEAR(of_shear / uncorrected, expected, 0.02);
    EXPECT_NEAR(largest_compression(*with, stretch).first / largest_compression(hardly, stretch).first,
                expected, 0.02);
  }
}

TEST(GradientCorrection, dilation_is_the_compression_that_it_was) {
  Block whole(1), hardly(1e-9);
  const auto dilation = [](const Vec3& x) { return Vec3(0.1 * x); };
  const std::vector<float> a = whole.compression(dilation), b = hardly.compression(dilation);
  for (std::size_t i = 0; i < whole.size(); ++i)
    if (whole.has_all(i)) {
      ASSERT_NEAR(a[i], b[i], 1e-5);
    }
}

TEST(GradientCorrection, pressures_conserve_momentum_and_angular_momentum) {
  for (const bool masses_differ : {false, true}) {
    Block block(0.8, masses_differ);
    block.correction.apply_pressure(block.state, block.with_pressures(), 1);
    Vec3 momentum = Vec3::Zero(), angular = Vec3::Zero();
    double size = 0;
    for (std::size_t i = 0; i < block.size(); ++i) {
      const Vec3 p = block.state.relative_mass(i) * block.state.dv[i];
      momentum += p;
      angular += block.place(i).cross(p);
      size += p.norm();
    }
    EXPECT_GT(size, 10);
    EXPECT_LT(momentum.norm(), 1e-13 * size) << masses_differ;
    EXPECT_LT(angular.norm(), 1e-6 * size) << masses_differ;
  }
}

/// Σ m φ div(y) D = Σ m y·(what the pressures φ do): the force does the work of the pressures.
TEST(GradientCorrection, the_force_is_the_transpose_of_the_compression) {
  for (const bool masses_differ : {false, true}) {
    Block block(0.8, masses_differ);
    const std::vector<Record> x_phi = block.with_pressures();
    const auto displacement = [](const Vec3& x) {
      return Vec3(std::sin(9 * x.y()), std::cos(7 * x.z()) * x.x(), std::sin(5 * x.x()));
    };
    const std::vector<float> compression = block.compression(displacement);
    block.correction.apply_pressure(block.state, x_phi, 1);
    std::vector<Record> push(block.size());
    block.state.for_chunks([&](std::size_t begin, std::size_t end) {
      block.correction.push(block.state, x_phi, block.own, {begin, end}, &push[begin]);
    });
    double work = 0, of_force = 0, of_push = 0, size = 0;
    for (std::size_t i = 0; i < block.size(); ++i) {
      const double m = block.state.relative_mass(i);
      const Vec3 y = displacement(block.place(i));
      const double w = m * static_cast<double>(x_phi[i].w * compression[i] / block.fluid.density_scale);
      work += w;
      size += std::abs(w);
      of_force -= m * y.dot(block.state.dv[i]);
      of_push += m * y.dot(to_vector(push[i]));
    }
    EXPECT_GT(size, 10);
    EXPECT_NEAR(of_force, work, 1e-5 * size) << masses_differ;
    EXPECT_NEAR(of_push, work, 1e-5 * size) << masses_differ;
  }
}

}  // namespace
}  // namespace oilskin::fluid
