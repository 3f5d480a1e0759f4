/// Integrals of the cubic spline over walls. Lengths in units of H, kernel masses relative to ρ0.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "fluid/pairs/pair_kernels.h"
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

/// Kernel mass beyond the distance r ≥ 0 in all directions, ϖ(r) = 2 (Λ(r) + r L(r)) (B.41).
template <class T>
T mass_beyond(T r) {
  return T(2) * (half_space_mass(r) + r * plane_integral(r));
}

/// −dL/dζ = 2π ζ W (B.3).
template <class T>
T plane_integral_slope(T z) {
  const T u = std::max(T(1) - z, T(0)), v = std::max(T(0.5) - z, T(0));
  return T(16) * z * (T(2) * u * u * u - T(8) * v * v * v);
}

/// The plane of a triangle near a particle at the origin.
struct WallPlane {
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  ///< by the order of the corners; 0 without area
  float offset = 0;                                  ///< normal · corner

  explicit WallPlane(const std::array<Eigen::Vector3f, 3>& corners);
  /// False for a triangle without area, one whose plane contains the particle, and one out of reach.
  bool acts() const { return offset != 0 && distance() < 1; }
  float distance() const { return std::abs(offset); }
  Eigen::Vector3f to_particle() const { return offset > 0 ? Eigen::Vector3f(-normal) : normal; }
};

/// A triangle near a particle at the origin.
struct WallView {
  float distance = 1;                                ///< of the triangle's plane
  float share = 0;                                   ///< S_T: of the effect of the whole plane, 0 … 1
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  ///< of the plane, towards the particle
};

/// 2π Λ of polygons: the kernel masses in their shadows. In polar coordinates (r, ϕ) about the particle's
/// foot in the plane the radial integral is known, and one integral along each edge remains (B.9),
///   Λ_T = 1/(2π) Σ_edges ∫ [Λ(ζ) − ζ Λ(r)/r] dϕ.
/// A sum over small triangles needs hundreds of them for the same accuracy.
class Shadows {
 public:
  void clear();
  /// The polygon lies in a plane that acts(); its corners are in the order of the plane's normal.
  void add(const WallPlane& plane, Span<const Eigen::Vector3f> polygon);
  std::size_t size() const { return end_.size(); }
  /// Of all that were added.
  void integrate();
  /// Of polygon k, after integrate().
  float operator[](std::size_t k) const;

 private:
  std::vector<EdgeBlock> blocks_;
  std::size_t edges_ = 0;
  std::vector<std::size_t> end_;  // in edges, per polygon
  std::vector<float> integral_;   // per edge
};

/// S_T = Λ_T/Λ(ζ) (B.7), for a mass 2π Λ_T: the kernel mass in the triangle's shadow over that behind its
/// plane, so that the shares of the tiles of a plane add up to 1, for any orientation and also for open
/// meshes.
WallView view_with_shadow(const WallPlane& plane, float shadow);

}  // namespace oilskin::fluid
