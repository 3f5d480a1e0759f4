/// What a node of a block can see: a particle counts only if the segment between the two touches no triangle
/// ([Huber2013] section 4).
///
/// Almost every pair lies on the same side of every triangle's plane nearby. So each triangle of the block is
/// a bit: a particle has the bits of the planes that it is in front of and behind, a row of nodes those that
/// all of its nodes are; a table by coordinate has the bits of the triangles that a box may meet. What
/// remains of a pair is looked at closely, the triangle that was hit last first.
#pragma once

#include "reconstruction/grid.h"
#include "reconstruction/obstacles.h"

namespace oilskin::reconstruction {

using Words = std::vector<std::uint64_t>;

/// Does the closed segment p q touch the closed triangle? Watertight over shared edges: an edge's side of the
/// segment is computed from its node of lower index, whatever triangle asks, and what passes an edge within
/// rounding touches it. Triangles without area hide nothing.
bool segment_touches(const Vec3& p, const Vec3& q, const Corners& c, const Triangle& indices);

class BlockSight {
 public:
  /// `triangles` of the obstacles. Points will be relative to `origin`, in cells, their coordinates from
  /// −margin to 8 + margin.
  void set(const Obstacles& obstacles, const std::vector<std::uint32_t>& triangles, const Vec3& origin,
           double cell, double margin);

  std::size_t words() const { return words_; }
  bool empty() const { return words_ == 0; }

  /// The planes that the point is in front of and behind, `words()` words each.
  void sides(const std::array<float, 3>& point, Words& front, Words& back) const;
  /// The planes that all nodes of row (j, k) are in front of and behind, for all rows j + 8k.
  void row_sides(Words& front, Words& back) const;

  /// Of `words()` words: triangles that overlap [from, to] along an axis, as far as slabs tell.
  void overlapping(std::size_t axis, float from, float to, std::uint64_t* out) const {
    const std::uint64_t *s = starts(axis, to), *e = ends(axis, from);
    for (std::size_t w = 0; w < words_; ++w) out[w] = s[w] & e[w];
  }
  /// Leaves in `open` the triangles that may come between a point with sides a and one with sides b, both in
  /// the box; false if there is none.
  bool may_hide(const std::uint64_t* front_a, const std::uint64_t* back_a, const std::uint64_t* front_b,
                const std::uint64_t* back_b, const std::array<float, 3>& low,
                const std::array<float, 3>& high, std::uint64_t* open) const {
    const std::uint64_t *x0 = starts(0, high[0]), *x1 = ends(0, low[0]), *y0 = starts(1, high[1]),
                        *y1 = ends(1, low[1]), *z0 = starts(2, high[2]), *z1 = ends(2, low[2]);
    std::uint64_t any = 0;
    for (std::size_t w = 0; w < words_; ++w) {
      const std::uint64_t one_side = (front_a[w] & front_b[w]) | (back_a[w] & back_b[w]);
      any |= open[w] = ~one_side & x0[w] & x1[w] & y0[w] & y1[w] & z0[w] & z1[w];
    }
    return any != 0;
  }
  /// May any triangle meet the box, as far as slabs tell?
  bool may_meet(const std::array<float, 3>& low, const std::array<float, 3>& high) const;

  /// Does one of the open triangles hide p from q? `last`: the one that was hit last, updated.
  bool hides(const std::array<float, 3>& p, const std::array<float, 3>& q, const std::uint64_t* open,
             std::uint32_t& last) const;

  /// Does this one triangle?
  bool touches(std::size_t k, const std::array<float, 3>& p, const std::array<float, 3>& q) const;

  std::size_t size() const { return corners_.size(); }
  const Corners& corners(std::size_t k) const { return corners_[k]; }

 private:
  void fill_slabs();
  /// The slab of a coordinate: [−margin + i, −margin + i + 1].
  std::size_t slab(float x) const {
    const int i = static_cast<int>(x + margin_);
    return static_cast<std::size_t>(i < 0 ? 0 : (i < slabs_ ? i : slabs_ - 1));
  }
  /// Triangles that begin at or before this coordinate, as far as slabs tell …
  const std::uint64_t* starts(std::size_t axis, float x) const {
    return &starts_[(axis * std::size_t(slabs_) + slab(x)) * words_];
  }
  /// … and that end at or beyond it.
  const std::uint64_t* ends(std::size_t axis, float x) const {
    return &ends_[(axis * std::size_t(slabs_) + slab(x)) * words_];
  }

  struct FloatBox {
    float low[3], high[3];
  };
  /// Planes with unit normals; zeros beyond the last triangle, up to a whole number of words.
  std::vector<float> normal_x_, normal_y_, normal_z_, offset_;
  std::vector<FloatBox> boxes_;
  std::vector<Corners> corners_;  ///< relative to the origin [cells]
  std::vector<Triangle> indices_;
  Words starts_, ends_;
  std::size_t words_ = 0;
  int slabs_ = 0;
  float tolerance_ = 0, margin_ = 0;
};

/// What lies in the shadow of triangles, as seen from one particle, a row of nodes at a time.
///
/// With the corners a, b, c seen from the particle, the plane through it and an edge has the normal a×b, b×c
/// or c×a. A point d behind all three, on the triangle's side, is in the shadow if it is beyond the triangle:
/// (a×b + b×c + c×a)·d ≥ a·(b×c) (R.9). Floats tell this but for what is near one of the planes; that is left
/// to segment_touches().
class Shadows {
 public:
  /// The sight must stay as it is while it is used here.
  void set(const BlockSight& sight, const std::array<float, 3>& particle);

  /// Of the nodes `wanted` of row (j, k), those that open triangles hide.
  std::uint32_t hidden(int j, int k, std::uint32_t wanted, const std::uint64_t* open);

 private:
  struct Shadow {
    float normal[3][3];
    float beyond, tolerance;
    std::uint32_t made_for;  ///< number of the particle
  };
  const Shadow& shadow(std::size_t triangle);

  const BlockSight* sight_ = nullptr;
  std::array<float, 3> particle_{};
  std::uint32_t number_ = 0;
  std::vector<Shadow> shadows_;
};

}  // namespace oilskin::reconstruction
