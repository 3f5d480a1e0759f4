/// Regions in a saved state.
#pragma once

#include "core/archive.h"
#include "oilskin/region.h"

namespace oilskin {

// Structured bindings name every member: a new member that is not saved does not compile.

inline void visit(Archive& archive, Region& region) {
  auto& [box, capsule, half_spaces, pose] = region;
  archive.optional(box, [&](Box& b) { archive.value(b); });
  archive.optional(capsule, [&](Capsule& c) {
    auto& [from, to, radius] = c;
    archive.values(from, to, radius);
  });
  archive.list(half_spaces, sizeof(HalfSpace), [&](HalfSpace& half) {
    auto& [point, normal] = half;
    archive.values(point, normal);
  });
  auto& [position, rotation] = pose;
  archive.values(position, rotation.x(), rotation.y(), rotation.z(), rotation.w());
  archive.require(region.validate().ok(), "a region");
}

}  // namespace oilskin
