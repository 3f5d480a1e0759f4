/// Pieces of water: connected parts of the mesh, and the particles in them.
#pragma once

#include "reconstruction/even_water.h"
#include "reconstruction/film.h"

namespace oilskin::reconstruction {

/// The connected parts of a mesh.
struct MeshParts {
  std::vector<std::uint32_t> of_vertex;  ///< the first vertex of its part
  std::vector<std::uint8_t> is_bubble;   ///< of a first vertex: its part encloses air
};

/// `positions`: of the mesh as it was polygonised. A bubble that has shrunk since may be turned inside out.
MeshParts parts_of(const RawMesh& mesh, const std::vector<std::array<float, 3>>& positions,
                   const Workers& workers);

/// Removes the parts that are inside out: what encloses a negative volume outside of the water, as a bubble
/// in a film does when the film has become thinner, and, except near obstacles, bubbles that the water around
/// them has closed and crumbs of water. `of_vertex`: data per vertex, from which theirs are removed.
void remove_turned_parts(const MeshParts& parts, const Obstacles& obstacles, const Workers& workers,
                         RawMesh& mesh, std::vector<float>& of_vertex);

/// The connected parts of a mesh that enclose less than a given volume.
struct SmallPieces {
  std::vector<std::uint32_t> of_vertex;  ///< none: the vertex is of a larger part, or of a bubble
  std::uint32_t count = 0;
  std::vector<std::uint32_t> in_bubbles;  ///< vertices of bubbles, in whatever piece these are
};

/// `max_volume` [m³].
SmallPieces small_pieces(const RawMesh& mesh, const MeshParts& parts, double max_volume,
                         const Workers& workers);

/// Finds the small piece in which a point lies.
class PieceFinder {
 public:
  /// `obstacles`: those of Block::near.
  PieceFinder(const Grid& grid, const Obstacles& obstacles, const RawMesh& mesh, const SmallPieces& pieces);
  /// May a point in the block at `at` lie in a small piece?
  bool is_near(const Int3& at) const {
    const std::uint32_t b = grid_.index.find(key_of(at));
    return b != none && is_near_[b] != 0;
  }
  /// The piece of the nearest inside node within two cells of x [cells, from the world's origin] that no
  /// obstacle hides from it, or of the nearest one if all are hidden; none: it is not of a small piece, or
  /// there is none.
  std::uint32_t find(const Vec3& x) const;
  /// The small piece of a node inside the water, or none.
  std::uint32_t of_node(const NodeRef& node) const;

 private:
  void mark_near(const NodeRef& node);
  void add(const NodeRef& node, std::uint32_t piece, std::vector<NodeRef>& reached);
  NodeRef next(const NodeRef& node, int axis, bool up) const;
  bool is_cut(const NodeRef& low, int axis) const;
  std::vector<std::uint32_t> triangles_around(const Vec3& x) const;
  bool hides_any(const std::vector<std::uint32_t>& triangles, const Vec3& x, const Vec3& node) const;
  NodeRef nearest_inside(const Vec3& x, int ring, const std::vector<std::uint32_t>& hiding) const;

  const Grid& grid_;
  const Obstacles& obstacles_;
  KeyMap piece_of_node_;
  std::vector<std::uint8_t> is_near_;  // per block
};

/// Is an inside node among the corners of the cell of x, or of the 26 cells around it? x in cells.
bool is_near_water(const Grid& grid, const Vec3& x);

/// Where the mesh has the film of particle p, which is at x [cells]: the gap may push it away. Without a film
/// it is x.
Vec3 place_in_film(const Film& film, std::uint32_t p, const Vec3& x);

/// Per particle of ParticleBlocks: 1 if neither it, nor where it was drawn in to, nor its film is near water,
/// so the grid does not see it.
std::vector<std::uint8_t> far_from_water(const ParticleBlocks& particles, const Film& film,
                                         const DrawnIn& drawn_in, const Grid& grid, const Workers& workers);

}  // namespace oilskin::reconstruction
