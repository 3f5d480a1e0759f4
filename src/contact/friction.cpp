#include "contact/friction.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "contact/reach.h"
#include "contact/surface_point.h"
#include "core/assert.h"
#include "core/clamped_part.h"

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

namespace {

bool has_wall_area(const Context& context, const ContactConstraint& constraint) {
  const Contact& c = constraint.contact;
  switch (context.surfaces[c.surface]->slip_on(c.back).model) {
    case SlipModel::viscous_wall:
      return constraint.friction_active;
    case SlipModel::sticking:
      return context.boundary_terms && context.liquid(c.particle).viscosity > 0;
    case SlipModel::free:
    case SlipModel::coulomb:
      break;
  }
  return false;
}

/// Distance over which the wall shear of (C.17) falls [m].
double shear_distance(const Context& context, const ContactConstraint& constraint) {
  const Contact& c = constraint.contact;
  const Liquid& liquid = context.liquid(c.particle);
  return std::max(c.distance - wall_offset(liquid, *context.surfaces[c.surface]), 0.25 * liquid.spacing);
}

/// M of (C.17) [kg].
double wall_drag(const Context& context, const ContactConstraint& constraint, double slip_length) {
  const Liquid& liquid = context.liquid(constraint.contact.particle);
  const double z = shear_distance(context, constraint);
  return context.dt * liquid.viscosity * liquid.rest_density * constraint.wall_area / (z + slip_length);
}

/// ψ (B.36), with the area that the particle has of the wall: contacts that share it are one wall, and those
/// without a part of it (C.19) must not stick where the first one lets it move.
double viscous_share(const Context& context, const ContactConstraint& constraint) {
  constexpr double sublayer = 25;  // y⁺ = 5, squared
  const ParticleMotion& p = *context.particles;
  const Contact& c = constraint.contact;
  const SurfaceMotion& s = *context.surfaces[c.surface];
  const double u = p.inverse_mass[c.particle];
  if (s.slip_on(c.back).model != SlipModel::sticking || !(u > 0)) return 0;
  const auto tangential = [&](const Vec3& v) { return (v - v.dot(c.normal) * c.normal).norm(); };
  const Vec3 &v = p.velocity[c.particle], slip = slip_velocity(context, c);
  const Vec3 change = context.start_velocity.empty() ? v : Vec3(v - context.start_velocity[c.particle]);
  const Liquid& liquid = context.liquid(c.particle);
  const double z = shear_distance(context, constraint), nu = liquid.viscosity,
               area = liquid.spacing * liquid.spacing;
  const double of_forces =
      tangential(change) * z * z / (u * context.dt * area * liquid.rest_density * nu * nu);
  const double ratio = std::max(of_forces, tangential(slip) * z / nu) / sublayer;
  return 1 / (1 + ratio * ratio);
}

/// What a node does under a push along the surface (C.43).
struct CarriedNode {
  double weight = 0;  // b_c
  double share = 0;   // b_c u_c [1/kg]
  double along = 0;   // cosine between the push and the load that the host carries
  double used = 0;    // change of velocity along that load, so far [m/s]
  double most = 0;    // a_c: as much of it the host will undo [m/s]

  /// The push after which the node yields fully [N s].
  double room() const {
    const double left = along < 0 ? most + used : most - used;
    return std::max(left, 0.0) / (share * std::abs(along));
  }
  double yield(bool is_carried) const { return weight * share * (is_carried ? 1 - along * along : 1); }
};

/// The nodes of a contact, seen along the surface.
class TangentialSupport {
 public:
  TangentialSupport(const Context& context, const Contact& c) : contact_(c) {
    const SurfaceMotion& s = *context.surfaces[c.surface];
    const HostSupport& host = context.hosts[c.surface];
    const auto tangential = [&](const Vec3& v) { return Vec3(v - v.dot(c.normal) * c.normal); };
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t node = c.nodes[k];
      carried_[k] = tangential(host.carried[node]);
      const double most = carried_[k].norm();
      CarriedNode& at = nodes_[k];
      at.weight = c.weights[k];
      at.share = c.weights[k] * s.inverse_mass[node];
      if (!(most > 0)) continue;
      carried_[k] /= most;
      at.most = most;
      at.used = carried_[k].dot(s.velocity[node] - host.velocity[node]);
    }
  }

  /// False: as if nothing were known of the host.
  bool carries() const {
    return std::any_of(nodes_.begin(), nodes_.end(), [](const CarriedNode& n) { return n.most > 0; });
  }

  /// What the host will undo of the velocity that the point of the surface has by now [m/s].
  Vec3 undone() const {
    Vec3 v = Vec3::Zero();
    for (std::size_t k = 0; k < 3; ++k)
      v += contact_.weights[k] * std::clamp(nodes_[k].used, -nodes_[k].most, nodes_[k].most) * carried_[k];
    return v;
  }

  /// The impulse on a particle that takes the speed of `vt`: against what is carried the surface is as if
  /// prescribed, beyond that it yields.
  double stopping_impulse(const Vec3& vt, double u, double k_tangent) {
    double speed = vt.norm(), impulse = 0;
    for (std::size_t k = 0; k < 3; ++k) nodes_[k].along = vt.dot(carried_[k]) / speed;
    std::array<bool, 3> is_carried{};
    for (std::size_t k = 0; k < 3; ++k) is_carried[k] = nodes_[k].most > 0 && nodes_[k].share > 0;
    while (true) {
      double yield = u, room = std::numeric_limits<double>::infinity();
      std::size_t first = 3;
      for (std::size_t k = 0; k < 3; ++k) {
        yield += nodes_[k].yield(is_carried[k]);
        if (!is_carried[k] || nodes_[k].along == 0 || !(nodes_[k].room() < room)) continue;
        room = nodes_[k].room();
        first = k;
      }
      const double part = std::max(0.0, room - impulse);
      if (!(speed > yield * part)) return impulse + speed / (yield > 0 ? yield : k_tangent);
      speed -= yield * part;
      impulse += part;
      is_carried[first] = false;
    }
  }

 private:
  const Contact& contact_;
  std::array<Vec3, 3> carried_;  // unit vectors
  std::array<CarriedNode, 3> nodes_;
};

/// J_0 of (C.16): the impulse, with what was given so far, after which the particle does not slip.
Vec3 sticking_impulse(const Context& context, const ContactConstraint& constraint, const Vec3& vt) {
  const Contact& c = constraint.contact;
  const SurfaceMotion& s = *context.surfaces[c.surface];
  Vec3 yielding = constraint.tangential_impulse - vt / constraint.k_tangent;
  if (s.body || context.hosts.empty() || context.hosts[c.surface].carried.empty()) return yielding;
  TangentialSupport support(context, c);
  if (!support.carries()) return yielding;
  const Vec3 slip = vt + support.undone();
  const double speed = slip.norm();
  if (!(speed > 0)) return constraint.tangential_impulse;
  const double u = context.particles->inverse_mass[c.particle];
  return constraint.tangential_impulse -
         support.stopping_impulse(slip, u, constraint.k_tangent) / speed * slip;
}

}  // namespace

Vec3 slip_velocity(const Context& context, const Contact& c) {
  Vec3 v = relative_velocity(context, c);
  const SurfaceMotion& s = *context.surfaces[c.surface];
  if (!s.body || context.hosts.empty() || context.hosts[c.surface].carried.empty()) return v;
  const HostSupport& host = context.hosts[c.surface];
  OILSKIN_ASSERT(host.velocity.size() == 2 && host.carried.size() == 2);
  return v + clamped_part(s.body->velocity - host.velocity[0], host.carried[0], -1, 1) +
         clamped_part(s.body->angular_velocity - host.velocity[1], host.carried[1], -1, 1)
             .cross(arm_of(s, c));
}

// A particle represents dx² of each wall that it sees: once if several contacts belong to one wall (inner
// edges of a flat sheet, a cloth on a floor), twice in a corner. A contact gets the area that nearer contacts
// of the particle leave, by the component of its normal that theirs do not have.
void distribute_wall_area(const Context& context, std::vector<ContactConstraint>& constraints) {
  for (std::size_t begin = 0, end = 0; begin < constraints.size(); begin = end) {
    while (end < constraints.size() &&
           constraints[end].contact.particle == constraints[begin].contact.particle)
      ++end;
    const double spacing = context.liquid(constraints[begin].contact.particle).spacing;
    for (std::size_t k = begin; k < end; ++k) {
      const Contact& c = constraints[k].contact;
      if (!has_wall_area(context, constraints[k])) continue;
      double fraction = c.normal_alignment;
      for (std::size_t o = begin; o < end; ++o) {
        const Contact& other = constraints[o].contact;
        const bool nearer = other.distance < c.distance || (other.distance == c.distance && o < k);
        if (nearer) fraction *= 1 - std::clamp(c.normal.dot(other.normal), 0.0, 1.0);
      }
      OILSKIN_ASSERT(fraction >= 0 && fraction < 1 + 1e-9);
      constraints[k].wall_area = fraction * (spacing * spacing);
      constraints[k].viscous_share = viscous_share(context, constraints[k]);
    }
  }
}

Vec3 tangential_impulse(const Context& context, const ContactConstraint& constraint, const Vec3& vt) {
  OILSKIN_ASSERT(constraint.k > 0 && constraint.k_tangent > 0 && vt.allFinite());
  const SurfaceMotion& surface = *context.surfaces[constraint.contact.surface];
  const SlipSettings& slip = surface.slip_on(constraint.contact.back);
  switch (slip.model) {
    case SlipModel::free:
      return Vec3::Zero();
    case SlipModel::coulomb: {
      const Vec3 sticking = sticking_impulse(context, constraint, vt);
      const double normal = constraint.friction_load();
      const double limit = normal > 0 ? slip.friction * normal : 0;  // 0, not NaN, for infinite friction
      const double size = sticking.norm();
      return size <= limit ? sticking : Vec3(sticking * (limit / size));
    }
    case SlipModel::sticking: {
      Vec3 sticking = sticking_impulse(context, constraint, vt);
      if (constraint.viscous_share == 0) return sticking;
      const double drag = wall_drag(context, constraint, 0);
      return (1 - constraint.viscous_share / (1 + drag * constraint.k_tangent)) * sticking;
    }
    case SlipModel::viscous_wall: {
      // (C.17): implicit, so that it never reverses the velocity.
      const double drag = wall_drag(context, constraint, slip.slip_length);
      const Vec3 velocity_without = vt - constraint.k_tangent * constraint.tangential_impulse;
      return -drag / (1 + drag * constraint.k_tangent) * velocity_without;
    }
  }
  return Vec3::Zero();
}

}  // namespace oilskin::contact
