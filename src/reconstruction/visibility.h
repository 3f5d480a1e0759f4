/// Visibility of particles from the nodes of a block: a particle counts only if the segment between particle
/// and node touches no triangle ([Huber2013] section 4).
///
/// Most pairs are on the same side of every plane nearby. So each triangle of the block is a bit. A particle
/// has the bits of the planes in front of which, and behind which, it is; a row of nodes has the bits of the
/// planes for which this holds for all its nodes; a table by coordinate has the bits of the triangles that
/// may overlap a box. Triangles that remain for a pair are tested one by one, the last one that was hit
/// first.
#pragma once

#include "reconstruction/grid.h"
#include "reconstruction/obstacles.h"

namespace oilskin::reconstruction {

using Words = std::vector<std::uint64_t>;

/// Does the closed triangle touch the closed segment p–q, by segment_touches() of core? Triangles without
/// area hide nothing.
bool hides_segment(const Vec3& p, const Vec3& q, const Corners& c, const Triangle& indices);

class BlockVisibility {
 public:
  /// `triangles`: numbers in `obstacles`. Points of queries are relative to `origin` [cells] with coordinates
  /// from −margin to 8 + margin.
  void set(const Obstacles& obstacles, const std::vector<std::uint32_t>& triangles, const Vec3& origin,
           double cell, double margin);

  std::size_t words() const { return words_; }
  bool empty() const { return words_ == 0; }

  /// Bits of the planes in front of which, and behind which, the point is; words() words each.
  void sides(const std::array<float, 3>& point, Words& front, Words& back) const;
  /// The same for all nodes of row (j, k), for each row j + 8k.
  void row_sides(Words& front, Words& back) const;

  /// Bits of the triangles that may overlap [from, to] along an axis, to the resolution of slabs; words()
  /// words.
  void overlapping(std::size_t axis, float from, float to, std::uint64_t* out) const {
    const std::uint64_t *s = starts(axis, to), *e = ends(axis, from);
    for (std::size_t w = 0; w < words_; ++w) out[w] = s[w] & e[w];
  }
  /// Sets `open` to the triangles that may be between a point with sides a and one with sides b, both in the
  /// box. False if there are none.
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
  /// May a triangle overlap the box, to the resolution of slabs?
  bool may_overlap(const std::array<float, 3>& low, const std::array<float, 3>& high) const;

  /// Does one of the open triangles hide p from q? `last`: the last triangle that was hit, updated.
  bool hides(const std::array<float, 3>& p, const std::array<float, 3>& q, const std::uint64_t* open,
             std::uint32_t& last) const;

  /// Does triangle k hide p from q?
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
  /// Triangles that begin at or before this coordinate, to the resolution of slabs …
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
  // Planes with unit normals, padded with zeros to a multiple of 64
  std::vector<float> normal_x_, normal_y_, normal_z_, offset_;
  std::vector<FloatBox> boxes_;
  std::vector<Corners> corners_;  // relative to the origin [cells]
  std::vector<Triangle> indices_;
  Words starts_, ends_;
  std::size_t words_ = 0;
  int slabs_ = 0;
  float tolerance_ = 0, margin_ = 0;
};

/// Shadows of triangles as seen from one particle, for a row of nodes at a time (R.9). Floats decide except
/// close to one of the planes, where hides_segment() decides.
class Shadows {
 public:
  /// `visibility` must not change while it is used here.
  void set(const BlockVisibility& visibility, const std::array<float, 3>& particle);

  /// Which of the `queried` nodes of row (j, k) open triangles hide.
  std::uint32_t hidden(int j, int k, std::uint32_t queried, const std::uint64_t* open);

 private:
  struct Shadow {
    float normal[3][3];             // a×b, b×c, c×a
    float volume;                   // |a·(b×c)|
    float tolerance;                // of the tests
    std::uint32_t particle_number;  // for which it was computed
  };
  const Shadow& shadow(std::size_t triangle);

  const BlockVisibility* visibility_ = nullptr;
  std::array<float, 3> particle_{};
  std::uint32_t particle_number_ = 0;
  std::vector<Shadow> shadows_;
};

}  // namespace oilskin::reconstruction
