/// The water in the connected pieces of the mesh.
#pragma once

#include "reconstruction/pieces.h"

namespace oilskin::reconstruction {

/// The water in small pieces; the last one stands for all others.
struct WaterInPieces {
  std::vector<double> water;
  std::vector<std::uint32_t> of_particle;  ///< its piece, none: of a larger part; empty without small pieces
};

/// Bubbles in a small piece get its number in `pieces`, so that they count for its volume.
WaterInPieces water_in_pieces(const ParticleBlocks& particles, const Water& water, const Film& film,
                              const DrawnIn& drawn_in, const Grid& grid, const Obstacles& obstacles,
                              const RawMesh& mesh, SmallPieces& pieces, const Workers& workers);

/// Particles draw pieces in which there is none of them, as at the rims of films where obstacles bend. Such a
/// piece is fitted together with that of the particle that is nearest to it.
void join_pieces_without_water(const ParticleBlocks& particles, const Water& water,
                               const WaterInPieces& in_pieces, const RawMesh& mesh, double cell,
                               double spacing, SmallPieces& pieces);

/// The water of the piece at each vertex [m³], 0 where the piece encloses `max_volume` [m³] or more.
std::vector<double> water_of_small_pieces(double max_volume, const ParticleBlocks& particles,
                                          const Water& water, const Film& film, const DrawnIn& drawn_in,
                                          const Grid& grid, const Obstacles& obstacles, const RawMesh& mesh,
                                          const Workers& workers);

}  // namespace oilskin::reconstruction
