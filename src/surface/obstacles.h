/// All triangles of all obstacles under one numbering, and which of them may be near a box.
#pragma once

#include "oilskin/surface_mesh.h"
#include "proximity/surface_tree.h"

namespace oilskin::surface {

using Corners = std::array<Vec3, 3>;

/// The first fault of the obstacles, in words.
Status validate_obstacles(const std::vector<ObstacleMesh>& obstacles);

class Obstacles {
 public:
  /// Valid obstacles. Triangles keep their order; the vertices of mesh m follow those of mesh m − 1.
  explicit Obstacles(Span<const ObstacleMesh> meshes);

  bool empty() const { return triangles_.empty(); }
  std::size_t size() const { return triangles_.size(); }
  const Triangle& indices(std::uint32_t t) const { return triangles_[t]; }
  Corners corners(std::uint32_t t) const {
    const Triangle& i = triangles_[t];
    return {vertices_[i[0]], vertices_[i[1]], vertices_[i[2]]};
  }
  const Vec3& vertex(std::uint32_t v) const { return vertices_[v]; }
  Box bounds() const { return tree_.bounds(); }
  double largest_coordinate() const { return largest_; }

  /// Triangles whose boxes overlap the box, ascending.
  void query(const Box& box, std::vector<std::uint32_t>& triangles) const { tree_.query(box, triangles); }

  /// Connected pieces (over shared vertices): the vertices that triangles use, piece by piece.
  std::vector<std::vector<std::uint32_t>> pieces() const;

 private:
  std::vector<Vec3> vertices_;
  std::vector<Triangle> triangles_;
  proximity::SurfaceTree tree_;
  double largest_ = 0;
};

}  // namespace oilskin::surface
