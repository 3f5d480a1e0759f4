/// What obstacles do to the field: the modes of ObstacleMode. Lengths of the grid in cells.
#pragma once

#include "reconstruction/repair.h"

namespace oilskin::reconstruction {

struct ContactParameters {
  ObstacleMode mode = ObstacleMode::gap;
  double gap = 0;          ///< [m], promised
  double clearance = 0;    ///< [cells], aimed at: the gap and a little more
  double touch_range = 0;  ///< [cells]
  double depth = 0;        ///< [cells]
  double band = 0;         ///< distances are needed up to here [cells]
  double reach = 0;        ///< obstacles farther from a block than this do not matter to it [cells]

  bool sees() const { return mode != ObstacleMode::none; }
  bool promises() const { return mode == ObstacleMode::gap || mode == ObstacleMode::touch; }
};

ContactParameters contact_parameters(const ReconstructionOptions& options);

/// The value of a node at `distance` from obstacles, (R.10) to (R.14). `seen`: the field of the particles
/// that the node can see; `all`: that of all of them, for overlap.
float value_at_contact(const ContactParameters& p, float seen, float all, float distance);

/// Does a piece of an obstacle lie inside the water? No triangle of the mesh meets it, so one of its points
/// tells.
bool is_submerged(const Obstacles& obstacles, const std::vector<std::uint32_t>& piece, const Grid& grid,
                  const RawMesh& mesh, const Workers& workers);

/// Winding number of closed triangles around a point (R.20): Σ Ω/4π [Oosterom1983].
double winding_number(const std::vector<std::array<float, 3>>& positions,
                      const std::vector<Triangle>& triangles, const Vec3& x, const Workers& workers);

/// The inside corners of the cell that holds x.
std::vector<NodeRef> nodes_around(const Vec3& x, const Grid& grid);

}  // namespace oilskin::reconstruction
