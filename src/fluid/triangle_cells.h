/// The cells of the fluid that surfaces touch: which triangles are within the support radius H of the
/// particles of which cell. Found once per interval, for hidden neighbours and boundary terms.
#pragma once

#include <vector>

#include "core/mesh_topology.h"
#include "core/parallel.h"
#include "core/sort_by_key.h"
#include "fluid/neighbours.h"
#include "fluid/triangle_list.h"
#include "oilskin/surface_motion.h"

namespace oilskin::fluid {

/// Sides of the plane of a triangle.
struct Sides {
  bool front = false, back = false;
};

/// A triangle at x_t0.
struct NearbyTriangle {
  std::uint32_t surface = 0, triangle = 0;
  Vec3 middle = Vec3::Zero();  ///< of the corners [m]
  double size = 0;             ///< distance of the farthest corner from it [m]
  Vec3 cross = Vec3::Zero();   ///< (b − a) × (c − a)
  double cross_norm = 0;       ///< its length, twice the area [m²]
  bool is_duplicate = false, is_at_border = false, has_free_node = false;
  /// MeshTopology::part() where that is closed, else none. Cloth may pass through itself: none at free nodes.
  std::uint32_t closed_part = MeshTopology::none;
  /// Particles within H may lie on this side of its plane, or in it.
  Sides sides;
};

class TriangleCells {
 public:
  /// Up to four cells side by side, with triangles near their particles.
  struct Cell {
    Box box;                            ///< of the particles [m]
    std::uint32_t begin = 0, end = 0;   ///< particles
    std::uint32_t first = 0, last = 0;  ///< in the list of all cells' triangles
  };

  /// `x`: positions that the neighbours were searched for. `near`: per surface at least the triangles within
  /// H of a particle; empty = all. The surfaces' motions must stay where they are.
  void find(Span<const Vec3> x, Span<SurfaceMotion* const> surfaces,
            Span<const MeshTopology* const> topologies, Span<const TriangleList> near, double support_radius,
            const Neighbours& neighbours, const Workers& workers);
  void clear();
  bool is_found() const { return is_found_; }

  /// In the order of their particles.
  const std::vector<Cell>& cells() const { return cells_; }
  /// Indices into triangles(), ascending: at least those within H of a particle of the cell.
  Span<const std::uint32_t> triangles_of(const Cell& cell) const {
    return {of_group_.list.data() + cell.first, cell.last - cell.first};
  }
  /// In the order of surfaces and triangles; more than those that any cell has. After find().
  const std::vector<NearbyTriangle>& triangles() const { return triangles_; }
  /// Of triangles().
  const Corners* corners() const { return corners_.data(); }
  /// f(cell, sides) for cells with and without triangles: all particles within H of the triangle, and few
  /// others. `sides` of its plane on which they may be.
  template <class F>
  void for_particles_near(std::uint32_t triangle, const F& f) const {
    const std::vector<Touch>& touches = found_[triangle / triangle_chunk];
    for (std::uint32_t k = touches_[triangle].begin; k < touches_[triangle].end; ++k)
      f(groups_[touches[k].group], touches[k].sides);
  }

 private:
  static constexpr std::size_t triangle_chunk = 64;

  struct Touch {
    std::uint32_t group, triangle;
    Sides sides;
  };
  struct Range {
    std::uint32_t begin = 0, end = 0;
  };

  void read_triangles(Span<SurfaceMotion* const> surfaces, Span<const MeshTopology* const> topologies,
                      Span<const TriangleList> near, double support_radius, const Workers& workers);
  void find_groups(Span<const Vec3> x, const Neighbours& neighbours, const Workers& workers);
  std::uint32_t end_of_block(std::uint32_t first, std::uint32_t end, double support_radius) const;
  void groups_near(std::uint32_t first, std::uint32_t last, const Neighbours& neighbours,
                   std::vector<std::uint32_t>& groups) const;
  Sides touch(Span<const Vec3> x, std::uint32_t triangle, const Cell& group, double support_radius) const;
  void sort_by_cell(std::size_t chunks, const Workers& workers);

  bool is_found_ = false;
  std::vector<NearbyTriangle> triangles_;
  std::vector<Corners> corners_;
  std::vector<Box> boxes_;  // of triangles_, inflated by H
  std::vector<Cell> cells_;
  std::vector<Cell> groups_;               // with and without triangles
  std::vector<std::uint32_t> group_of_;    // per cell of the neighbours
  KeyedLists<std::uint32_t> of_group_;     // triangles
  std::vector<std::vector<Touch>> found_;  // per chunk of triangles, in their order
  std::vector<Range> touches_;             // of each triangle in those of its chunk
};

}  // namespace oilskin::fluid
