#include "view/pick.h"

#include <Eigen/Geometry>
#include <cmath>

namespace oilskin::demo {
namespace {

void pick_from(const SurfaceMotion* surface, const Ray& ray, bool is_body, std::size_t index,
               std::optional<Picked>& nearest) {
  if (surface == nullptr) return;
  const std::vector<Vec3>& x = surface->x_t1;
  for (const Triangle& t : surface->triangles) {
    const std::optional<double> distance = hit_on_triangle(ray, x[t[0]], x[t[1]], x[t[2]]);
    if (!distance || (nearest && *distance >= nearest->distance)) continue;
    nearest = Picked{is_body, index, ray.origin + *distance * ray.direction, *distance};
  }
}

}  // namespace

std::optional<double> hit_on_triangle(const Ray& ray, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 u = b - a, v = c - a, p = ray.direction.cross(v);
  const double det = u.dot(p);
  if (det == 0) return {};
  const Vec3 s = ray.origin - a, q = s.cross(u);
  const double beta = s.dot(p) / det, gamma = ray.direction.dot(q) / det, distance = v.dot(q) / det;
  if (!(beta >= 0 && gamma >= 0 && beta + gamma <= 1 && distance > 0)) return {};
  return distance;
}

std::optional<Picked> pick(const Simulation& simulation, const Scene& scene, const Ray& ray, bool bodies) {
  std::optional<Picked> nearest;
  for (std::size_t i = 0; i < scene.cloth.size(); ++i) pick_from(simulation.cloth(i), ray, false, i, nearest);
  for (std::size_t i = 0; bodies && i < scene.bodies.size(); ++i)
    pick_from(simulation.body(i), ray, true, i, nearest);
  return nearest;
}

std::optional<Vec3> hit_on_plane(const Ray& ray, const Vec3& point, const Vec3& normal) {
  const double along = ray.direction.dot(normal);
  if (along == 0) return {};
  const double distance = (point - ray.origin).dot(normal) / along;
  if (!(distance > 0) || !std::isfinite(distance)) return {};
  return Vec3(ray.origin + distance * ray.direction);
}

}  // namespace oilskin::demo
