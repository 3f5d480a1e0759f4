#include "contact/near_triangle_lists.h"

#include <algorithm>

namespace oilskin::contact {

Span<const std::vector<std::uint32_t>> NearTriangleLists::find(Span<SurfaceGeometry* const> surfaces,
                                                               Span<const Box> boxes, double reach,
                                                               const Workers& workers) {
  constexpr double rounding = 1 + 1e-9;
  inflated_.clear();
  for (const Box& box : boxes) inflated_.push_back(box.inflated(reach * rounding));
  lists_.resize(surfaces.size());
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    std::vector<std::uint32_t>& list = lists_[s];
    list.clear();
    const std::size_t triangles = surfaces[s]->topology.triangle_count();
    is_listed_.assign(std::max(is_listed_.size(), triangles), 0);
    surfaces[s]->tree.query(inflated_, workers, found_);
    for (const std::uint32_t t : found_.triangle) {
      if (is_listed_[t]) continue;
      is_listed_[t] = 1;
      list.push_back(t);
    }
    // Of a large level a few triangles are near, of cloth in water a large part.
    if (list.size() < triangles / 64) {
      std::sort(list.begin(), list.end());
    } else {
      list.clear();
      for (std::uint32_t t = 0; t < triangles; ++t)
        if (is_listed_[t]) list.push_back(t);
    }
  }
  return lists_;
}

}  // namespace oilskin::contact
