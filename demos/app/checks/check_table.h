/// All acceptance checks.
#pragma once

#include "checks/check.h"

namespace oilskin::demo {

struct CheckEntry {
  /// Its key in the object `acceptance` of a scene; null: it belongs to every run.
  const char* key;
  std::unique_ptr<Check> (*make)();
};

/// In the order in which they stand in reports.
Span<const CheckEntry> check_table();

}  // namespace oilskin::demo
