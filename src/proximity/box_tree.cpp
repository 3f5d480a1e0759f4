#include "proximity/box_tree.h"

#include <algorithm>
#include <numeric>

#include "core/assert.h"

namespace oilskin::proximity {

namespace {

/// Of refit(): the number of branches that threads take one by one, and the nodes that are worth a task.
constexpr std::size_t parts_wanted = 32, smallest_part = 256;

}  // namespace

void BoxTree::assign(const std::vector<Link>& links) {
  nodes_.resize(links.size());
  for (std::size_t i = 0; i < links.size(); ++i) {
    nodes_[i].child = links[i].child;
    OILSKIN_ASSERT(links[i].child < 0 || (static_cast<std::size_t>(links[i].child) > i &&
                                          static_cast<std::size_t>(links[i].child) + 1 < links.size()));
  }
  list_parts();
}

/// Branches of about equal numbers of nodes, and what is above them.
void BoxTree::list_parts() {
  const std::size_t n = nodes_.size(), largest = std::max<std::size_t>(n / parts_wanted, smallest_part);
  std::vector<std::uint32_t> size(n, 1);  // of the branch below each node, with it
  for (std::size_t i = n; i-- > 0;)
    if (nodes_[i].child >= 0) {
      const auto child = static_cast<std::size_t>(nodes_[i].child);
      size[i] += size[child] + size[child + 1];
    }
  constexpr std::uint32_t above = 0;
  std::vector<std::uint32_t> part(n, above);  // numbers from 1
  std::uint32_t parts = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (part[i] == above && size[i] <= largest) part[i] = ++parts;
    if (nodes_[i].child < 0) continue;
    const auto child = static_cast<std::size_t>(nodes_[i].child);
    part[child] = part[child + 1] = part[i];
  }
  for (std::uint32_t& p : part) p = p == above ? parts : p - 1;
  part_begin_.assign(parts + 2, 0);
  for (const std::uint32_t p : part) ++part_begin_[p + 1];
  std::partial_sum(part_begin_.begin(), part_begin_.end(), part_begin_.begin());
  order_.resize(n);
  std::vector<std::size_t> at(part_begin_.begin(), part_begin_.end() - 1);
  for (std::size_t i = n; i-- > 0;) order_[at[part[i]]++] = static_cast<std::uint32_t>(i);
}

void BoxTree::refit(const std::vector<Box>& boxes, const Workers& workers) {
  const std::size_t branches = part_begin_.size() - 2;
  sizes_ = workers.ordered_sum(branches, 1, Sizes(), [&](std::size_t branch, std::size_t) {
    return refit_nodes(boxes, part_begin_[branch], part_begin_[branch + 1]);
  });
  sizes_ += refit_nodes(boxes, part_begin_[branches], part_begin_[branches + 1]);
}

BoxTree::Sizes BoxTree::refit_nodes(const std::vector<Box>& boxes, std::size_t begin, std::size_t end) {
  Sizes sizes;
  for (std::size_t k = begin; k < end; ++k) {
    Node& n = nodes_[order_[k]];
    if (n.child < 0) {
      const Box& box = boxes[static_cast<std::size_t>(-1 - n.child)];
      for (int a = 0; a < 3; ++a) {
        n.bound[a] = -box.min[a];
        n.bound[3 + a] = box.max[a];
      }
    } else {
      const Node *left = &nodes_[static_cast<std::size_t>(n.child)], *right = left + 1;
      for (int a = 0; a < 6; ++a) n.bound[a] = std::max(left->bound[a], right->bound[a]);
    }
    double size = 0;
    for (int a = 0; a < 3; ++a) size += n.bound[3 + a] + n.bound[a];
    sizes.nodes += size;
    if (n.child < 0) sizes.leaves += size;
  }
  return sizes;
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
