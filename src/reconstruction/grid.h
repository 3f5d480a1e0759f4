/// The sparse grid: blocks of 8³ nodes at world multiples of the cell. Only blocks that the surface may pass
/// have values; all nodes of other blocks are inside, or all are outside.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/assert.h"
#include "oilskin/types.h"

namespace oilskin::reconstruction {

constexpr int side = 8;                      ///< nodes along an edge of a block
constexpr int nodes = side * side * side;    ///< nodes of a block
constexpr std::uint32_t none = 0xffffffffu;  ///< no number
/// x of the nodes of a row [cells].
constexpr float row_nodes[side] = {0, 1, 2, 3, 4, 5, 6, 7};

/// A position in floats, in doubles.
inline Vec3 vec(const std::array<float, 3>& p) {
  return {p[0], p[1], p[2]};
}

struct Int3 {
  int x = 0, y = 0, z = 0;
  bool operator==(const Int3& o) const { return x == o.x && y == o.y && z == o.z; }
  Int3 operator+(const Int3& o) const { return {x + o.x, y + o.y, z + o.z}; }
  Int3 operator-(const Int3& o) const { return {x - o.x, y - o.y, z - o.z}; }
};

/// The block of x [cells, from the world's origin].
inline Int3 block_at(const Vec3& x) {
  const auto block = [](double v) { return static_cast<int>(std::floor(v)) >> 3; };
  return {block(x.x()), block(x.y()), block(x.z())};
}

/// 21 bits per coordinate, z first, so that sorted keys run along x.
inline std::uint64_t key_of(const Int3& b) {
  const auto part = [](int v) { return static_cast<std::uint64_t>(v + (1 << 20)) & 0x1fffff; };
  return part(b.z) << 42 | part(b.y) << 21 | part(b.x);
}

inline Int3 block_of_key(std::uint64_t key) {
  const auto part = [](std::uint64_t v) { return static_cast<int>(v & 0x1fffff) - (1 << 20); };
  return {part(key), part(key >> 21), part(key >> 42)};
}

inline int node_index(int i, int j, int k) {
  return i + side * (j + side * k);
}

/// Maps keys to numbers, by open addressing.
class KeyMap {
 public:
  explicit KeyMap(std::size_t expected = 0) { resize(expected); }

  std::uint32_t find(std::uint64_t key) const {
    for (std::size_t i = slot(key);; i = (i + 1) & mask_) {
      if (values_[i] == none) return none;
      if (keys_[i] == key) return values_[i];
    }
  }
  /// The value of the key; a new key gets `value`.
  std::uint32_t insert(std::uint64_t key, std::uint32_t value) {
    OILSKIN_ASSERT(value != none);
    if (2 * (size_ + 1) > keys_.size()) resize(2 * size_ + 8);
    std::size_t i = slot(key);
    for (; values_[i] != none; i = (i + 1) & mask_)
      if (keys_[i] == key) return values_[i];
    keys_[i] = key;
    values_[i] = value;
    ++size_;
    return value;
  }
  std::size_t size() const { return size_; }
  /// Empty, with space for `expected` keys. Keeps its memory.
  void reset(std::size_t expected) {
    std::size_t slots = 16;
    while (slots < 4 * expected) slots *= 2;
    keys_.resize(slots);
    values_.assign(slots, none);
    mask_ = slots - 1;
    size_ = 0;
  }
  std::size_t bytes() const { return keys_.capacity() * 8 + values_.capacity() * 4; }

 private:
  std::size_t slot(std::uint64_t key) const {
    key *= 0x9e3779b97f4a7c15ull;
    return static_cast<std::size_t>(key ^ key >> 32) & mask_;
  }
  void resize(std::size_t expected) {
    std::size_t slots = 16;
    while (slots < 4 * expected) slots *= 2;
    std::vector<std::uint64_t> old_keys(slots);
    std::vector<std::uint32_t> old_values(slots, none);
    old_keys.swap(keys_);
    old_values.swap(values_);
    mask_ = slots - 1;
    size_ = 0;
    for (std::size_t i = 0; i < old_keys.size(); ++i)
      if (old_values[i] != none) insert(old_keys[i], old_values[i]);
  }

  std::vector<std::uint64_t> keys_;
  std::vector<std::uint32_t> values_;
  std::size_t mask_ = 0, size_ = 0;
};

/// Crossings of a grid edge by obstacles: those nearest to its low and to its high end, as fractions of the
/// edge.
struct CutEdge {
  std::uint16_t edge = 0;  ///< axis · 512 + node of the low end
  float first = 0, last = 0;
};

/// Obstacles near a block.
struct NearBlock {
  std::vector<std::uint32_t> triangles;  ///< those within reach of the block, ascending
  std::vector<float> distance;     ///< per node [cells], infinite beyond the band; empty: infinite everywhere
  std::vector<float> wetness;      ///< per node: 1 at a wet obstacle, 0 at a dry one; empty: 0 everywhere
  std::vector<CutEdge> cut_edges;  ///< ascending
  std::array<std::array<std::uint64_t, side>, 3>
      cut{};                 ///< per axis and slice, a bit per node: its edge is cut
  bool is_measured = false;  ///< distance, wetness and cuts are known

  void forget_measures() {
    if (!is_measured) return;
    distance.clear();
    wetness.clear();
    cut_edges.clear();
    cut = {};
    is_measured = false;
  }
  std::size_t bytes() const {
    return sizeof(NearBlock) + 4 * (triangles.capacity() + distance.capacity() + wetness.capacity()) +
           sizeof(CutEdge) * cut_edges.capacity();
  }
  const CutEdge* find_cut(int axis, int node) const;
};

struct Block {
  Int3 at;
  std::uint32_t field = none;  ///< number of its 512 values; none: all nodes are inside or all are outside
  std::uint32_t near = none;   ///< number of its NearBlock; none: no obstacle within reach
  bool solid = false;          ///< without values: all nodes are inside
  /// Neighbours towards +x (bit 0), +y (bit 1), +z (bit 2); [0] is the block itself. None: outside.
  std::array<std::uint32_t, 8> plus{};
};

struct NodeRef {
  std::uint32_t block = none;
  int node = 0;
};

class Grid {
 public:
  double cell = 0;            ///< [m]
  float clearance = 0;        ///< d*: aimed distance of the mesh from obstacles [cells]
  float outside = 0;          ///< value of nodes that no particle reaches [cells]
  float inside = 0;           ///< value of nodes of solid blocks [cells]
  std::optional<Box> clip;    ///< no vertex leaves it
  std::vector<Block> blocks;  ///< ascending by key
  KeyMap index;
  std::vector<float> values;                                 ///< 512 per field [cells]; < 0 is inside
  std::vector<std::array<std::uint64_t, side>> inside_bits;  ///< per field, a word per slice
  std::vector<NearBlock> nears;

  Vec3 origin(const Block& b) const {
    return Vec3(double(b.at.x) * side * cell, double(b.at.y) * side * cell, double(b.at.z) * side * cell);
  }
  /// The place of a node [m].
  Vec3 place(NodeRef n) const {
    return origin(blocks[n.block]) + cell * Vec3(n.node & 7, n.node >> 3 & 7, n.node >> 6);
  }
  /// The node with these coordinates; block none outside the grid.
  NodeRef node_at(const Int3& at) const {
    return {index.find(key_of({at.x >> 3, at.y >> 3, at.z >> 3})), node_index(at.x & 7, at.y & 7, at.z & 7)};
  }
  /// For i, j, k in 0 … 8.
  NodeRef node(std::uint32_t block, int i, int j, int k) const {
    const std::uint32_t b = blocks[block].plus[static_cast<std::size_t>(i >> 3 | j >> 3 << 1 | k >> 3 << 2)];
    return {b, node_index(i & 7, j & 7, k & 7)};
  }
  float value(NodeRef n) const {
    if (n.block == none) return outside;
    const Block& b = blocks[n.block];
    if (b.field == none) return b.solid ? inside : outside;
    return values[std::size_t(b.field) * nodes + std::size_t(n.node)];
  }
  bool is_inside(NodeRef n) const {
    if (n.block == none) return false;
    const Block& b = blocks[n.block];
    if (b.field == none) return b.solid;
    return inside_bits[b.field][std::size_t(n.node >> 6)] >> (n.node & 63) & 1;
  }
  /// Infinite if no obstacle is within the band.
  float distance(NodeRef n) const {
    if (n.block == none || blocks[n.block].near == none) return std::numeric_limits<float>::infinity();
    const NearBlock& near = nears[blocks[n.block].near];
    return near.distance.empty() ? std::numeric_limits<float>::infinity()
                                 : near.distance[std::size_t(n.node)];
  }
  /// Sets the bits of a field by its values.
  void find_inside(std::uint32_t field) {
    for (std::size_t k = 0; k < side; ++k) {
      const float* const slice = &values[std::size_t(field) * nodes + 64 * k];
      std::uint64_t bits = 0;
      for (int n = 0; n < 64; ++n) bits |= std::uint64_t(slice[n] < 0) << n;
      inside_bits[field][k] = bits;
    }
  }
  void set_outside(NodeRef n, float value) {
    const Block& b = blocks[n.block];
    OILSKIN_ASSERT(b.field != none && value > 0);
    values[std::size_t(b.field) * nodes + std::size_t(n.node)] = value;
    inside_bits[b.field][std::size_t(n.node >> 6)] &= ~(1ull << (n.node & 63));
  }
  void set_inside(NodeRef n) {
    const Block& b = blocks[n.block];
    OILSKIN_ASSERT(b.field != none && inside < 0);
    values[std::size_t(b.field) * nodes + std::size_t(n.node)] = inside;
    inside_bits[b.field][std::size_t(n.node >> 6)] |= 1ull << (n.node & 63);
  }
  std::uint64_t slice(std::uint32_t block, int k) const {
    if (block == none) return 0;
    const Block& b = blocks[block];
    return b.field != none ? inside_bits[b.field][std::size_t(k)] : (b.solid ? ~0ull : 0ull);
  }
};

/// The point of the box that is nearest to x; x without a box.
inline Vec3 clamped_to(const std::optional<Box>& clip, const Vec3& x) {
  return clip ? Vec3(x.cwiseMax(clip->min).cwiseMin(clip->max)) : x;
}

/// A bit per node or edge of a block's 9³ nodes: bit i of row [j + 9k].
using Rows = std::array<std::uint16_t, 81>;

/// `slice(block, k)`: the 64 bits of a slice; block may be `none`.
template <class Slice>
Rows gather_rows(const Block& b, const Slice& slice) {
  Rows rows;
  for (int k = 0; k <= side; ++k)
    for (int up = 0; up < 2; ++up) {
      const std::size_t octant = std::size_t(up << 1 | k >> 3 << 2);
      const std::uint64_t low = slice(b.plus[octant], k & 7), high = slice(b.plus[octant | 1], k & 7);
      for (int j = up * side; j < (up ? side + 1 : side); ++j) {
        const int shift = side * (j & 7);
        rows[std::size_t(j + 9 * k)] =
            static_cast<std::uint16_t>((low >> shift & 0xff) | (high >> shift & 1) << side);
      }
    }
  return rows;
}

inline const CutEdge* NearBlock::find_cut(int axis, int node) const {
  if (!(cut[std::size_t(axis)][std::size_t(node >> 6)] >> (node & 63) & 1)) return nullptr;
  const int edge = axis * nodes + node;
  std::size_t low = 0, high = cut_edges.size();
  while (low < high) {
    const std::size_t middle = (low + high) / 2;
    (cut_edges[middle].edge < edge ? low : high) = cut_edges[middle].edge < edge ? middle + 1 : middle;
  }
  OILSKIN_ASSERT(low < cut_edges.size() && cut_edges[low].edge == edge);
  return &cut_edges[low];
}

}  // namespace oilskin::reconstruction
