/// Drops of one particle, which the grid does not resolve: spheres, flattened at obstacles.
#pragma once

#include "reconstruction/film.h"

namespace oilskin::reconstruction {

struct DropReport {
  std::size_t drawn = 0;
  std::size_t left_out = 0;  ///< no space at the gap, outside the clip box, or too small
};

/// Where drops may be.
struct DropLimits {
  double cell = 0;                       ///< [m]
  const Obstacles* obstacles = nullptr;  ///< with prepared queries; may be null
  double gap = 0;                        ///< none comes closer to obstacles than this [m]
  std::optional<Box> clip = {};          ///< drops that are not wholly inside are left out
  double min_volume = 0;                 ///< smaller drops are left out [m³]
};

/// How far a drop of this volume [m³] may reach from its particle [m].
double reach_of_drop(double volume);

/// Appends a closed surface for each drop to the mesh, with the particle's velocity and attributes.
DropReport add_drops(const ReconstructionInput& input, const ParticleBlocks& particles, const Water& water,
                     const Film& film, const DropLimits& limits, bool nearest, const Workers& workers,
                     WaterMesh& mesh);

}  // namespace oilskin::reconstruction
