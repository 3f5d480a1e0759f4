/// Regions in a saved state.
#pragma once

#include "core/archive.h"
#include "oilskin/region.h"

namespace oilskin {

// Structured bindings name every member: a new member that is not saved does not compile.

template <class T, class Visit>
void visit_optional(Archive& archive, std::optional<T>& value, const Visit& visit_value) {
  bool has = value.has_value();
  archive.value(has);
  if (!has) value.reset();
  if (has && !value) value.emplace();
  if (has) visit_value(*value);
}

inline void visit(Archive& archive, Region& region) {
  auto& [box, capsule, half_spaces, pose] = region;
  visit_optional(archive, box, [&](Box& b) { archive.value(b); });
  visit_optional(archive, capsule, [&](Capsule& c) {
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
