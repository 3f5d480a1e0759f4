/// The state of a bounding volume tree of Bullet's. The shape of such a tree decides in which order contacts
/// are found, so that it is part of what determines the next step.
#pragma once

#include <BulletCollision/BroadphaseCollision/btDbvt.h>

#include <functional>

#include "core/archive.h"

namespace oilskin::bullet {

/// A tree in preorder. Bullet turns its trees by comparing the addresses of inner nodes, so each inner node
/// keeps its rank in their order.
struct TreeState {
  struct Node {
    btVector3 min, max;      ///< [m]
    std::int32_t leaf = -1;  ///< the number of a leaf's datum; −1 = inner node
    std::uint32_t rank = 0;  ///< of an inner node's address among those of all
  };
  std::vector<Node> nodes;
  std::int32_t lookahead = -1;
  std::uint32_t path = 0;

  std::size_t leaves() const { return (nodes.size() + 1) / 2; }
};

/// All nodes, in preorder.
std::vector<btDbvtNode*> nodes_of(const btDbvt& tree);

/// The datum of a leaf as a number below `leaves`; anything else is refused.
using LeafNumber = std::function<std::ptrdiff_t(const void* datum)>;
/// The datum with a number, and where it keeps the pointer to its leaf.
struct LeafPlace {
  void* datum = nullptr;
  btDbvtNode** leaf = nullptr;
};
using LeafPlaces = std::function<LeafPlace(std::size_t number)>;

/// Reads a tree. Refuses one whose leaves are not some of `leaves` data, each once. A complete one has none
/// or all.
Status capture(const btDbvt& tree, std::size_t leaves, const LeafNumber& number, TreeState& state,
               bool is_complete = true);
/// Writes or reads; when reading, refuses what is no such tree.
void visit(Archive& archive, TreeState& state, std::size_t leaves, bool is_complete = true);
/// Makes `tree` the saved one. Uses the nodes that it has, if their number is right.
void apply(const TreeState& state, btDbvt& tree, const LeafPlaces& place);

}  // namespace oilskin::bullet
