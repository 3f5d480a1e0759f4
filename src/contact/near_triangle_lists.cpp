#include "contact/near_triangle_lists.h"

#include <algorithm>

namespace oilskin::contact {

Span<const std::vector<std::uint32_t>> NearTriangleLists::find(Span<SurfaceGeometry* const> surfaces,
                                                               Span<const Box> boxes, double reach) {
  constexpr double rounding = 1 + 1e-9;
  lists_.resize(surfaces.size());
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    std::vector<std::uint32_t>& list = lists_[s];
    list.clear();
    is_listed_.assign(std::max(is_listed_.size(), surfaces[s]->topology.triangle_count()), 0);
    for (const Box& box : boxes) {
      found_.clear();
      surfaces[s]->tree.query(box.inflated(reach * rounding), found_);
      for (std::uint32_t t : found_) {
        if (is_listed_[t]) continue;
        is_listed_[t] = 1;
        list.push_back(t);
      }
    }
    std::sort(list.begin(), list.end());
  }
  return lists_;
}

}  // namespace oilskin::contact
