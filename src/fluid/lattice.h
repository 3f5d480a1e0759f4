/// Sums over the cubic lattice, the prototype of a full neighbourhood: density, stiffness δ of PCISPH and its
/// relaxation ω, weights of the viscosity. Lengths in units of the spacing: `ratio` = H/dx.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "fluid/kernels.h"

namespace oilskin::fluid {

/// Σ_k f(q_k) over the lattice points within the support radius, including the origin.
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

/// Density of the lattice with m = ρ0 dx³, relative to ρ0. V = dx³ over this (F.4).
template <class Kernel>
double lattice_density(double ratio) {
  return Kernel::norm / (ratio * ratio * ratio) * lattice_sum(ratio, [](double q) { return Kernel::w(q); });
}

/// G = Σ |w'|², so that Σ|∇W|² = (c/H)² G.
template <class Kernel>
double lattice_slope_squares(double ratio) {
  return lattice_sum(ratio, [](double q) { return std::pow(q * Kernel::dw_over_q(q), 2); });
}

/// Σ w over a plane layer of particles, a square lattice of the spacing 1/√thickness, relative to the sum
/// over the cubic lattice: what a slot of that thickness [dx] has of its particles, full of fluid (B.42).
template <class Kernel>
double lattice_layer(double ratio, double thickness) {
  const double spacing = 1 / std::sqrt(thickness);
  const int n = static_cast<int>(std::ceil(ratio / spacing));
  double sum = 0;
  for (int a = -n; a <= n; ++a)
    for (int b = -n; b <= n; ++b) {
      const double q = spacing * std::sqrt(static_cast<double>(a * a + b * b)) / ratio;
      if (q < 1) sum += Kernel::w(q);
    }
  return sum / lattice_sum(ratio, [](double q) { return Kernel::w(q); });
}

/// Σ w over the lattice points beyond a plane half a spacing away, relative to the sum over all: the density
/// that a half-space of the lattice lacks there (B.6).
template <class Kernel>
double lattice_mass_beyond(double ratio) {
  return 0.5 * (1 - lattice_layer<Kernel>(ratio, 1));  // without the plane through the origin
}

/// −(1/3) Σ q w'(q) over Σ w of the cubic lattice, the mean of the cubic lattice and of the face-centred
/// cubic lattice of the same density: the pressure with which settled water pushes, over that of its
/// equations in the limit of many neighbours (F.15). Settled water is between the two.
template <class Kernel>
double settled_virial(double ratio) {
  const auto virial = [](double q) { return -q * q * Kernel::dw_over_q(q) / 3; };
  const double cubic = lattice_sum(ratio, virial);
  const double half = 0.5 * std::cbrt(4.0);  // of the edge of the cell with four points
  const int n = static_cast<int>(std::ceil(2 * ratio));
  double centred = 0;
  for (int a = -n; a <= n; ++a)
    for (int b = -n; b <= n; ++b)
      for (int c = -n; c <= n; ++c) {
        const double q = half * std::sqrt(static_cast<double>(a * a + b * b + c * c)) / ratio;
        if ((a + b + c) % 2 == 0 && q < 1) centred += virial(q);
      }
  return 0.5 * (cubic + centred) / lattice_sum(ratio, [](double q) { return Kernel::w(q); });
}

/// Weights of the two parts of the viscous pair term ψ(q) = slope (−w'/q)/(q² + 0.01) + hat (1 − q)² (F.10).
struct ViscousWeights {
  double slope = 0, hat = 1;
};

/// The conditions (F.11): Σ ψ q⁴ = 15 gives the lattice the viscosity ν, and, where weights ≥ 0 allow it,
/// Σ ψ x⁴ = 3 Σ ψ x²y² makes it isotropic. (Monaghan's form, the first part alone, has 0.70 ν for shear along
/// the axes at H = 2 dx and 1.43 ν at 45°.) The term is central, so that it conserves angular momentum.
/// Lengths in H.
template <class Kernel>
ViscousWeights viscous_weights(double ratio) {
  struct Moments {
    double fourth = 0, mixed = 0;  // Σ f x⁴, Σ f x²y²
  };
  const auto moments = [&](const auto& f) {
    Moments m;
    const int n = static_cast<int>(std::ceil(ratio));
    for (int a = -n; a <= n; ++a)
      for (int b = -n; b <= n; ++b)
        for (int c = -n; c <= n; ++c) {
          const double q = std::sqrt(static_cast<double>(a * a + b * b + c * c)) / ratio;
          if (q == 0 || q >= 1) continue;
          m.fourth += f(q) * std::pow(a / ratio, 4);
          m.mixed += f(q) * std::pow(a * b / (ratio * ratio), 2);
        }
    return m;
  };
  const Moments s = moments([](double q) { return -Kernel::dw_over_q(q) / (q * q + 0.01); });
  const Moments h = moments([](double q) { return (1 - q) * (1 - q); });
  ViscousWeights w{3 * h.mixed - h.fourth, s.fourth - 3 * s.mixed};
  if (w.slope * w.hat <= 0) w = {0, 1};
  const double mean = (w.slope * (3 * s.fourth + 6 * s.mixed) + w.hat * (3 * h.fourth + 6 * h.mixed)) / 15;
  return {w.slope / mean, w.hat / mean};
}

/// H V |Σ ∇W| over the lattice points beyond a plane half a spacing away (B.6): their part of the density
/// gradient.
template <class Kernel>
double lattice_pull_beyond(double ratio) {
  const int n = static_cast<int>(std::ceil(ratio));
  double pull = 0;
  for (int a = -n; a <= n; ++a)
    for (int b = -n; b <= n; ++b)
      for (int c = 1; c <= n; ++c) {
        const double q = std::sqrt(static_cast<double>(a * a + b * b + c * c)) / ratio;
        if (q < 1) pull -= Kernel::dw_over_q(q) * c / ratio;
      }
  return pull / lattice_sum(ratio, [](double q) { return Kernel::w(q); });
}

/// δ dt² [m²] in units of dx², for particles of volume dx³ [Solenthaler2009] Eq. 8, (F.17):
/// δ = 1/(β Σ|∇W|²) with β = 2 (m dt/ρ0)²; Σ∇W = 0 by symmetry.
template <class Kernel>
double pcisph_stiffness(double ratio) {
  return std::pow(ratio, 8) / (2 * Kernel::norm * Kernel::norm * lattice_slope_squares<Kernel>(ratio));
}

/// max_ξ Γ(ξ): an iteration multiplies the error of the pressure mode with wave vector ξ by 1 − ω Γ(ξ)
/// (F.21), Γ = |Z|²/(2 Σ|∇W|²), Z = Σ_r ∇W(r) sin(ξ·r). Scanned over ξ ∈ [0, π/dx]³ with `samples` per axis.
template <class Kernel>
double pcisph_max_mode(double ratio, int samples = 41) {
  const int n = static_cast<int>(std::ceil(ratio));
  std::vector<std::array<double, 2>> wave(static_cast<std::size_t>(samples * (n + 1)));  // cos, sin of ξ a
  for (int s = 0; s < samples; ++s)
    for (int a = 0; a <= n; ++a) {
      const double angle = pi * s / (samples - 1) * a;
      wave[static_cast<std::size_t>(s * (n + 1) + a)] = {std::cos(angle), std::sin(angle)};
    }
  struct Site {
    int a, b, c;
    double slope;  // (w'/q)/ratio × number of distinct mirror images
  };
  std::vector<Site> sites;  // over mirror images sin(ξ·r) ∇W sums to products of one sine and two cosines
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
      for (int k = 0; k <= j; ++k) {  // Γ is symmetric in the components of ξ
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

/// ω = min(1, 1.4/max Γ) (F.22). The loop converges for ω max Γ < 2; 1.4 is the value of the published δ (ω =
/// 1) at H = 2 dx, where it is known to be stable, with a margin for compressed regions, whose Γ is larger.
template <class Kernel>
double pcisph_relaxation(double ratio) {
  return std::min(1.0, 1.4 / pcisph_max_mode<Kernel>(ratio));
}

}  // namespace oilskin::fluid
