/// What the boundary needs to know of a surface's mesh, once per topology.
#pragma once

#include <vector>

#include "oilskin/surface_motion.h"

namespace oilskin::fluid {

class SurfaceMesh {
 public:
  SurfaceMesh() = default;
  explicit SurfaceMesh(const SurfaceMotion& surface);

  std::size_t triangles() const { return repeated_.size(); }
  /// An earlier triangle has the same three nodes.
  bool is_repeated(std::uint32_t triangle) const { return repeated_[triangle] != 0; }
  /// A corner of the triangle lies on a border edge.
  bool is_at_border(std::uint32_t triangle) const { return at_border_[triangle] != 0; }

 private:
  std::vector<std::uint8_t> repeated_, at_border_;
};

}  // namespace oilskin::fluid
