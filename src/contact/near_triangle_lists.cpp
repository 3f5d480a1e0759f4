#include "contact/near_triangle_lists.h"

#include <algorithm>
#include <iterator>

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
    // Most surfaces of a level of many are far from most of the boxes.
    const Box bounds = surfaces[s]->tree.bounds();
    overlapping_.clear();
    std::copy_if(inflated_.begin(), inflated_.end(), std::back_inserter(overlapping_),
                 [&](const Box& box) { return box.overlaps(bounds); });
    if (overlapping_.empty()) continue;
    surfaces[s]->tree.query(overlapping_, workers, found_);
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
