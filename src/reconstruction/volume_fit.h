/// Moves the mesh so that it encloses the volume of the water: on average over a few spacings, and exactly in
/// each small piece and in all others together. Lengths in cells.
#pragma once

#include <optional>

#include "reconstruction/pieces.h"

namespace oilskin::reconstruction {

/// How far the fit may move vertices.
struct FitLimits {
  double cell = 0;         ///< [m]
  double spacing = 0;      ///< dx [cells]
  double max_outward = 0;  ///< along the normal [cells]
  double max_inward = 0;   ///< [cells]
  double clearance = 0;    ///< d*: of vertices that face an obstacle; those about as near stay [cells]
  double small_piece = 0;  ///< pieces of less water are fitted one by one [cells³]
  double gap = 0;          ///< [m]: pieces are not scaled where an obstacle is nearer to their box …
  /// … nor beyond this box, in which all obstacles are known; without it there are none.
  std::optional<Box> known = {};
  /// With a clip box only small pieces inside it are fitted: how much water it cuts off is not known.
  std::optional<Box> clip = {};
};

/// Drops are not in the mesh. `obstacles`: none, or those to keep away from, with prepared queries.
/// `polygonised`: the positions to which mesh.cube_volumes and mesh.distances belong. Films have their local
/// volume already: they only grow or shrink by the same factor everywhere.
/// `parts`: of the mesh as polygonised. Turns triangles back that are turned over.
void fit_volume(const FitLimits& limits, const ParticleBlocks& particles, const Water& water,
                const Film& film, const DrawnIn& drawn_in, const Grid& grid, const Obstacles& obstacles,
                const std::vector<std::array<float, 3>>& polygonised, const FilmVertices& films,
                const MeshParts& parts, const SurfaceBlocks& blocks, RawMesh& mesh, const Workers& workers);

}  // namespace oilskin::reconstruction
