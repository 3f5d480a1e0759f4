/// Which surface a ray hits first.
#pragma once

#include <optional>

#include "hosts/simulation.h"
#include "view/camera.h"

namespace oilskin::demo {

struct Picked {
  bool is_body = false;
  std::size_t index = 0;      ///< of the cloth or body in the scene
  Vec3 point = Vec3::Zero();  ///< [m]
  double distance = 0;        ///< from the ray's origin [m]
};

/// Where a ray hits a triangle, from either side: the distance from its origin [m].
std::optional<double> hit_on_triangle(const Ray& ray, const Vec3& a, const Vec3& b, const Vec3& c);

/// The nearest hit on the cloth and bodies of a simulation, as the last step left them. `bodies`: false
/// looks through them.
std::optional<Picked> pick(const Simulation& simulation, const Scene& scene, const Ray& ray, bool bodies);

/// Where a ray hits the plane through `point` across `normal`; nothing where it does not.
std::optional<Vec3> hit_on_plane(const Ray& ray, const Vec3& point, const Vec3& normal);

}  // namespace oilskin::demo
