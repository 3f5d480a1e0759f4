#include "proximity/box_tree.h"

#include <algorithm>

#include "core/assert.h"

namespace oilskin::proximity {

void BoxTree::assign(const std::vector<Link>& links) {
  nodes_.resize(links.size());
  for (std::size_t i = 0; i < links.size(); ++i) {
    nodes_[i].child = links[i].child;
    OILSKIN_ASSERT(links[i].child < 0 || (static_cast<std::size_t>(links[i].child) > i &&
                                          static_cast<std::size_t>(links[i].child) + 1 < links.size()));
  }
}

void BoxTree::refit(const std::vector<Box>& boxes) {
  for (std::size_t i = nodes_.size(); i-- > 0;) {
    Node& n = nodes_[i];
    if (n.child < 0) {
      const Box& box = boxes[static_cast<std::size_t>(-1 - n.child)];
      for (int k = 0; k < 3; ++k) {
        n.bound[k] = -box.min[k];
        n.bound[3 + k] = box.max[k];
      }
    } else {
      const Node *left = &nodes_[static_cast<std::size_t>(n.child)], *right = left + 1;
      for (int k = 0; k < 6; ++k) n.bound[k] = std::max(left->bound[k], right->bound[k]);
    }
  }
  size_of_leaves_ = size_of_nodes_ = 0;
  for (const Node& n : nodes_) {
    double size = 0;
    for (int k = 0; k < 3; ++k) size += n.bound[3 + k] + n.bound[k];
    size_of_nodes_ += size;
    if (n.child < 0) size_of_leaves_ += size;
  }
}

bool BoxTree::collect(const Box& box, std::size_t limit, std::vector<std::int32_t>& stack,
                      std::vector<std::uint32_t>& found) const {
  Limits limits{};
  for (int k = 0; k < 3; ++k) {
    limits.limit[k] = -box.max[k];
    limits.limit[3 + k] = box.min[k];
  }
  stack.clear();
  if (!nodes_.empty() && overlap(nodes_.front(), limits)) stack.push_back(0);
  // On the heap: trees get deep if centroids converge geometrically.
  std::size_t count = 0;
  while (!stack.empty()) {
    const std::int32_t child = nodes_[static_cast<std::size_t>(stack.back())].child;
    stack.pop_back();
    if (child < 0) {
      if (count++ == limit) return false;
      found.push_back(static_cast<std::uint32_t>(-1 - child));
      continue;
    }
    const Node* left = &nodes_[static_cast<std::size_t>(child)];
    if (overlap(left[1], limits)) stack.push_back(child + 1);
    if (overlap(left[0], limits)) stack.push_back(child);
  }
  return true;
}

}  // namespace oilskin::proximity
