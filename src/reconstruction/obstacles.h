/// All triangles of all obstacles under one numbering, and which of them may be near a box.
#pragma once

#include "oilskin/reconstruction.h"
#include "proximity/surface_tree.h"

namespace oilskin::reconstruction {

using Corners = std::array<Vec3, 3>;

/// The first fault of the obstacles, in words.
Status validate_obstacles(const std::vector<ObstacleMesh>& obstacles);

/// By how much rounding to float moves a triangle's corners at most (R.18) [m].
double rounding_of(const Corners& c);

/// Refuses triangles that come into the region from so far away that their corners, as floats, or distances
/// to them are not known to half a cell.
Status validate_resolution(const std::vector<ObstacleMesh>& obstacles, const Box& region, double cell);

class Obstacles {
 public:
  Obstacles() = default;
  /// Valid obstacles. Triangles keep their order; the vertices of mesh m follow those of mesh m − 1.
  explicit Obstacles(Span<const ObstacleMesh> meshes) : Obstacles(meshes, everywhere()) {}
  /// Only triangles whose boxes overlap the region.
  Obstacles(Span<const ObstacleMesh> meshes, const Box& region);

  bool empty() const { return triangles_.empty(); }
  std::size_t size() const { return triangles_.size(); }
  const Triangle& indices(std::uint32_t t) const { return triangles_[t]; }
  Corners corners(std::uint32_t t) const {
    const Triangle& i = triangles_[t];
    return {vertices_[i[0]], vertices_[i[1]], vertices_[i[2]]};
  }
  const Vec3& vertex(std::uint32_t v) const { return vertices_[v]; }
  Box box(std::uint32_t t) const {
    Box box;
    for (std::uint32_t v : triangles_[t]) box.add(vertices_[v]);
    return box;
  }
  /// Builds what query() and bounds() look into.
  void prepare_queries() { tree_.update(triangles_, vertices_, vertices_); }
  Box bounds() const { return tree_.bounds(); }
  /// Triangles whose boxes overlap the box, ascending.
  void query(const Box& box, std::vector<std::uint32_t>& triangles) const { tree_.query(box, triangles); }

  /// Connected pieces (over shared vertices): the vertices that triangles use, piece by piece.
  std::vector<std::vector<std::uint32_t>> pieces() const;

 private:
  static Box everywhere() { return {Box().max, Box().min}; }

  std::vector<Vec3> vertices_;
  std::vector<Triangle> triangles_;
  proximity::SurfaceTree tree_;
};

}  // namespace oilskin::reconstruction
