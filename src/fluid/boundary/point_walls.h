/// The walls of one particle, from the triangles near it.
#pragma once

#include "fluid/boundary/visible_part.h"
#include "fluid/boundary/wall_geometry.h"

namespace oilskin::fluid {

class PointWalls {
 public:
  /// Walls are appended to `walls`, their sums written to `point`.
  PointWalls(const BoundaryInput& input, const MirrorImage& image, Span<const NearTriangle> near,
             WallPoint& point, std::vector<Wall>& walls);

  /// `near` are the triangles whose plane is within reach. False, and no walls, if the particle may see one
  /// of them in part only.
  bool find_unhidden(VisibleParts& parts);
  /// `near` are all triangles within H.
  void find_visible(VisibleParts& parts);

 private:
  bool is_plane() const;
  bool any_hides(VisibleParts& parts) const;
  bool may_be_hidden() const;
  bool may_be_hidden(const NearTriangle& near) const;
  double side(const NearTriangle& near, std::uint32_t triangle) const;
  void add_plane();
  void add_triangles();
  void limit_density();
  void add(const NearTriangle& near, const WallView& view);
  std::array<Eigen::Vector3f, 3> corners(const NearTriangle& near) const;
  bool has_free_node(const NearTriangle& near) const;
  float nearest_distance() const {
    return static_cast<float>(nearest_.closest.distance / input_.support_radius);
  }

  const BoundaryInput& input_;
  const MirrorImage& image_;
  const Span<const NearTriangle> near_;
  const NearTriangle& nearest_;
  const Vec3 x_;
  WallPoint& point_;
  std::vector<Wall>& walls_;
};

}  // namespace oilskin::fluid
