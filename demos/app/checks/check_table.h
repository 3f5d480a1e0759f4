/// All acceptance checks.
#pragma once

#include "checks/check.h"

namespace oilskin::demo {

struct CheckEntry {
  /// The key in the object `acceptance` of a scene that requests the check; null: every run has it. at_rest
  /// is such a check: its list of boxes is empty unless the scene has the key.
  const char* key;
  std::unique_ptr<Check> (*make)();
};

/// In the order in which they stand in reports.
Span<const CheckEntry> check_table();

}  // namespace oilskin::demo
