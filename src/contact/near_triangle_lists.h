/// Which triangles may be near the fluid: all others are left out where every triangle would be visited.
#pragma once

#include "contact/surface_geometry.h"

namespace oilskin::contact {

class NearTriangleLists {
 public:
  /// Per surface, ascending: the triangles whose box in the surface's tree, as it is fitted, overlaps one of
  /// `boxes` inflated by `reach` [m]. Valid until the next call.
  Span<const std::vector<std::uint32_t>> find(Span<SurfaceGeometry* const> surfaces, Span<const Box> boxes,
                                              double reach, const Workers& workers);

 private:
  std::vector<std::vector<std::uint32_t>> lists_;
  std::vector<std::uint8_t> is_listed_;  // per triangle
  std::vector<Box> inflated_, overlapping_;
  proximity::Candidates found_;
};

}  // namespace oilskin::contact
