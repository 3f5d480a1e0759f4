/// All triangles of all obstacles under one numbering, with queries by box.
#pragma once

#include "oilskin/reconstruction.h"
#include "proximity/surface_tree.h"

namespace oilskin::reconstruction {

using Corners = std::array<Vec3, 3>;

/// Refuses vertices and saturations that are not finite, indices out of range, and saturations of another
/// number than vertices.
Status validate_obstacles(const std::vector<ObstacleMesh>& obstacles);

/// The largest displacement of a triangle's corners by rounding to float (R.18) [m].
double rounding_of(const Corners& c);

/// Refuses triangles in the region with corners so far away that floats, or certified distances, are
/// inaccurate by more than half a cell.
Status validate_resolution(const std::vector<ObstacleMesh>& obstacles, const Box& region, double cell);

class Obstacles {
 public:
  Obstacles() = default;
  /// Meshes must be valid. Triangles keep their order; the vertices of mesh m follow those of mesh m − 1.
  explicit Obstacles(Span<const ObstacleMesh> meshes) { set(meshes, everywhere(), everywhere()); }
  /// Takes the triangles whose boxes overlap the region `larger`, unless these meshes are there already, with
  /// all triangles that overlap `region`. Returns whether it took them.
  bool set(Span<const ObstacleMesh> meshes, const Box& region, const Box& larger);
  void clear();

  bool empty() const { return triangles_.empty(); }
  std::size_t size() const { return triangles_.size(); }
  const Triangle& indices(std::uint32_t t) const { return triangles_[t]; }
  Corners corners(std::uint32_t t) const {
    const Triangle& i = triangles_[t];
    return {vertices_[i[0]], vertices_[i[1]], vertices_[i[2]]};
  }
  const Vec3& vertex(std::uint32_t v) const { return vertices_[v]; }
  /// ObstacleMesh::saturation of a vertex; −1 if its mesh has none.
  float saturation(std::uint32_t v) const { return saturation_.empty() ? -1.0f : saturation_[v]; }
  Box box(std::uint32_t t) const {
    Box box;
    for (std::uint32_t v : triangles_[t]) box.add(vertices_[v]);
    return box;
  }
  /// ‖float(c) − c‖ of its corners, at most (R.18) [m].
  double rounding(std::uint32_t t) const { return rounding_[t]; }
  /// Builds the tree for query() and bounds(), if it is not there.
  void prepare_queries(const Workers& workers) {
    if (!is_prepared_) tree_.update(triangles_, vertices_, vertices_, workers);
    is_prepared_ = true;
  }
  /// Computes the normals for normal(), if they are not there.
  void prepare_normals(const Workers& workers);
  /// Unit normal, or 0 of a triangle without area.
  const Vec3& normal(std::uint32_t t) const { return normals_[t]; }
  Box bounds() const { return tree_.bounds(); }
  /// Triangles whose boxes overlap the box, ascending.
  void query(const Box& box, std::vector<std::uint32_t>& triangles) const { tree_.query(box, triangles); }

  /// The vertices of each connected piece; triangles that share a vertex are connected. Kept for the next
  /// call, so not for several threads.
  const std::vector<std::vector<std::uint32_t>>& pieces() const;
  std::size_t bytes() const;

 private:
  static Box everywhere() { return {Box().max, Box().min}; }

  bool has(Span<const ObstacleMesh> meshes, const Box& region) const;
  void add(const ObstacleMesh& mesh);
  void add_saturation(const ObstacleMesh& mesh);
  std::vector<std::vector<std::uint32_t>> find_pieces() const;

  std::vector<Vec3> vertices_;
  std::vector<float> saturation_;  // empty if no mesh has one
  std::vector<Triangle> triangles_;
  std::vector<double> rounding_;
  std::vector<Vec3> normals_;  // empty if not prepared
  // As given: vertices and triangles of each mesh, all triangles, and where they were taken from.
  std::vector<std::array<std::size_t, 3>> counts_;
  std::vector<Triangle> given_;
  Box region_;
  mutable std::vector<std::vector<std::uint32_t>> pieces_;
  mutable bool has_pieces_ = false;
  bool is_prepared_ = false;
  proximity::SurfaceTree tree_;
};

}  // namespace oilskin::reconstruction
