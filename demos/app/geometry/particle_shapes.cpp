#include "geometry/particle_shapes.h"

#include <algorithm>

#include "geometry/nearest_surface.h"

namespace oilskin::demo {
namespace {

/// How far a flat drop may spread before it comes through a fold or the rim of a sheet.
double spread(const NearestSurface& nearest, const Vec3& p, const Vec3& n, double height, double maximum) {
  double r = maximum;
  while (r > height && !nearest.is_clear(p, n, height, r)) r *= 0.8;
  return std::max(r, std::min(maximum, height));
}

}  // namespace

std::vector<ParticleShape> particle_shapes(Span<const Vec3> positions,
                                           Span<const SurfaceMotion* const> surfaces, double spacing) {
  const double radius = 0.5 * spacing;
  NearestSurface nearest(radius);
  for (const SurfaceMotion* surface : surfaces)
    if (surface != nullptr) nearest.add(*surface, 0);
  std::vector<ParticleShape> shapes(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    NearestSurface::Hit hit;
    if (!nearest.find(positions[i], &hit) || hit.point.distance == 0) continue;
    const Vec3 n = hit.point.offset / hit.point.distance;
    const double height = 0.8 * hit.point.distance;  // touching would shine through
    shapes[i] = {false, n, height, spread(nearest, positions[i], n, height, radius)};
  }
  return shapes;
}

}  // namespace oilskin::demo
