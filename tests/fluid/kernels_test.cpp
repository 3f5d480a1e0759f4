#include "fluid/kernels.h"

#include <gtest/gtest.h>

#include <array>

#include "fluid/lattice.h"

namespace oilskin::fluid {
namespace {

constexpr std::array<double, 6> places = {0, 0.1, 0.25, 0.5, 0.75, 0.9};

struct Values {
  std::array<double, 6> w, slope;
};

/// Printed to six decimals, so small values carry few digits.
void expect_printed(double value, double printed) {
  EXPECT_NEAR(value, printed, std::max(1e-5 * std::abs(printed), 0.6e-6));
}

template <class Kernel>
void expect_values(const Values& v) {
  for (std::size_t i = 0; i < places.size(); ++i) {
    expect_printed(kernel_value<Kernel>(places[i], 1), v.w[i]);
    expect_printed(kernel_slope<Kernel>(places[i], 1), v.slope[i]);
  }
}

TEST(Kernels, have_the_published_values) {
  expect_values<Poly6>({{1.566681, 1.520149, 1.290906, 0.660944, 0.131194, 0.010746},
                        {0, -0.921303, -2.065449, -2.643775, -1.349427, -0.305409}});
  // The slope of the spiky kernel at 0 is taken as 0, not as its limit: coincident particles feel no force.
  expect_values<Spiky>({{4.774648, 3.480719, 2.014305, 0.596831, 0.074604, 0.004775},
                        {0, -11.602395, -8.057219, -3.580986, -0.895247, -0.143239}});
  expect_values<CubicSpline>({{2.546479, 2.408969, 1.830282, 0.636620, 0.079577, 0.005093},
                              {0, -2.597409, -4.774648, -3.819719, -0.954930, -0.152789}});
  expect_values<WendlandC2>({{3.342254, 3.069994, 2.115020, 0.626673, 0.052223, 0.001537},
                             {0, -4.873006, -7.050067, -4.177817, -0.783341, -0.060161}});
  expect_values<WendlandC4>({{4.923856, 4.492069, 2.829850, 0.532135, 0.014500, 0.000078},
                             {0, -8.140966, -12.268768, -5.026436, -0.319762, -0.004550}});
}

TEST(Kernels, spiky_slope_tends_to_its_limit) {
  EXPECT_NEAR(kernel_slope<Spiky>(1e-5, 1), -14.323945, 1e-3);
  EXPECT_EQ(kernel_slope<Spiky>(0, 1), 0);
}

TEST(Kernels, viscosity_kernel_is_the_published_polynomial) {
  for (const double q : {0.1, 0.3, 0.5, 0.8, 0.99}) {
    EXPECT_NEAR(ViscosityKernel::w(q), -q * q * q / 2 + q * q + 1 / (2 * q) - 1, 1e-12);
    EXPECT_NEAR(q * ViscosityKernel::dw_over_q(q), -1.5 * q * q + 2 * q - 1 / (2 * q * q), 1e-10);
    EXPECT_NEAR(ViscosityKernel::norm * ViscosityKernel::laplacian(q), 45 / pi * (1 - q), 1e-12);
  }
}

template <class Kernel>
class EveryKernel : public testing::Test {};
using AllKernels = testing::Types<Poly6, Spiky, ViscosityKernel, CubicSpline, WendlandC2, WendlandC4>;
TYPED_TEST_SUITE(EveryKernel, AllKernels);

TYPED_TEST(EveryKernel, integrates_to_one) {
  for (const double h : {1.0, 0.01}) {
    const int n = 20000;
    double sum = 0;
    for (int i = 0; i < n; ++i) {
      const double r = (i + 0.5) / n * h;
      sum += 4 * pi * r * r * kernel_value<TypeParam>(r, h) * h / n;
    }
    EXPECT_NEAR(sum, 1, 1e-7);
  }
}

TYPED_TEST(EveryKernel, slope_is_the_derivative) {
  const double h = 0.7, e = 1e-6;
  for (double r = 0.05; r < 0.69; r += 0.01) {
    const double difference =
        (kernel_value<TypeParam>(r + e, h) - kernel_value<TypeParam>(r - e, h)) / (2 * e);
    EXPECT_NEAR(kernel_slope<TypeParam>(r, h), difference, 1e-6 * (1 + std::abs(difference)));
  }
}

TYPED_TEST(EveryKernel, vanishes_from_the_support_radius_on) {
  for (const double q : {1.0, 1.0000001, 1.5, 1e9}) {
    EXPECT_EQ(TypeParam::w(q), 0);
    EXPECT_EQ(TypeParam::dw_over_q(q), 0);
  }
  EXPECT_EQ(TypeParam::w(simd::F4(1e18f))[0], 0);  // the padding of neighbour lists
  EXPECT_EQ(TypeParam::dw_over_q(simd::F4(1e18f))[0], 0);
}

TYPED_TEST(EveryKernel, four_floats_agree_with_double) {
  for (float q = 0.01f; q < 1; q += 0.01f) {
    const double w = TypeParam::w(static_cast<double>(q)), g = TypeParam::dw_over_q(static_cast<double>(q));
    EXPECT_NEAR(static_cast<double>(TypeParam::w(simd::F4(q))[2]), w, 1e-6 * (1 + std::abs(w)));
    EXPECT_NEAR(static_cast<double>(TypeParam::dw_over_q(simd::F4(q))[3]), g, 1e-4 * (1 + std::abs(g)));
  }
}

/// r² w' integrated by parts: the Laplacian's integral over a ball is the flux through its surface.
template <class Kernel>
void expect_laplacian_matches_slope() {
  const double e = 1e-5;
  for (double q = 0.1; q < 0.95; q += 0.05) {
    auto flux = [](double r) { return r * r * kernel_slope<Kernel>(r, 1); };
    const double laplacian = (flux(q + e) - flux(q - e)) / (2 * e) / (q * q);
    EXPECT_NEAR(Kernel::norm * Kernel::laplacian(q), laplacian, 1e-5 * (1 + std::abs(laplacian)));
  }
}

TEST(Kernels, laplacians_match_slopes) {
  expect_laplacian_matches_slope<Poly6>();
  expect_laplacian_matches_slope<ViscosityKernel>();
}

TEST(Lattice, density_of_uncalibrated_particles) {
  EXPECT_NEAR(lattice_density<CubicSpline>(2), 0.99997, 1e-5);
  EXPECT_NEAR(lattice_density<CubicSpline>(2.5), 0.99852, 1e-5);
  EXPECT_NEAR(lattice_density<CubicSpline>(3), 1.00179, 1e-5);
  EXPECT_NEAR(lattice_density<CubicSpline>(4), 1.00008, 1e-5);
  EXPECT_NEAR(lattice_density<WendlandC2>(2), 1.03384, 1e-5);
  EXPECT_NEAR(lattice_density<WendlandC2>(2.5), 1.01337, 1e-5);
  EXPECT_NEAR(lattice_density<WendlandC2>(3), 1.00314, 1e-5);
  EXPECT_NEAR(lattice_density<WendlandC2>(4), 1.00055, 1e-5);
  EXPECT_NEAR(lattice_density<WendlandC4>(2), 1.06665, 1e-5);
  EXPECT_NEAR(lattice_density<WendlandC4>(2.5), 1.01056, 1e-5);
  EXPECT_NEAR(lattice_density<WendlandC4>(3), 1.00290, 1e-5);
  EXPECT_NEAR(lattice_density<WendlandC4>(4), 1.00031, 1e-5);
  EXPECT_NEAR(lattice_density<Poly6>(2), 1.00978, 1e-5);
  EXPECT_NEAR(lattice_density<Poly6>(2.5), 0.99543, 1e-5);
  EXPECT_NEAR(lattice_density<Poly6>(3), 1.00219, 1e-5);
  EXPECT_NEAR(lattice_density<Poly6>(4), 1.00000, 1e-5);
  EXPECT_NEAR(lattice_density<Spiky>(2), 1.23589, 1e-5);
  EXPECT_NEAR(lattice_density<Spiky>(2.5), 1.09623, 1e-5);
  EXPECT_NEAR(lattice_density<Spiky>(3), 1.04745, 1e-5);
  EXPECT_NEAR(lattice_density<Spiky>(4), 1.01482, 1e-5);
}

template <class Kernel>
void expect_stiffness(double at_2, double at_3, double at_4) {
  EXPECT_NEAR(pcisph_stiffness<Kernel>(2) / at_2, 1, 1e-4);
  EXPECT_NEAR(pcisph_stiffness<Kernel>(3) / at_3, 1, 1e-4);
  EXPECT_NEAR(pcisph_stiffness<Kernel>(4) / at_4, 1, 1e-4);
}

TEST(Lattice, stiffness_of_pcisph) {
  expect_stiffness<CubicSpline>(1.1769, 6.8908, 29.559);
  EXPECT_NEAR(pcisph_stiffness<CubicSpline>(2.5) / 2.9046, 1, 1e-4);
  expect_stiffness<WendlandC2>(1.0509, 5.2515, 21.268);
  expect_stiffness<WendlandC4>(0.8182, 2.7361, 10.618);
  expect_stiffness<Poly6>(1.6592, 12.836, 54.128);
  expect_stiffness<Spiky>(1.3391, 6.1980, 23.069);
  // δ [Pa per kg/m³] at dx = 5 mm, dt = 1 ms.
  EXPECT_NEAR(pcisph_stiffness<CubicSpline>(2) * 0.005 * 0.005 / 1e-6, 29.423, 1e-3);
}

template <class Kernel>
void expect_max_modes(const std::array<double, 5>& r) {
  const std::array<double, 5> ratios = {2, 2.2, 2.5, 3, 4};
  for (std::size_t i = 0; i < 5; ++i) EXPECT_NEAR(pcisph_max_mode<Kernel>(ratios[i]) / r[i], 1, 5e-3);
}

TEST(Lattice, largest_mode_of_the_pressure_loop) {
  expect_max_modes<CubicSpline>({1.41, 1.65, 2.19, 3.74, 8.80});
  expect_max_modes<WendlandC2>({1.30, 1.52, 1.92, 3.12, 7.16});
  expect_max_modes<WendlandC4>({1.08, 1.21, 1.47, 2.11, 4.67});
  expect_max_modes<Poly6>({1.88, 2.33, 3.04, 5.67, 13.3});
  expect_max_modes<Spiky>({1.41, 1.63, 2.09, 3.36, 7.21});
}

TEST(Lattice, relaxation_keeps_every_mode_stable) {
  for (double ratio = 1.5; ratio <= 4; ratio += 0.1) {
    const double omega = pcisph_relaxation<CubicSpline>(ratio);
    EXPECT_GT(omega, 0);
    EXPECT_LE(omega, 1);
    EXPECT_LE(omega * pcisph_max_mode<CubicSpline>(ratio), 1.4 + 1e-12);
  }
}

}  // namespace
}  // namespace oilskin::fluid
