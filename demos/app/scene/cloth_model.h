/// From the cloth of a scene to nodes, triangles, links and masses, for any host.
#pragma once

#include "scene/scene.h"

namespace oilskin::demo {

constexpr int not_pinned = -1;

struct ClothModel {
  /// [m]; also the start.
  std::vector<Vec3> rest;
  std::vector<Triangle> triangles;
  /// In the order in which a Gauss–Seidel solver should see them.
  std::vector<std::array<std::uint32_t, 2>> links;
  /// [kg], by area; of pinned nodes too: they get it back when released.
  std::vector<double> mass;
  /// not_pinned, or index into `groups`.
  std::vector<int> pin_group;
  std::vector<PinBox> groups;
  /// Where the motion of pins starts from: `rest`, or where a node was when it was pinned.
  std::vector<Vec3> anchor;

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
/// How far a body has turned then.
Eigen::AngleAxisd turned(const Motion& motion, double t);
/// Seconds of the motion that have passed at t.
double motion_time(const Motion& motion, double t);

}  // namespace oilskin::demo
