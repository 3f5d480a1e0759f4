/// A binary tree over axis-aligned boxes, to find those that overlap another. Boxes may differ in size by any
/// factor, as those of triangles and paths at 500 m/s do.
#pragma once

#include "oilskin/types.h"

namespace oilskin::study {

class BoxTree {
 public:
  /// Replaces all boxes; they must be finite.
  void build(std::vector<Box> boxes);

  /// visit(index) for every box that shares a point with `query`, in an order that depends on the boxes
  /// alone.
  template <class Visit>
  void for_each_overlap(const Box& query, const Visit& visit) const {
    if (nodes_.empty()) return;
    std::array<std::uint32_t, 64> stack;
    std::size_t height = 0;
    stack[height++] = 0;
    while (height > 0) {
      const Node& node = nodes_[stack[--height]];
      if (!node.box.overlaps(query)) continue;
      if (node.right == 0) {
        for (std::uint32_t k = node.begin; k < node.end; ++k)
          if (boxes_[order_[k]].overlaps(query)) visit(order_[k]);
        continue;
      }
      stack[height++] = node.right;
      stack[height++] = static_cast<std::uint32_t>(&node - nodes_.data()) + 1;
    }
  }

 private:
  struct Node {
    Box box;
    std::uint32_t begin = 0, end = 0;  // in order_
    std::uint32_t right = 0;           // 0 = a leaf; the left child is the next node
  };
  std::uint32_t add(std::uint32_t begin, std::uint32_t end);

  std::vector<Box> boxes_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace oilskin::study
