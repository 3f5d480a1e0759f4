/// The forces of surface tension. Lengths in units of H, q = r/H and ζ = z/H; forces between particles in
/// units of c_σ σ V_i V_j/H⁵, forces of walls in units of c_σ σ V_i/H². c_σ is `calibration`.
#pragma once

#include <algorithm>
#include <cmath>

#include "fluid/kernels.h"

namespace oilskin::effects {

/// c_σ: with it the parts below give drops at H = 2 dx the frequency of σ. Measured, as are the parts:
/// docs/decisions/0025-surface-tension.md.
constexpr double calibration = 0.375;

/// Each part as the surface tension of a fluid with a sharp border and without order, over c_σ σ.
constexpr double part_of_lack = 0.7, part_of_slope = 0.6;

/// The kernel of (S.1), w = 105/(32π) (1 − q²)²: wider than that of the density.
struct LackKernel {
  static constexpr double norm = 105 / (32 * fluid::pi);
  static double value(double q) {
    const double u = std::max(1 - q * q, 0.0);
    return norm * u * u;
  }
  static double slope_over_q(double q) { return -4 * norm * std::max(1 - q * q, 0.0); }
  /// Its integral over a plane at the distance ζ.
  static double plane(double z) {
    const double u = std::max(1 - z * z, 0.0);
    return fluid::pi / 3 * norm * u * u * u;
  }
  /// Over the half-space behind the plane: ½ at ζ = 0.
  static double half_space(double z) {
    if (z >= 1) return 0;
    const double z2 = z * z;
    return 0.5 - fluid::pi / 3 * norm * z * (1 - z2 * (1 - z2 * (0.6 - z2 / 7)));
  }
  /// 2/∫ half_space² dζ from 0 to 1.
  static constexpr double energy = 48.0785;
};

/// The kernel of (S.2), Wendland's C²: W'(q)/q and (W'(q)/q)'/q.
struct SlopeKernel {
  static constexpr double norm = fluid::WendlandC2::norm;
  static double first(double q) { return norm * fluid::WendlandC2::dw_over_q(q); }
  static double second(double q) {
    const double u = std::max(1 - q, 0.0);
    return norm * 60 * u * u / std::max(q, static_cast<double>(fluid::min_q));
  }
  /// Its integral over a plane at the distance ζ, which is the slope at ζ within a fluid.
  static double plane(double z) { return fluid::WendlandC2::plane(z); }
  static double plane_derivative(double z) {
    const double u = std::max(1 - z, 0.0);
    return -u * u * u * u * (105 - u * (189 - 84 * u));
  }
  /// 2/∫ plane² dζ from 0 to 1.
  static constexpr double energy = 2 / (441. / 11 - 2 * 21 * 31.5 / 12 + (31.5 * 31.5 + 2 * 21 * 12) / 13 -
                                        2 * 31.5 * 12 / 14 + 144. / 15);
};

constexpr double energy_of_lack = part_of_lack * LackKernel::energy;
constexpr double energy_of_slope = part_of_slope * SlopeKernel::energy;

/// A_w(ζ) (S.6): the pull of a half-space behind a plane by −w' of the cubic spline, in a measure that makes
/// its work of separation 2. Nearer than ζ_0 the fluid's first layer would be, were there fluid, and the pull
/// falls to 0 at the plane.
inline double half_space_attraction(double z) {
  constexpr double first_layer = 0.25, scale = 560. / 31;  // 1/∫ q⁴ (−w') dq
  const double u = std::max(1 - z, 0.0), v = std::max(0.5 - z, 0.0);
  const double u4 = u * u * u * u, v4 = v * v * v * v;
  return std::min(1.0, z / first_layer) * 1.6 * scale * (u4 * (1 + 4 * z) - v4 * (2 + 16 * z));
}

/// What a wall is for a particle (S.7).
struct WallParts {
  double attraction;  ///< κ_w
  double fluid;       ///< k: the part of a fluid that it is for (S.1) and (S.2)
};
inline WallParts wall_parts(double contact_angle) {
  const double c = 0.5 * (1 + std::cos(contact_angle * fluid::pi / 180));
  return {c * c * (1.03 + 2.3 * c * (1 - c)), std::pow(c, 1.2)};
}

/// t of (S.8): 0 where the shares of the walls add up to a plane, 1 where 0.1 of it is missing.
inline double part_of_rim(double sum_of_shares) {
  return std::clamp(10 * (0.99 - sum_of_shares), 0.0, 1.0);
}

/// Of intervals, over √(ρ0 dx³/σ) (S.9).
constexpr double longest_interval = 0.25;

}  // namespace oilskin::effects
