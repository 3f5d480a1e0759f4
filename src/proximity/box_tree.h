/// A bounding-volume tree over boxes, as a flat array of nodes. The caller gives the structure.
#pragma once

#include <vector>

#include "core/sort_by_key.h"
#include "oilskin/types.h"

namespace oilskin::proximity {

class BoxTree {
 public:
  /// Parents come before their children, and the two children of a node side by side.
  struct Link {
    std::int32_t child = 0;  ///< index of the first child; of a leaf, −1 − its box
  };

  void clear() { *this = BoxTree(); }
  bool empty() const { return nodes_.empty(); }
  /// The structure, node 0 being the root. Boxes follow by refit().
  void assign(const std::vector<Link>& links, const Workers& workers);
  /// Leaves get their boxes, other nodes the union of their children, without rounding.
  void refit(const std::vector<Box>& boxes, const Workers& workers);

  Box bounds() const { return box_of(nodes_.front()); }
  double size_of_leaves() const { return sizes_.leaves; }  ///< sum over leaves of the sums of their sides [m]
  double size_of_nodes() const { return sizes_.nodes; }    ///< the same over all nodes

  /// Appends the boxes that overlap the closed `box`, unordered, to `found`. False if it stopped because
  /// there are more than `limit`. `stack` is memory for it.
  bool collect(const Box& box, std::size_t limit, std::vector<std::int32_t>& stack,
               std::vector<std::uint32_t>& found) const;

 private:
  /// Six comparisons of one kind decide about overlap: bound[k] ≥ limit[k].
  struct Node {
    double bound[6];  // −min, max
    std::int32_t child;
  };
  struct Limits {
    double limit[6];  // −max, min
  };
  struct Sizes {
    double leaves = 0, nodes = 0;
    void operator+=(const Sizes& o) {
      leaves += o.leaves;
      nodes += o.nodes;
    }
  };

  static Box box_of(const Node& n) {
    return {Vec3(-n.bound[0], -n.bound[1], -n.bound[2]), Vec3(n.bound[3], n.bound[4], n.bound[5])};
  }
  static bool overlap(const Node& n, const Limits& l) {
    bool all = true;
    for (int k = 0; k < 6; ++k) all &= n.bound[k] >= l.limit[k];
    return all;
  }

  void list_branches(const Workers& workers);
  Sizes refit_nodes(const std::vector<Box>& boxes, Span<const std::uint32_t> order);

  std::vector<Node> nodes_;
  // In the order in which they are refitted, children first: those above all branches, and those of each
  // branch.
  KeyedLists<std::uint32_t> order_;
  std::size_t branches_ = 0;
  Sizes sizes_;
};

}  // namespace oilskin::proximity
