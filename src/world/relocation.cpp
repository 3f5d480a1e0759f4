#include "world/relocation.h"

#include <optional>

#include "contact/predicates.h"
#include "core/assert.h"

namespace oilskin::world {

namespace {

ActiveSurfaces take_new_surfaces(const ActiveSurfaces& active) {
  ActiveSurfaces found;
  for (Attachment* a : active.attachment) {
    if (!a->is_new) continue;
    a->is_new = false;
    found.add(*a);
  }
  return found;
}

// In front of the nearest triangle, at the thickness of its surface; none where the point lies on a triangle.
std::optional<Vec3> place_off_nearest(const ActiveSurfaces& surfaces, const Vec3& x) {
  ClosestPoint nearest;
  nearest.distance = std::numeric_limits<double>::infinity();
  double thickness = 0;
  for (const SurfaceMotion* s : surfaces.motion)
    for (const Triangle& t : s->triangles) {
      const ClosestPoint c = closest_point(x, s->x_t0[t[0]], s->x_t0[t[1]], s->x_t0[t[2]]);
      if (c.distance >= nearest.distance) continue;
      nearest = c;
      thickness = s->thickness;
    }
  if (!(nearest.distance > 0)) return {};
  return Vec3(x + nearest.offset / nearest.distance * thickness);
}

bool crosses_a_triangle(const ActiveSurfaces& surfaces, const Vec3& from, const Vec3& to) {
  for (const SurfaceMotion* s : surfaces.motion)
    for (const Triangle& t : s->triangles) {
      const Vec3 &a = s->x_t0[t[0]], &b = s->x_t0[t[1]], &c = s->x_t0[t[2]];
      if (contact::paths_intersect({from, a, b, c}, {to, a, b, c}).hit) return true;
    }
  return false;
}

}  // namespace

void relocate_particles(const ActiveSurfaces& active, fluid::Particles& particles, std::uint64_t& next_id,
                        const Workers& workers, StepReport& report, Ledger& ledger) {
  const ActiveSurfaces new_surfaces = take_new_surfaces(active);
  if (new_surfaces.size() == 0 || particles.size() == 0) return;
  const std::vector<std::uint8_t> too_near =
      find_blocked_points(new_surfaces.at_start(), particles.position, workers);
  const std::vector<StandingSurface> standing = active.at_start();
  std::vector<std::uint8_t> keep(particles.size(), 1);
  for (std::size_t p = 0; p < particles.size(); ++p) {
    if (!too_near[p]) continue;
    ++report.contact.relocated;
    const Vec3& x = particles.position[p];
    const std::optional<Vec3> place = place_off_nearest(new_surfaces, x);
    if (place && !find_blocked_points(standing, Span<const Vec3>(&*place, 1), workers)[0] &&
        !crosses_a_triangle(active, x, *place)) {
      // The jump is no motion: the new id shows it to readers of the trace.
      particles.position[p] = *place;
      particles.id[p] = next_id++;
      continue;
    }
    keep[p] = 0;
    ++report.removed;
    ledger.present_before(particles.relative_mass(p), particles.velocity[p]);
    ledger.removed(particles.relative_mass(p), particles.velocity[p]);
  }
  particles.compress(keep);
}

}  // namespace oilskin::world
