/// Which triangles of a surface are looked at.
#pragma once

#include <vector>

#include "core/assert.h"
#include "oilskin/types.h"

namespace oilskin::fluid {

/// Triangles of a surface, ascending.
using TriangleList = std::vector<std::uint32_t>;

/// Those of a list, or all.
class TriangleChoice {
 public:
  /// `lists`: one per surface; empty = all of all surfaces.
  TriangleChoice(Span<const TriangleList> lists, std::size_t surface, std::size_t all)
      : list_(lists.empty() ? nullptr : &lists[surface]), size_(list_ ? list_->size() : all) {
    OILSKIN_ASSERT(list_ == nullptr || list_->empty() || list_->back() < all);
  }
  std::size_t size() const { return size_; }
  std::uint32_t operator[](std::size_t k) const {
    return list_ ? (*list_)[k] : static_cast<std::uint32_t>(k);
  }

 private:
  const TriangleList* list_;
  std::size_t size_;
};

}  // namespace oilskin::fluid
