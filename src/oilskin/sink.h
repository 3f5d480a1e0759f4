/// @file
/// Sinks: parts of space in which particles end.
#pragma once

#include "oilskin/region.h"

namespace oilskin {

/// The handle of a sink.
struct SinkId {
  /// 0 = none.
  std::uint64_t value = 0;
  /// Whether it is the handle of a sink.
  explicit operator bool() const { return value != 0; }
  /// Whether two handles are the same.
  bool operator==(SinkId o) const { return value == o.value; }
};

/// What a sink does.
struct SinkState {
  /// Where it is.
  Region region;
  /// World::set_sink_enabled().
  bool enabled = true;
  /// How many particles have ended in it.
  std::uint64_t particles = 0;
  /// Their volume at the rest density [m³].
  double volume = 0;
};

}  // namespace oilskin
