#include "oilskin/region.h"

#include <algorithm>

#include "core/box_around.h"
#include "core/refuse.h"

namespace oilskin {

namespace {

bool contains(const Capsule& capsule, const Vec3& x) {
  const Vec3 along = capsule.to - capsule.from, from = x - capsule.from;
  const double length = along.squaredNorm();
  const double t = length > 0 ? std::clamp(from.dot(along) / length, 0.0, 1.0) : 0;
  return (from - t * along).norm() <= capsule.radius;
}

Status check(const Capsule& capsule) {
  if (Status s = check_point("region: capsule.from", capsule.from); !s.ok()) return s;
  if (Status s = check_point("region: capsule.to", capsule.to); !s.ok()) return s;
  return capsule.radius > 0 && std::isfinite(capsule.radius)
             ? Status()
             : refuse_value("region: capsule.radius", capsule.radius, "finite and > 0 m");
}

Status check(const HalfSpace& half) {
  if (Status s = check_point("region: half_space.point", half.point); !s.ok()) return s;
  return half.normal.allFinite() && half.normal.stableNorm() > 0
             ? Status()
             : refuse_value("region: half_space.normal", half.normal.transpose(), "finite and longer than 0");
}

}  // namespace

bool Region::contains(const Vec3& x) const {
  const Vec3 local = pose.rotation.conjugate() * (x - pose.position);
  if (box && !box->contains(local)) return false;
  if (capsule && !oilskin::contains(*capsule, local)) return false;
  return std::all_of(half_spaces.begin(), half_spaces.end(),
                     [&](const HalfSpace& half) { return half.normal.dot(local - half.point) <= 0; });
}

std::optional<Box> Region::bounds() const {
  Box own;
  if (capsule) {
    own.add(capsule->from);
    own.add(capsule->to);
    own = own.inflated(capsule->radius);
  } else if (box) {
    own = *box;
  } else {
    return {};
  }
  const Rotation turn = pose.rotation.normalized();
  return box_around(own, [&](const Vec3& x) { return Vec3(pose.position + turn * x); });
}

Status Region::validate() const {
  if (box)
    if (Status s = check_box(*box); !s.ok()) return Status::refused("region: " + s.message);
  if (capsule)
    if (Status s = check(*capsule); !s.ok()) return s;
  for (const HalfSpace& half : half_spaces)
    if (Status s = check(half); !s.ok()) return s;
  if (Status s = check_point("region: position", pose.position); !s.ok()) return s;
  return std::abs(pose.rotation.norm() - 1) <= 1e-6
             ? Status()
             : refuse_value("region: rotation", pose.rotation.coeffs().transpose(), "of length 1");
}

Region box_region(const Box& box) {
  Region region;
  region.box = box;
  return region;
}

Region ball_region(const Vec3& center, double radius) {
  Region region;
  region.capsule = Capsule{center, center, radius};
  return region;
}

}  // namespace oilskin
