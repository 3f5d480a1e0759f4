#include "checks/resident_memory.h"

#include <unistd.h>

#include <fstream>

namespace oilskin::demo {
namespace {

/// Of this process, now; 0 where the system does not say [bytes].
std::uint64_t resident_bytes() {
  std::ifstream statm("/proc/self/statm");
  std::uint64_t size = 0, resident = 0;
  statm >> size >> resident;
  return resident * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

}  // namespace

void ResidentMemory::after_step(double t, double duration) {
  if (after_a_fifth_ == 0 && t >= 0.2 * duration) after_a_fifth_ = resident_bytes();
}

void ResidentMemory::finish() {
  at_end_ = resident_bytes();
}

}  // namespace oilskin::demo
