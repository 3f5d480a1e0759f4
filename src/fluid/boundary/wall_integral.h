/// What a wall hides from a particle, for the cubic spline. Lengths in units of H, kernel masses relative to
/// ρ0.
#pragma once

#include <algorithm>
#include <array>

#include "oilskin/types.h"

namespace oilskin::fluid {

/// Kernel mass behind a plane at distance ζ ≥ 0, Λ(ζ) (B.1).
template <class T>
T half_space_mass(T z) {
  const T u = std::max(T(1) - z, T(0)), v = std::max(T(0.5) - z, T(0));
  return T(8.0 / 15) * (u * u * u * u * u * (T(1) + T(2) * z) - v * v * v * v * v * (T(2) + T(8) * z));
}

/// The kernel's integral over a plane at distance ζ ≥ 0, L(ζ) = −dΛ/dζ (B.2).
template <class T>
T plane_integral(T z) {
  const T u = std::max(T(1) - z, T(0)), v = std::max(T(0.5) - z, T(0));
  return T(8.0 / 5) * (u * u * u * u * (T(1) + T(4) * z) - v * v * v * v * (T(2) + T(16) * z));
}

/// −dL/dζ = 2π ζ W (B.3).
template <class T>
T plane_integral_slope(T z) {
  const T u = std::max(T(1) - z, T(0)), v = std::max(T(0.5) - z, T(0));
  return T(16) * z * (T(2) * u * u * u - T(8) * v * v * v);
}

/// A triangle as seen by a particle at the origin.
struct WallView {
  float distance = 1;                                ///< of the triangle's plane
  float share = 0;                                   ///< of what the whole plane would hide, 0 … 1
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  ///< of the plane, towards the particle
};

/// Corners relative to the particle. The share is λ_T/λ(z): the kernel's mass in the triangle's shadow
/// (B.7) over that behind its plane, so that the tiles of a plane add up to 1, without orientation
/// or closedness. In polar coordinates (r, φ) about the particle's foot in the plane the radial integral of
/// the shadow is λ again, and what is left is one integral along each edge,
///   λ_T = 1/(2π) Σ_edges ∫ [λ(z) − z λ(r)/r] dφ (B.9),
/// r = r(φ) at the edge: exact where summing over small triangles needs hundreds of them. 0 for a triangle
/// without area, and for one whose plane contains the particle, which hides nothing.
WallView view_of_wall(const std::array<Eigen::Vector3f, 3>& corners);

}  // namespace oilskin::fluid
