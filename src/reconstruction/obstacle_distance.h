/// Distances of a block's nodes from obstacles, and crossings of its edges. Lengths in cells.
#pragma once

#include "reconstruction/grid.h"
#include "reconstruction/obstacles.h"

namespace oilskin::reconstruction {

/// Fills the distances (up to `band`, infinite beyond) and, with `cut_edges`, the cut edges of a block at
/// `origin` [m].
void measure_obstacles(const Obstacles& obstacles, const Vec3& origin, double cell, double band,
                       bool cut_edges, NearBlock& near);

/// Where an obstacle counts as wet, mode `wet`.
struct WetRule {
  double dry_to = 0, wet_from = 0;  ///< saturations
  double range = 0;                 ///< T [cells]
  double fade = 0;  ///< triangles farther than the nearest one by this have no influence [cells]

  /// 0 at dry_to and below, 1 at wet_from and above (R.26).
  double share(double saturation) const;
};

/// Fills NearBlock::wetness (R.27) at nodes nearer than the range. Needs the distances.
void measure_wetness(const Obstacles& obstacles, const Vec3& origin, double cell, const WetRule& rule,
                     NearBlock& near);

}  // namespace oilskin::reconstruction
