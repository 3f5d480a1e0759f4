/// From the cloth of a scene to nodes, triangles, links and masses, for any host.
#pragma once

#include "scene.h"

namespace oilskin::demo {

constexpr int not_pinned = -1;

struct ClothModel {
  std::vector<Vec3> rest;  ///< [m]; also the start
  std::vector<Triangle> triangles;
  std::vector<std::array<std::uint32_t, 2>>
      links;                   ///< in the order in which a Gauss–Seidel solver should see them
  std::vector<double> mass;    ///< [kg], by area; of pinned nodes too: they get it back when released
  std::vector<int> pin_group;  ///< not_pinned, or index into `groups`
  std::vector<PinBox> groups;
  std::vector<Vec3>
      anchor;  ///< where the motion of pins starts from: `rest`, or where a node was when it got held

  bool pinned_at_start(std::size_t node) const;
  double total_mass() const;
};

/// Throws SceneError for what only the finished mesh shows, such as pins that hold no node. `key` stands in
/// messages.
ClothModel build_cloth(const Cloth& cloth, const std::string& key);

/// Where a point that starts at `rest` is at time t [s].
Vec3 moved(const Motion& motion, const Vec3& rest, double t);
/// Its velocity then [m/s].
Vec3 velocity_at(const Motion& motion, const Vec3& rest, double t);
/// Seconds of the motion that have passed at t.
double motion_time(const Motion& motion, double t);

}  // namespace oilskin::demo
