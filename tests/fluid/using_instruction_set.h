/// The kernels of one instruction set for the life of an object.
#pragma once

#include <cstring>
#include <vector>

#include "fluid/pairs/pair_kernels.h"

namespace oilskin::fluid {

/// Uses a set, and the best one again at the end.
struct Using {
  explicit Using(InstructionSet set) { use(set); }
  ~Using() {
    for (const InstructionSet set : all_instruction_sets)
      if (is_available(set)) use(set);
  }
  Using(const Using&) = delete;
  Using& operator=(const Using&) = delete;
};

/// Those of this machine beside the baseline.
inline std::vector<InstructionSet> others() {
  std::vector<InstructionSet> sets;
  for (const InstructionSet set : all_instruction_sets)
    if (set != InstructionSet::baseline && is_available(set)) sets.push_back(set);
  return sets;
}

inline std::uint64_t bits(double x) {
  std::uint64_t b;
  std::memcpy(&b, &x, sizeof b);
  return b;
}

}  // namespace oilskin::fluid
