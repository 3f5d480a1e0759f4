/// Nothing acts through a surface: neighbour pairs whose connecting segment meets a triangle are taken off
/// the neighbour lists, both ways, so that no pair sum of the step sees them (F.8).
#pragma once

#include <cmath>

#include "core/parallel.h"
#include "core/segment_triangle.h"
#include "fluid/neighbours.h"
#include "oilskin/surface_motion.h"

namespace oilskin::fluid {

/// Does the closed segment meet the closed triangle? Watertight over shared edges and vertices. Triangles
/// without area hide nothing.
class SightTest {
 public:
  SightTest(const SurfaceMotion& surface, std::uint32_t triangle);

  /// Six times the volume over the triangle, signed: the side on which x lies.
  double side(const Vec3& x) const { return normal_.dot(x - corner_[0]); }
  double normal_length() const { return normal_length_; }
  /// Up to 2.5 degrees. False where one has no area.
  bool is_parallel_to(const SightTest& other) const {
    return std::abs(normal_.dot(other.normal_)) > 0.999 * normal_length_ * other.normal_length_;
  }
  /// `side_p`, `side_q` as side() gave them. Symmetric in p and q up to their order; callers fix it.
  bool blocks(const Vec3& p, const Vec3& q, double side_p, double side_q) const {
    return segment_touches(p, q, corner_, nodes_, normal_, side_p, side_q);
  }

 private:
  std::array<Vec3, 3> corner_;
  Triangle nodes_;
  Vec3 normal_;
  double normal_length_ = 0;
};

/// Takes off the lists what the surfaces at x_t0 hide. `x` are the positions that the neighbours were
/// searched for. Only triangles with water on both sides within H are looked at closely. Returns the number
/// of pairs.
std::uint64_t remove_hidden_neighbours(Span<const Vec3> x, Span<SurfaceMotion* const> surfaces,
                                       double support_radius, Neighbours& neighbours, const Workers& workers);

}  // namespace oilskin::fluid
