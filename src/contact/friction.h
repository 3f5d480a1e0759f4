/// Friction laws: their reach, the side of a surface, the wall area of a particle, and their impulses.
#pragma once

#include "contact/constraints.h"

namespace oilskin::contact {

/// Orientation of a surface at its closest feature to a point.
struct SurfaceSide {
  bool back = false;            ///< the point is on the back
  double normal_alignment = 1;  ///< σ of (C.7)
};

/// `feature`: as in ClosestPoint. `normal`: from the feature to the point. The side follows from the
/// angle-weighted normal [Baerentzen2005] (C.8). It is the front where that does not decide: in the plane of
/// a border, at degenerate triangles, and at duplicates of both windings.
SurfaceSide side_of(const MeshTopology& topology, Span<const Triangle> triangles, Span<const Vec3> x,
                    std::uint32_t triangle, std::uint8_t feature, const Vec3& normal);

/// Sets ContactConstraint::wall_area (C.19) and viscous_share (B.36). Constraints are ordered by particle.
void distribute_wall_area(const Context& context, std::vector<ContactConstraint>& constraints);

/// Of the particle against the surface, as friction sees it: without what the host of a body will undo
/// (C.44).
Vec3 slip_velocity(const Context& context, const Contact& contact);

/// The accumulated tangential impulse of the surface's law for the current tangential velocity v_t (C.16),
/// (C.17) [N s].
Vec3 tangential_impulse(const Context& context, const ContactConstraint& constraint, const Vec3& vt);

}  // namespace oilskin::contact
