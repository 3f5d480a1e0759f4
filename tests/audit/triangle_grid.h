/// A uniform grid over boxes, to find those that overlap another box.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "audit/motion_trace.h"

namespace oilskin::audit {

struct Bounds {
  Point low, high;

  bool overlaps(const Bounds& other) const {
    for (int k = 0; k < 3; ++k) {
      if (low[k] > other.high[k] || other.low[k] > high[k]) return false;
    }
    return true;
  }
};

/// The box of two points.
Bounds bounds_of(const Point& a, const Point& b);
/// Makes `bounds` hold the point too.
void extend(Bounds* bounds, const Point& p);

class TriangleGrid {
 public:
  /// The boxes must outlive the grid and be finite.
  explicit TriangleGrid(const std::vector<Bounds>& boxes);

  /// Calls visit(index) once for each box that overlaps `query`, in ascending order of cells.
  template <class Visit>
  void for_each_overlap(const Bounds& query, Visit visit) {
    if (boxes_.empty() || !query.overlaps(whole_)) return;
    ++stamp_;
    const std::array<int, 3> low = cell_of(query.low), high = cell_of(query.high);
    for (int z = low[2]; z <= high[2]; ++z) {
      for (int y = low[1]; y <= high[1]; ++y) {
        for (int x = low[0]; x <= high[0]; ++x) {
          const std::size_t cell = index_of(x, y, z);
          for (std::uint32_t i = first_[cell]; i < first_[cell + 1]; ++i) {
            const std::uint32_t box = entries_[i];
            if (seen_[box] == stamp_) continue;
            seen_[box] = stamp_;
            if (boxes_[box].overlaps(query)) visit(box);
          }
        }
      }
    }
  }

 private:
  void choose_cells();
  std::array<int, 3> cell_of(const Point& p) const;
  std::size_t index_of(int x, int y, int z) const {
    return (static_cast<std::size_t>(z) * cells_[1] + y) * cells_[0] + x;
  }
  template <class Visit>
  void for_each_cell(const Bounds& box, Visit visit) const {
    const std::array<int, 3> low = cell_of(box.low), high = cell_of(box.high);
    for (int z = low[2]; z <= high[2]; ++z) {
      for (int y = low[1]; y <= high[1]; ++y) {
        for (int x = low[0]; x <= high[0]; ++x) visit(index_of(x, y, z));
      }
    }
  }

  const std::vector<Bounds>& boxes_;
  Bounds whole_{};
  std::array<int, 3> cells_{1, 1, 1};
  Point per_metre_{};                 // cells per unit of length
  std::vector<std::uint32_t> first_;  // of each cell, in entries_
  std::vector<std::uint32_t> entries_;
  std::vector<std::uint64_t> seen_;
  std::uint64_t stamp_ = 0;
};

}  // namespace oilskin::audit
