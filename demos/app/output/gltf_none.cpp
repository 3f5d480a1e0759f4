/// Stands in for TinyGLTF where the program was built without it.
#include <stdexcept>

#include "output/gltf_file.h"

namespace oilskin::demo {

bool gltf_available() {
  return false;
}

void write_gltf(const std::string&, const SurfaceFile&) {
  throw std::logic_error("require_formats() refuses glb");
}

std::string gltf_made_with(const std::string&) {
  throw std::logic_error("require_formats() refuses glb");
}

bool gltf_is_whole(const std::string&) {
  throw std::logic_error("require_formats() refuses glb");
}

}  // namespace oilskin::demo
