/// Distances of a block's nodes from obstacles, and crossings of its edges. Lengths in cells.
#pragma once

#include "reconstruction/grid.h"
#include "reconstruction/obstacles.h"

namespace oilskin::reconstruction {

/// Fills the distances (up to `band`, infinite beyond) and, with `cut_edges`, the cut edges of a block at
/// `origin` [m].
void measure_obstacles(const Obstacles& obstacles, const Vec3& origin, double cell, double band,
                       bool cut_edges, NearBlock& near);

}  // namespace oilskin::reconstruction
