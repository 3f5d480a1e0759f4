#include "tree_state.h"

#include <algorithm>

#include "bullet_archive.h"

namespace oilskin::bullet {

std::vector<btDbvtNode*> nodes_of(const btDbvt& tree) {
  std::vector<btDbvtNode*> all, open;
  if (tree.m_root) open.push_back(tree.m_root);
  while (!open.empty()) {
    btDbvtNode* node = open.back();
    open.pop_back();
    all.push_back(node);
    if (node->isleaf()) continue;
    open.push_back(node->childs[1]);
    open.push_back(node->childs[0]);
  }
  return all;
}

namespace {

/// The inner nodes by address.
std::vector<btDbvtNode*> sorted_inner(const std::vector<btDbvtNode*>& nodes) {
  std::vector<btDbvtNode*> inner;
  for (btDbvtNode* node : nodes)
    if (node->isinternal()) inner.push_back(node);
  std::sort(inner.begin(), inner.end(), std::less<>());
  return inner;
}

/// Are these numbers below `limit`, each at most once?
bool are_distinct(const std::vector<std::size_t>& numbers, std::size_t limit) {
  std::vector<char> found(limit, 0);
  for (std::size_t number : numbers) {
    if (number >= found.size() || found[number]) return false;
    found[number] = 1;
  }
  return true;
}

bool is_tree(const TreeState& state, std::size_t leaves, bool is_complete) {
  if (state.nodes.empty()) return true;
  std::vector<std::size_t> data, ranks;
  std::size_t open = 1;  // subtrees that are to come
  for (const TreeState::Node& node : state.nodes) {
    if (open == 0) return false;
    const bool is_leaf = node.leaf >= 0;
    open = is_leaf ? open - 1 : open + 1;
    if (is_leaf)
      data.push_back(static_cast<std::size_t>(node.leaf));
    else
      ranks.push_back(node.rank);
  }
  return open == 0 && (!is_complete || data.size() == leaves) && are_distinct(data, leaves) &&
         are_distinct(ranks, ranks.size());
}

btDbvtNode* new_node() {
  return new (btAlignedAlloc(sizeof(btDbvtNode), 16)) btDbvtNode();  // as Bullet frees it
}

/// Inner nodes by address, and leaves, as many as the state needs.
struct Pool {
  std::vector<btDbvtNode*> inner, leaves;

  Pool(btDbvt& tree, std::size_t leaf_count) {
    const std::vector<btDbvtNode*> present = nodes_of(tree);
    inner = sorted_inner(present);
    for (btDbvtNode* node : present)
      if (node->isleaf()) leaves.push_back(node);
    if (leaves.size() == leaf_count) return;
    tree.clear();
    leaves.assign(leaf_count, nullptr);
    inner.assign(leaf_count > 0 ? leaf_count - 1 : 0, nullptr);
    for (btDbvtNode*& node : leaves) node = new_node();
    for (btDbvtNode*& node : inner) node = new_node();
    std::sort(inner.begin(), inner.end(), std::less<>());
  }
};

}  // namespace

Status capture(const btDbvt& tree, std::size_t leaves, const LeafNumber& number, TreeState& state,
               bool is_complete) {
  const std::vector<btDbvtNode*> nodes = nodes_of(tree), inner = sorted_inner(nodes);
  state.nodes.clear();
  for (const btDbvtNode* node : nodes) {
    TreeState::Node saved;
    saved.min = node->volume.Mins();
    saved.max = node->volume.Maxs();
    if (node->isleaf()) {
      const std::ptrdiff_t leaf = number(node->data);
      if (leaf < 0 || static_cast<std::size_t>(leaf) >= leaves)
        return Status::refused("a tree has a strange leaf");
      saved.leaf = static_cast<std::int32_t>(leaf);
    } else {
      const auto at = std::lower_bound(inner.begin(), inner.end(), node, std::less<>());
      saved.rank = static_cast<std::uint32_t>(at - inner.begin());
    }
    state.nodes.push_back(saved);
  }
  state.lookahead = tree.m_lkhd;
  state.path = tree.m_opath;
  return is_tree(state, leaves, is_complete) ? Status::accepted()
                                             : Status::refused("a tree does not have each leaf once");
}

void visit(Archive& archive, TreeState& state, std::size_t leaves, bool is_complete) {
  constexpr std::size_t min_bytes = 6 * sizeof(btScalar) + 8;
  archive.values(state.lookahead, state.path);
  archive.list(state.nodes, min_bytes, [&](TreeState::Node& node) {
    visit(archive, node.min);
    visit(archive, node.max);
    archive.values(node.leaf, node.rank);
  });
  archive.require(is_tree(state, leaves, is_complete), "a tree");
}

void apply(const TreeState& state, btDbvt& tree, const LeafPlaces& place) {
  const Pool pool(tree, state.nodes.empty() ? 0 : state.leaves());
  std::size_t next_leaf = 0;
  std::vector<btDbvtNode*> parents;  // with one child to come, or two
  tree.m_root = nullptr;
  for (const TreeState::Node& saved : state.nodes) {
    const bool is_leaf = saved.leaf >= 0;
    btDbvtNode* node = is_leaf ? pool.leaves[next_leaf++] : pool.inner[saved.rank];
    node->volume = btDbvtVolume::FromMM(saved.min, saved.max);
    node->childs[0] = node->childs[1] = nullptr;
    node->parent = parents.empty() ? nullptr : parents.back();
    if (!node->parent) {
      tree.m_root = node;
    } else if (!node->parent->childs[0]) {
      node->parent->childs[0] = node;
    } else {
      node->parent->childs[1] = node;
      parents.pop_back();
    }
    if (!is_leaf) {
      parents.push_back(node);
      continue;
    }
    const LeafPlace target = place(static_cast<std::size_t>(saved.leaf));
    node->data = target.datum;
    *target.leaf = node;
  }
  tree.m_leaves = static_cast<int>(pool.leaves.size());
  tree.m_lkhd = state.lookahead;
  tree.m_opath = state.path;
}

}  // namespace oilskin::bullet
