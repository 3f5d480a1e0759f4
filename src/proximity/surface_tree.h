/// Broad phase: finds the triangles of a moving surface whose boxes overlap boxes of particles. FCL finds
/// candidates; it makes no decision about contact.
#pragma once

#include <memory>

#include "core/parallel.h"
#include "oilskin/settings.h"

namespace oilskin::proximity {

/// Candidate triangles per box: those of box i are triangle[begin[i]] … triangle[begin[i + 1] − 1],
/// ascending.
struct Candidates {
  std::vector<std::uint32_t> begin;  ///< n + 1
  std::vector<std::uint32_t> triangle;

  Span<const std::uint32_t> of(std::size_t i) const {
    return {triangle.data() + begin[i], begin[i + 1] - begin[i]};
  }
};

/// The box of a triangle of these nodes at both ends of an interval, without rounding.
inline Box swept_box(const Triangle& nodes, Span<const Vec3> x_t0, Span<const Vec3> x_t1) {
  Box box;
  for (const std::uint32_t node : nodes) {
    box.add(x_t0[node]);
    box.add(x_t1[node]);
  }
  return box;
}

/// A bounding-volume tree over the swept boxes of a surface's triangles: FCL's BVHModel<AABB<double>> builds
/// it. Refits and queries go through FCL's nodes or a flat copy of them, with the same results.
class SurfaceTree {
 public:
  SurfaceTree();
  ~SurfaceTree();
  SurfaceTree(SurfaceTree&&) noexcept;
  SurfaceTree& operator=(SurfaceTree&&) noexcept;

  /// Fits each leaf to x_t0 ∪ x_t1 of its triangle exactly (no inflation, no rounding). Builds a new tree if
  /// the triangles differ from those of the last call, or if the leaves or the nodes have grown to more than
  /// twice their size after the last build; otherwise refits. Query results are the same for both. Positions
  /// must be finite and indices in range (asserted). Throws std::runtime_error if FCL fails (out of memory);
  /// after any exception the tree has no triangles, and the next call builds it.
  void update(Span<const Triangle> triangles, Span<const Vec3> x_t0, Span<const Vec3> x_t1,
              const Workers& workers, Hierarchy hierarchy = Hierarchy::flat);

  std::size_t builds() const;  ///< number of builds, for tests and reports
  Box bounds() const;          ///< of all triangles; empty without triangles
  const Box& swept_box(std::uint32_t triangle) const;

  /// Appends all triangles whose swept box overlaps the closed `box`, in ascending order. Thread-safe.
  void query(const Box& box, std::vector<std::uint32_t>& triangles) const;

  /// Whether some triangle's swept box overlaps the closed `box`. Thread-safe.
  bool overlaps(const Box& box) const;

  /// For each of n boxes, exactly the triangles whose swept boxes overlap it. A block of consecutive boxes
  /// shares a traversal, so the order of boxes should be spatially coherent. An empty box (min > max) has no
  /// candidates.
  void query(Span<const Box> boxes, const Workers& workers, Candidates& candidates) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace oilskin::proximity
