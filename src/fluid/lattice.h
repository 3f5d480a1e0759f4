/// Sums over the cubic lattice, the prototype of a filled neighbourhood: mass, stiffness δ of PCISPH, and how
/// far δ must be relaxed. Lengths in units of the spacing: `ratio` = H/dx.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "fluid/kernels.h"

namespace oilskin::fluid {

/// Σ_k f(q_k) over the lattice points within the support radius, the origin among them.
template <class F>
double lattice_sum(double ratio, const F& f) {
  const int n = static_cast<int>(std::ceil(ratio));
  double sum = 0;
  for (int a = -n; a <= n; ++a)
    for (int b = -n; b <= n; ++b)
      for (int c = -n; c <= n; ++c) {
        const double q = std::sqrt(static_cast<double>(a * a + b * b + c * c)) / ratio;
        if (q < 1) sum += f(q);
      }
  return sum;
}

/// Density of the lattice with m = ρ0 dx³, relative to ρ0. Dividing dx³ ρ0 by it calibrates the mass (A.1).
template <class Kernel>
double lattice_density(double ratio) {
  return Kernel::norm / (ratio * ratio * ratio) * lattice_sum(ratio, [](double q) { return Kernel::w(q); });
}

/// G = Σ |w'|², so that Σ|∇W|² = (c/H)² G.
template <class Kernel>
double lattice_slope_squares(double ratio) {
  return lattice_sum(ratio, [](double q) { return std::pow(q * Kernel::dw_over_q(q), 2); });
}

/// δ dt² [m²] in units of dx², for particles of volume dx³ [Solenthaler, Pajarola 2009, Eq. 8]:
/// δ = 1/(β Σ|∇W|²) with β = 2 (m dt/ρ0)²; Σ∇W = 0 by symmetry.
template <class Kernel>
double pcisph_stiffness(double ratio) {
  return std::pow(ratio, 8) / (2 * Kernel::norm * Kernel::norm * lattice_slope_squares<Kernel>(ratio));
}

/// max_k R(k): the loop multiplies a pressure mode of wave vector k by 1 − ω R(k) per iteration,
/// R = |S|²/(2 Σ|∇W|²), S = Σ_r ∇W(r) sin(k·r). Scanned over k ∈ [0, π/dx]³ with `samples` per axis.
template <class Kernel>
double pcisph_largest_mode(double ratio, int samples = 41) {
  const int n = static_cast<int>(std::ceil(ratio));
  std::vector<std::array<double, 2>> wave(static_cast<std::size_t>(samples * (n + 1)));  // cos, sin of k·a
  for (int s = 0; s < samples; ++s)
    for (int a = 0; a <= n; ++a) {
      const double angle = pi * s / (samples - 1) * a;
      wave[static_cast<std::size_t>(s * (n + 1) + a)] = {std::cos(angle), std::sin(angle)};
    }
  struct Site {
    int a, b, c;
    double slope;  // (w'/q)/ratio × how many of the mirror images are distinct
  };
  std::vector<Site> sites;  // mirror images: sin(k·r) ∇W sums to a product of one sine and two cosines
  for (int a = 0; a <= n; ++a)
    for (int b = 0; b <= n; ++b)
      for (int c = 0; c <= n; ++c) {
        const double q = std::sqrt(static_cast<double>(a * a + b * b + c * c)) / ratio;
        if (q == 0 || q >= 1) continue;
        const int images = (a ? 2 : 1) * (b ? 2 : 1) * (c ? 2 : 1);
        sites.push_back({a, b, c, Kernel::dw_over_q(q) / ratio * images});
      }
  double largest = 0;
  for (int i = 0; i < samples; ++i)
    for (int j = 0; j <= i; ++j)
      for (int k = 0; k <= j; ++k) {  // R is symmetric in the components of k
        double sx = 0, sy = 0, sz = 0;
        for (const Site& t : sites) {
          const auto& x = wave[static_cast<std::size_t>(i * (n + 1) + t.a)];
          const auto& y = wave[static_cast<std::size_t>(j * (n + 1) + t.b)];
          const auto& z = wave[static_cast<std::size_t>(k * (n + 1) + t.c)];
          sx += t.slope * t.a * x[1] * y[0] * z[0];
          sy += t.slope * t.b * x[0] * y[1] * z[0];
          sz += t.slope * t.c * x[0] * y[0] * z[1];
        }
        largest = std::max(largest, sx * sx + sy * sy + sz * sz);
      }
  return largest / (2 * lattice_slope_squares<Kernel>(ratio));
}

/// ω = min(1, 1.4/max R). The loop converges for ω max R < 2; 1.4 is what the published δ (ω = 1) has at H =
/// 2 dx, where it is known to be stable with room for compressed regions, whose modes are larger.
template <class Kernel>
double pcisph_relaxation(double ratio) {
  return std::min(1.0, 1.4 / pcisph_largest_mode<Kernel>(ratio));
}

}  // namespace oilskin::fluid
