/// @file
/// Parts of space, for sinks and force fields.
#pragma once

#include <optional>

#include "oilskin/emitter.h"

namespace oilskin {

/// The points x with normal · (x − point) ≤ 0.
struct HalfSpace {
  /// A point of its border [m].
  Vec3 point = Vec3::Zero();
  /// Away from it, of any length > 0.
  Vec3 normal = Vec3(0, 1, 0);
};

/// The points within `radius` of a segment: a ball where both ends are the same.
struct Capsule {
  /// An end of the segment [m].
  Vec3 from = Vec3::Zero();
  /// The other end [m].
  Vec3 to = Vec3::Zero();
  /// [m], > 0.
  double radius = 1;
};

/// A convex part of space, border included: the points that lie in all that is given. A region without any of
/// them is all of space.
struct Region {
  /// A box [m].
  std::optional<Box> box;
  /// A ball or capsule.
  std::optional<Capsule> capsule;
  /// A convex body, by its faces.
  std::vector<HalfSpace> half_spaces;
  /// Where the origin of all these is put: they are turned around the origin of their own frame, then shifted
  /// [m].
  EmitterPose pose = {};

  /// Whether a point [m] lies in it.
  bool contains(const Vec3& x) const;
  /// A box around it [m]; none where neither `box` nor `capsule` bounds it.
  std::optional<Box> bounds() const;
  /// Accepted, or the first number that is not finite or out of range.
  Status validate() const;
};

/// A box as a region.
Region box_region(const Box& box);
/// A ball as a region.
Region ball_region(const Vec3& center, double radius);

}  // namespace oilskin
