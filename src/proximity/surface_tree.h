/// Which triangles of a moving surface may a moving particle meet? FCL finds candidates; it decides nothing.
#pragma once

#include <memory>

#include "core/parallel.h"
#include "oilskin/types.h"

namespace oilskin::proximity {

/// Candidate triangles per particle, in compressed rows: those of particle i are
/// triangle[begin[i]] … triangle[begin[i + 1] − 1], ascending.
struct Candidates {
  std::vector<std::uint32_t> begin;  ///< n + 1
  std::vector<std::uint32_t> triangle;

  Span<const std::uint32_t> of(std::size_t i) const {
    return {triangle.data() + begin[i], begin[i + 1] - begin[i]};
  }
};

/// A bounding-volume tree over the swept boxes of a surface's triangles: FCL's BVHModel<AABB<double>>.
class SurfaceTree {
 public:
  SurfaceTree();
  ~SurfaceTree();
  SurfaceTree(SurfaceTree&&) noexcept;
  SurfaceTree& operator=(SurfaceTree&&) noexcept;

  /// Fits every leaf to x_t0 ∪ x_t1 of its triangle exactly (no inflation, no rounding). Builds a new tree
  /// when the triangles are not those of the last call, or when the leaves or the whole tree have grown to
  /// more than twice their size after the last build; else refits. What queries find does not depend on which
  /// of the two it was. Finite positions, indices in range (asserted). Throws std::runtime_error where FCL
  /// refuses (out of memory); after any exception the tree has no triangles, and the next call builds it.
  void update(Span<const Triangle> triangles, Span<const Vec3> x_t0, Span<const Vec3> x_t1);

  std::size_t builds() const;  ///< how often a tree was built, for tests and reports
  Box bounds() const;          ///< of everything, empty for no triangles

  /// All triangles whose swept box overlaps `box` (closed), appended in ascending order. Safe from several
  /// threads.
  void query(const Box& box, std::vector<std::uint32_t>& triangles) const;

  /// For each of n boxes, exactly the triangles whose swept boxes overlap it. One traversal serves a block of
  /// consecutive boxes, so boxes should be in a spatially coherent order. An empty box (min > max) has none.
  void query(Span<const Box> boxes, const Workers& workers, Candidates& candidates) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace oilskin::proximity
