/// The rigid motion of a body within an interval.
#pragma once

#include <optional>

#include "oilskin/surface_motion.h"

namespace oilskin {

/// x → c¹ + R (x − c⁰).
struct BodyPath {
  Vec3 center_t0, center_t1;
  Eigen::Matrix3d rotation;

  Vec3 end_of(const Vec3& start) const { return center_t1 + rotation * (start - center_t0); }
  Vec3 start_of(const Vec3& end) const { return center_t0 + rotation.transpose() * (end - center_t1); }
  /// The motion of the first `fraction` of the time, 0 … 1, at a constant velocity about a constant axis, by
  /// the smaller angle.
  BodyPath part(double fraction) const;
};

/// R is the rotation that takes the nodes from x_t0 to x_t0 + displacement[i] with the least squares of
/// errors [Kabsch1976]. `displacement` has as many as there are nodes of the surface, which has a body.
BodyPath path_of_body(const SurfaceMotion& surface, const Vec3* displacement);
/// To where contact left the nodes, x_t1.
BodyPath path_of_body(const SurfaceMotion& surface);

/// The rigid motion that takes each of `before` to that of `after` within `tolerance` [m]; none if there is
/// none. Centres are means.
std::optional<BodyPath> rigid_motion_between(Span<const Vec3> before, Span<const Vec3> after,
                                             double tolerance);
/// 16 ε R with the largest absolute coordinate R: what storing the nodes of a rigid motion changes [m].
double rounding_of(const SurfaceMotion& surface);

/// The turn about one axis, with a shift along it, that takes each of `before` to that of `after` within
/// `tolerance` [m]; none where no rigid motion does, and where the path differs from straight lines by
/// rounding alone.
std::optional<BodyPath> turn_between(Span<const Vec3> before, Span<const Vec3> after, double tolerance);

/// Whether the host decides where each node goes, and the surface has no body.
bool all_prescribed(const SurfaceMotion& surface);

/// Where the centre of mass was at the start, by the nodes: of a surface that has become a body's.
Vec3 center_at_start(const SurfaceMotion& surface);

}  // namespace oilskin
