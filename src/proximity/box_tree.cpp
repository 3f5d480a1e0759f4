#include "proximity/box_tree.h"

#include <algorithm>

#include "core/assert.h"

namespace oilskin::proximity {

namespace {

/// Nodes of a branch that are worth a task.
constexpr std::size_t smallest_branch = 256;

}  // namespace

void BoxTree::assign(const std::vector<Link>& links, const Workers& workers) {
  nodes_.resize(links.size());
  for (std::size_t i = 0; i < links.size(); ++i) {
    nodes_[i].child = links[i].child;
    OILSKIN_ASSERT(links[i].child < 0 || (static_cast<std::size_t>(links[i].child) > i &&
                                          static_cast<std::size_t>(links[i].child) + 1 < links.size()));
  }
  list_branches(workers);
}

/// Branches of about equal numbers of nodes, and what is above them.
void BoxTree::list_branches(const Workers& workers) {
  const std::size_t n = nodes_.size(), largest = even_chunk(n, smallest_branch);
  std::vector<std::uint32_t> size(n, 1);  // of the branch below each node, with it
  for (std::size_t i = n; i-- > 0;)
    if (nodes_[i].child >= 0) {
      const auto child = static_cast<std::size_t>(nodes_[i].child);
      size[i] += size[child] + size[child + 1];
    }
  std::vector<std::uint32_t> branch(n, 0);  // numbers from 1; 0 = above all
  branches_ = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (branch[i] == 0 && size[i] <= largest) branch[i] = static_cast<std::uint32_t>(++branches_);
    if (nodes_[i].child < 0) continue;
    const auto child = static_cast<std::size_t>(nodes_[i].child);
    branch[child] = branch[child + 1] = branch[i];
  }
  const auto from_last = [&](std::size_t begin, std::size_t end, const auto& f) {
    for (std::size_t k = begin; k < end; ++k) f(branch[n - 1 - k], static_cast<std::uint32_t>(n - 1 - k));
  };
  sort_by_key(n, smallest_branch, branches_ + 1, from_last, workers, order_);
}

void BoxTree::refit(const std::vector<Box>& boxes, const Workers& workers) {
  sizes_ = workers.ordered_sum(branches_, 1, Sizes(), [&](std::size_t branch, std::size_t) {
    return refit_nodes(boxes, order_.of(branch + 1));
  });
  sizes_ += refit_nodes(boxes, order_.of(0));
}

BoxTree::Sizes BoxTree::refit_nodes(const std::vector<Box>& boxes, Span<const std::uint32_t> order) {
  Sizes sizes;
  for (const std::uint32_t node : order) {
    Node& n = nodes_[node];
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
    double size = 0;
    for (int k = 0; k < 3; ++k) size += n.bound[3 + k] + n.bound[k];
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
