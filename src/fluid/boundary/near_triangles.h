/// The triangles near a particle.
#pragma once

#include <vector>

#include "core/closest_point.h"
#include "fluid/triangle_cells.h"

namespace oilskin::fluid {

/// Triangles farther from a particle than this do not count [H]: of the kernel mass behind a plane at 0.25 H
/// they hide 2·10⁻⁴, and they would be a quarter of all triangles.
constexpr double triangle_reach = 0.85;

/// What the boundary terms of an interval are computed from.
struct BoundaryInput {
  double passed = 0;                           ///< from the start of the step to the end of the interval [s]
  double dt = 0;                               ///< of the interval [s]
  double particle_mass = 0;                    ///< [kg]
  double support_radius = 0;                   ///< H [m]
  Vec3 down = Vec3::Zero();                    ///< direction of gravity, or zero
  Span<const Vec3> x;                          ///< positions [m] that the neighbours were searched for
  Span<SurfaceMotion* const> surfaces;         ///< walls at x_t0, which move to x_t1 within dt
  Span<const MeshTopology* const> topologies;  ///< of the surfaces, in their order
  const TriangleCells& cells;                  ///< of the surfaces
};

/// Spheres and planes of the triangles near a cell, without duplicates, for a quick test.
class CellTriangles {
 public:
  void read(const TriangleCells& cells, const TriangleCells::Cell& cell, double support_radius);

  const TriangleCells& cells() const { return *cells_; }
  double support_radius() const { return support_radius_; }
  /// The triangles that may be within triangle_reach of x, and whose planes may be within `plane_reach` [m],
  /// to `found`: indices into cells().triangles(), ascending. Returns their number.
  std::size_t find(const Vec3& x, double plane_reach, std::vector<std::uint32_t>& found) const;

 private:
  void resize(std::size_t count);
  void write(std::size_t k, const NearbyTriangle& triangle, const Vec3& corner);

  const TriangleCells* cells_ = nullptr;
  double support_radius_ = 1;
  Vec3 origin_ = Vec3::Zero();
  double slack_ = 0;  // by which floats may be wrong [H]
  std::size_t count_ = 0;
  std::array<std::vector<float>, 8> column_;  // as in TriangleColumns
  std::vector<std::uint32_t> number_;
};

/// The triangles within triangle_reach of one particle, in the order of surfaces and triangles. The memory is
/// kept from search to search.
class NearTriangles {
 public:
  /// Those whose plane is nearer than `plane_reach` [m].
  void find(const CellTriangles& cell, const Vec3& x, double plane_reach);
  /// Drops the triangles of closed parts that turn their other side to the particle than the part's nearest
  /// triangles: other triangles of the part hide them. Needs all triangles within triangle_reach.
  void drop_turned_away(const Vec3& x);

  std::size_t size() const { return at_.size(); }
  bool empty() const { return at_.empty(); }
  const NearbyTriangle& triangle(std::size_t k) const { return triangles_[index_[at_[k]]]; }
  const Corners& corners(std::size_t k) const { return corners_[index_[at_[k]]]; }
  double distance(std::size_t k) const { return block(k).distance[at_[k] % 4]; }
  /// From the closest point to the particle [m].
  Vec3 offset(std::size_t k) const {
    const ClosestBlock& b = block(k);
    const std::size_t lane = at_[k] % 4;
    return {b.offset[0][lane], b.offset[1][lane], b.offset[2][lane]};
  }
  /// Barycentric, of a corner at the closest point.
  double weight(std::size_t k, std::size_t corner) const { return block(k).weight[corner][at_[k] % 4]; }
  /// Its sign says on which side of the triangle x is.
  double side(std::size_t k, const Vec3& x) const;
  /// Is the closest point off the edges?
  bool is_on_face(std::size_t k) const { return weight(k, 0) != 0 && weight(k, 1) != 0 && weight(k, 2) != 0; }

 private:
  /// A closed part of a surface, and the side of its triangles that the particle sees.
  struct ClosedPart {
    std::uint32_t surface, part;
    double distance;   // [m]
    bool front, back;  // which sides the triangles at this distance show; both: the particle may see both
  };
  ClosedPart* closed_part(std::size_t k);
  void find_closed_parts(const Vec3& x);

  const ClosestBlock& block(std::size_t k) const { return blocks_[at_[k] / 4]; }

  const NearbyTriangle* triangles_ = nullptr;
  const Corners* corners_ = nullptr;
  std::vector<std::uint32_t> index_;  // of those that may be near
  std::vector<ClosestBlock> blocks_;
  std::vector<std::uint32_t> at_;  // of those that are near, in index_
  std::vector<ClosedPart> closed_;
};

}  // namespace oilskin::fluid
