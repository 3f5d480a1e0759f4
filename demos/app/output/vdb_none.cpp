/// Stands in for OpenVDB where the program was built without it.
#include <stdexcept>

#include "output/vdb_file.h"

namespace oilskin::demo {

bool vdb_available() {
  return false;
}

void write_vdb(const std::string&, const SurfaceFile&) {
  throw std::logic_error("require_formats() refuses vdb");
}

std::string vdb_made_with(const std::string&) {
  throw std::logic_error("require_formats() refuses vdb");
}

}  // namespace oilskin::demo
