/// Particles do not interact through a surface: pairs whose connecting segment intersects a triangle are
/// removed from both neighbour lists, so that no pair sum of the step includes them (F.8).
#pragma once

#include <cmath>

#include "core/parallel.h"
#include "core/segment_triangle.h"
#include "fluid/neighbours.h"
#include "fluid/triangle_cells.h"
#include "oilskin/surface_motion.h"

namespace oilskin::fluid {

/// Intersection test of closed segments with one closed triangle. Watertight at shared edges and vertices. A
/// triangle without area hides nothing.
class SightTest {
 public:
  SightTest(const SurfaceMotion& surface, std::uint32_t triangle);

  /// Six times the signed volume of the tetrahedron with x: its sign is the side on which x lies.
  double side(const Vec3& x) const { return normal_.dot(x - corner_[0]); }
  double normal_length() const { return normal_length_; }
  const Vec3& normal() const { return normal_; }  ///< not normalised
  const std::array<Vec3, 3>& corners() const { return corner_; }
  /// Does the segment p q intersect the triangle? side_p = side(p), side_q = side(q). Rounding may depend on
  /// the order of p and q, which callers therefore fix.
  bool blocks(const Vec3& p, const Vec3& q, double side_p, double side_q) const {
    return segment_touches(p, q, corner_, nodes_, normal_, side_p, side_q);
  }

 private:
  std::array<Vec3, 3> corner_;
  Triangle nodes_;
  Vec3 normal_;
  double normal_length_ = 0;
};

/// Removes from the lists the pairs that surfaces at x_t0 hide. `x` are the positions that the neighbours
/// were searched for. Only triangles with particles within H on both sides are tested. `cells`: of the
/// surfaces. Returns the number of pairs.
std::uint64_t remove_hidden_neighbours(Span<const Vec3> x, Span<SurfaceMotion* const> surfaces,
                                       const TriangleCells& cells, double support_radius,
                                       Neighbours& neighbours, const Workers& workers);

}  // namespace oilskin::fluid
