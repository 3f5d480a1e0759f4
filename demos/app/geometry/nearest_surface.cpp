#include "geometry/nearest_surface.h"

#include <cmath>

namespace oilskin::demo {
namespace {

constexpr double max_cells = 4096;  // per triangle

}

NearestSurface::Cell NearestSurface::cell_of(const Vec3& p) const {
  const Vec3 c = (p / cell_).array().floor();
  return {static_cast<std::int64_t>(c.x()), static_cast<std::int64_t>(c.y()),
          static_cast<std::int64_t>(c.z())};
}

void NearestSurface::add(const SurfaceMotion& motion, int surface) {
  for (std::uint32_t t = 0; t < motion.triangles.size(); ++t) {
    Box box;
    for (const std::uint32_t i : motion.triangles[t]) box.add(motion.x_t1[i]);
    box = box.inflated(reach_);
    const Entry entry{&motion, t, surface};
    const Vec3 cells = ((box.max - box.min) / cell_).array() + 1;
    if (!(cells.prod() < max_cells)) {
      large_.push_back(entry);
      continue;
    }
    const Cell a = cell_of(box.min), b = cell_of(box.max);
    for (std::int64_t z = a[2]; z <= b[2]; ++z)
      for (std::int64_t y = a[1]; y <= b[1]; ++y)
        for (std::int64_t x = a[0]; x <= b[0]; ++x) cells_[{x, y, z}].push_back(entry);
  }
}

void NearestSurface::improve(const Entry& entry, const Vec3& p, Hit* hit) const {
  const Triangle& nodes = entry.motion->triangles[entry.triangle];
  const std::vector<Vec3>& x = entry.motion->x_t1;
  const ClosestPoint point = closest_point(p, x[nodes[0]], x[nodes[1]], x[nodes[2]]);
  if (point.distance > reach_ || (hit->surface >= 0 && point.distance >= hit->point.distance)) return;
  *hit = {entry.surface, nodes, point};
}

bool NearestSurface::find(const Vec3& p, Hit* hit) const {
  *hit = Hit();
  const auto it = cells_.find(cell_of(p));
  if (it != cells_.end())
    for (const Entry& entry : it->second) improve(entry, p, hit);
  for (const Entry& entry : large_) improve(entry, p, hit);
  return hit->surface >= 0;
}

bool NearestSurface::is_clear(const Vec3& p, const Vec3& n, double along, double across) const {
  // Scaled by its half axes the ellipsoid is the unit ball about the origin, and triangles stay triangles.
  const auto meets = [&](const Entry& entry) {
    const Triangle& nodes = entry.motion->triangles[entry.triangle];
    Vec3 corner[3];
    for (int k = 0; k < 3; ++k) {
      const Vec3 displacement = entry.motion->x_t1[nodes[static_cast<std::size_t>(k)]] - p;
      const double up = displacement.dot(n);
      corner[k] = (displacement - up * n) / across + (up / along) * n;
    }
    return closest_point(Vec3::Zero(), corner[0], corner[1], corner[2]).distance < 1;
  };
  const auto it = cells_.find(cell_of(p));
  if (it != cells_.end())
    for (const Entry& entry : it->second)
      if (meets(entry)) return false;
  for (const Entry& entry : large_)
    if (meets(entry)) return false;
  return true;
}

}  // namespace oilskin::demo
