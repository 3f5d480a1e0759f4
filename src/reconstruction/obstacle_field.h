/// Changes of the field near obstacles, by ObstacleMode, and obstacles inside the water.
#pragma once

#include <optional>

#include "reconstruction/line_crossings.h"
#include "reconstruction/obstacle_distance.h"
#include "reconstruction/repair.h"

namespace oilskin::reconstruction {

struct ContactParameters {
  ObstacleMode mode = ObstacleMode::gap;
  double gap = 0;          ///< G: promised gap [m]
  double clearance = 0;    ///< d*: aimed distance [cells]
  double touch_range = 0;  ///< T [cells]
  double depth = 0;        ///< overlap depth [cells]
  double band = 0;         ///< distances are computed up to this [cells]
  WetRule wet;             ///< of mode `wet`
  double reach = 0;        ///< obstacles farther than this from a block do not affect it [cells]

  /// Of films: nothing is drawn to obstacles without a range.
  ObstacleMode film_mode() const { return touch_range > 0 ? mode : ObstacleMode::gap; }
  bool uses_visibility() const { return mode != ObstacleMode::none; }
  bool promises() const {
    return mode == ObstacleMode::gap || mode == ObstacleMode::touch || mode == ObstacleMode::wet;
  }
};

ContactParameters contact_parameters(const ReconstructionOptions& options);

/// The value of a node at `distance` from obstacles, (R.10) to (R.14) and (R.25). `visible`: the field of the
/// particles that the node sees; `all`: that of all particles, for overlap, infinite where none is in reach;
/// `wetness`: 0 … 1, for wet.
float value_at_contact(const ContactParameters& p, float visible, float all, float distance, float wetness);

/// Is a point inside a closed mesh? Prepares itself at the first question, of which most meshes have none.
class InsideTest {
 public:
  InsideTest(const std::vector<std::array<float, 3>>& positions, const std::vector<Triangle>& triangles)
      : positions_(positions), triangles_(triangles) {}

  bool has(const Vec3& x) {
    if (!crossings_) crossings_.emplace(positions_, triangles_).add_all();
    return crossings_->beyond(x) != 0;
  }
  /// The mesh has changed.
  void reset() { crossings_.reset(); }

 private:
  const std::vector<std::array<float, 3>>& positions_;
  const std::vector<Triangle>& triangles_;
  std::optional<LineCrossings> crossings_;
};

/// Is a piece of an obstacle inside the water? No triangle of the mesh intersects it, so one of its points
/// decides.
bool is_submerged(const Obstacles& obstacles, const std::vector<std::uint32_t>& piece, const Grid& grid,
                  InsideTest& inside);

/// Vertices moved from `start`, where the promise holds; `moved` are the triangles that may have passed an
/// obstacle. Puts vertices around pieces of obstacles that are now inside the water back. Returns their
/// number: 0 if none is inside.
std::size_t put_back_around_enclosed(const Obstacles& obstacles, const Grid& grid,
                                     const std::vector<std::array<float, 3>>& start,
                                     const std::vector<std::uint32_t>& moved, RawMesh& mesh);

/// The inside corners of the cell that contains x.
std::vector<NodeRef> nodes_around(const Vec3& x, const Grid& grid);

}  // namespace oilskin::reconstruction
