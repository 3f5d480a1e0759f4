/// The image model: a wall continues the fluid as its mirror image.
///
/// For a particle at distance z from a plane the first layer of the image lies at 2 z and adds
/// λ(z) = κ L(2 a z/H) to the relative density (B.4). The force follows from the same function, γ = −H ∇λ
/// (B.5), so that a wall does no net work on fluid at rest. κ and a are such that a lattice that ends half a
/// spacing off the wall has its rest density and a uniform pressure (B.6).
///
/// A half-space of fluid behind the wall with mirrored pressure, Λ of (B.1), has the right density and the
/// right force as well, but its force is twice its slope: columns at rest boil
/// (docs/decisions/0001-mirrored-boundary.md).
#pragma once

#include "fluid/boundary/wall_integral.h"

namespace oilskin::fluid {

class MirrorImage {
 public:
  /// |γ| of the image over that of the lattice, half a spacing off the wall (B.6). The first layer of settled
  /// fluid lies 0.525 dx off the wall, where λ is less steep, with a few more particles than the
  /// lattice: 1.02 to 1.04 give it the pressure of the fluid around it.
  static constexpr double settled_pull = 1.03;

  /// What walls that face each other take off their sum, over what a square lattice needs (B.42): particles
  /// in a slot are not always in its middle. With 1.1 a slot of half a spacing takes its volume of water.
  static constexpr double settled_slot = 1.1;

  /// `support_ratio` H/dx of the lattice.
  explicit MirrorImage(double support_ratio);
  /// Not the image of a fluid: λ = L(ζ), which reaches the whole support radius, for shares and distances.
  static MirrorImage of_full_reach() { return {}; }

  /// Distance [m] from which on λ and γ are 0.
  double reach(double support_radius) const { return support_radius / static_cast<double>(offset_); }
  bool reaches(float distance) const { return offset_ * distance < 1; }

  /// λ_T and |γ_T| (B.7) of the share S_T of a plane at the distance ζ.
  float lambda(float distance, float share) const {
    return mass_ * share * plane_integral(offset_ * distance);
  }
  float gamma(float distance, float share) const {
    return offset_ * mass_ * share * plane_integral_slope(offset_ * distance);
  }
  /// c of (B.42).
  float both() const { return both_; }

 private:
  MirrorImage() = default;

  float mass_ = 1, offset_ = 1, both_ = 0;  // κ, 2 a, c
};

}  // namespace oilskin::fluid
