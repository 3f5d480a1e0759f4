#include "contact/friction.h"

#include <algorithm>
#include <cmath>

#include "contact/reach.h"
#include "core/assert.h"

namespace oilskin::contact {

namespace {

double angle_between(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

}  // namespace

SurfaceSide side_of(const MeshTopology& topology, Span<const Triangle> triangles, Span<const Vec3> x,
                    std::uint32_t triangle, std::uint8_t feature, const Vec3& normal) {
  SurfaceSide side;
  OILSKIN_ASSERT(triangle < triangles.size() && feature >= 1 && feature <= 7);
  const Triangle& own = triangles[triangle];
  if (feature == 7) {
    side.back = normal.dot((x[own[1]] - x[own[0]]).cross(x[own[2]] - x[own[0]])) < 0;
    return side;
  }
  const int first = feature & 1 ? 0 : (feature & 2 ? 1 : 2);
  const bool is_edge = (feature & (feature - 1)) != 0;
  const int second = !is_edge ? first : (feature & 4 ? 2 : 1);
  const std::uint32_t u = own[first], v = own[second];
  Vec3 sum = Vec3::Zero();
  side.normal_alignment = 0;
  for (std::uint32_t t : topology.triangles_of(u)) {
    const Triangle& nodes = triangles[t];
    const auto at = static_cast<std::size_t>(std::find(nodes.begin(), nodes.end(), u) - nodes.begin());
    if (std::find(nodes.begin(), nodes.end(), v) == nodes.end()) continue;
    const Vec3 a = x[nodes[(at + 1) % 3]] - x[u], b = x[nodes[(at + 2) % 3]] - x[u];
    const Vec3 area = a.cross(b);
    const double size = area.norm();
    if (!(size > 1e-7 * std::max(a.squaredNorm(), b.squaredNorm()))) continue;
    const Vec3 n = area / size;
    sum += u == v ? Vec3(angle_between(a, b) * n) : n;  // at an edge both triangles have the angle π
    side.normal_alignment = std::max(side.normal_alignment, std::abs(normal.dot(n)));
  }
  side.back = normal.dot(sum) < -1e-9 * sum.norm();
  return side;
}

// A particle represents dx² of each wall that it sees: once if several contacts belong to one wall (inner
// edges of a flat sheet, a cloth on a floor), twice in a corner. A contact gets the area that nearer contacts
// of the particle leave, by the component of its normal that theirs do not have.
void distribute_wall_area(const Context& context, std::vector<ContactConstraint>& constraints) {
  const double area = context.particles->spacing * context.particles->spacing;
  for (std::size_t begin = 0, end = 0; begin < constraints.size(); begin = end) {
    while (end < constraints.size() &&
           constraints[end].contact.particle == constraints[begin].contact.particle)
      ++end;
    for (std::size_t k = begin; k < end; ++k) {
      const Contact& c = constraints[k].contact;
      if (!constraints[k].friction_active ||
          context.surfaces[c.surface]->slip_on(c.back).model != SlipModel::viscous_wall)
        continue;
      double fraction = c.normal_alignment;
      for (std::size_t o = begin; o < end; ++o) {
        const Contact& other = constraints[o].contact;
        const bool nearer = other.distance < c.distance || (other.distance == c.distance && o < k);
        if (nearer) fraction *= 1 - std::clamp(c.normal.dot(other.normal), 0.0, 1.0);
      }
      OILSKIN_ASSERT(fraction >= 0 && fraction < 1 + 1e-9);
      constraints[k].wall_area = fraction * area;
    }
  }
}

Vec3 tangential_impulse(const Context& context, const ContactConstraint& constraint, const Vec3& vt) {
  OILSKIN_ASSERT(constraint.k > 0 && vt.allFinite());
  const SurfaceMotion& surface = *context.surfaces[constraint.contact.surface];
  const SlipSettings& slip = surface.slip_on(constraint.contact.back);
  Vec3 sticking = constraint.tangential_impulse - vt / constraint.k;
  switch (slip.model) {
    case SlipModel::free:
      return Vec3::Zero();
    case SlipModel::coulomb: {
      const double normal = constraint.normal_impulse + constraint.spring_impulse;
      const double limit = normal > 0 ? slip.friction * normal : 0;  // 0, not NaN, for infinite friction
      const double size = sticking.norm();
      return size <= limit ? sticking : Vec3(sticking * (limit / size));
    }
    case SlipModel::sticking:
      return sticking;
    case SlipModel::viscous_wall: {
      // (C.17): implicit, so that it never reverses the velocity.
      const ParticleMotion& p = *context.particles;
      const double z = std::max(constraint.contact.distance - wall_offset(p, surface), 0.25 * p.spacing);
      const double drag =
          context.dt * p.viscosity * p.rest_density * constraint.wall_area / (z + slip.slip_length);
      const Vec3 velocity_without = vt - constraint.k * constraint.tangential_impulse;
      return -drag / (1 + drag * constraint.k) * velocity_without;
    }
  }
  return Vec3::Zero();
}

}  // namespace oilskin::contact
