/// Where slip acts, on which side of a surface, and over how much of it.
#pragma once

#include "contact/constraints.h"

namespace oilskin::contact {

/// How a surface looks from a point at distance > 0 whose closest feature is given.
struct SurfaceSide {
  bool back = false;  ///< seen from the side that the triangles' normals turn away from
  double share =
      1;  ///< σ of (C.7): |cos| of the angle between the offset and the nearest normal of the triangles there
};

/// `feature` as ClosestPoint has it. The side is that of the angle-weighted normal [Baerentzen2005] (C.8),
/// right at sharp folds, too; the front where there is no telling: in the plane of a border, at degenerate
/// triangles, at duplicates of both windings.
SurfaceSide side_of(const MeshTopology& topology, Span<const Triangle> triangles, Span<const Vec3> x,
                    std::uint32_t triangle, std::uint8_t feature, const Vec3& normal);

/// Sets Row::wall_area (C.19) of the rows of records, which are ordered by particle.
void distribute_wall_area(const Context& context, std::vector<ContactConstraint>& constraints);

/// The tangential impulse that the surface's law allows, given the present tangential velocity v_t
/// (C.16), (C.17).
Vec3 tangential_impulse(const Context& context, const ContactConstraint& constraint, const Vec3& vt);

}  // namespace oilskin::contact
