/// How far the nodes of a block are from obstacles, and which of its edges obstacles cross. Lengths in cells.
#pragma once

#include "reconstruction/grid.h"
#include "reconstruction/obstacles.h"

namespace oilskin::reconstruction {

/// Fills distance (up to `band`, infinite beyond) and, if wanted, the cut edges of a block at `origin` [m].
void measure_obstacles(const Obstacles& obstacles, const Vec3& origin, double cell, double band,
                       bool cut_edges, NearBlock& near);

}  // namespace oilskin::reconstruction
