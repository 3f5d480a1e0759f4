/// Which of the triangles near a particle the particle does not see.
#pragma once

#include <vector>

#include "fluid/boundary/near_triangles.h"
#include "fluid/occlusion.h"

namespace oilskin::fluid {

class WallVisibility {
 public:
  /// `near` are the triangles near the particle at x, in the order of NearTriangles.
  WallVisibility(const BoundaryInput& input, const Vec3& x, Span<const NearTriangle> near);

  /// Layers behind a layer, floors that continue behind a wall, and sheets that lie on a sheet are hidden:
  /// another triangle blocks the line to the closest point of the k-th, or an earlier one has the same
  /// closest point and direction. Triangles that share a node do not hide each other.
  bool is_hidden(std::size_t k) const;

 private:
  bool adjoin(std::size_t a, std::size_t b) const;
  bool have_same_closest_point(std::size_t a, std::size_t b) const;
  bool lies_on_earlier(std::size_t k) const;
  bool is_blocked_by(std::size_t k, std::size_t other) const;

  const Vec3 x_;
  const Span<SurfaceMotion* const> surfaces_;
  const Span<const NearTriangle> near_;
  const double tolerance_;  // [m]
  std::vector<SightTest> test_;
  std::vector<double> own_side_;
  std::vector<std::size_t> by_distance_;
};

}  // namespace oilskin::fluid
