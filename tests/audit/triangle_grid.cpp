#include "audit/triangle_grid.h"

#include <algorithm>
#include <cmath>

namespace oilskin::audit {

Bounds bounds_of(const Point& a, const Point& b) {
  Bounds bounds{a, a};
  extend(&bounds, b);
  return bounds;
}

void extend(Bounds* bounds, const Point& p) {
  for (int k = 0; k < 3; ++k) {
    bounds->low[k] = std::min(bounds->low[k], p[k]);
    bounds->high[k] = std::max(bounds->high[k], p[k]);
  }
}

TriangleGrid::TriangleGrid(const std::vector<Bounds>& boxes) : boxes_(boxes), seen_(boxes.size(), 0) {
  if (boxes.empty()) return;
  whole_ = boxes[0];
  for (const Bounds& box : boxes) {
    extend(&whole_, box.low);
    extend(&whole_, box.high);
  }
  choose_cells();
  const std::size_t count = static_cast<std::size_t>(cells_[0]) * cells_[1] * cells_[2];
  first_.assign(count + 1, 0);
  for (const Bounds& box : boxes) for_each_cell(box, [&](std::size_t cell) { ++first_[cell + 1]; });
  for (std::size_t i = 0; i < count; ++i) first_[i + 1] += first_[i];
  entries_.resize(first_[count]);
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (std::uint32_t i = 0; i < boxes.size(); ++i) {
    for_each_cell(boxes[i], [&](std::size_t cell) { entries_[next[cell]++] = i; });
  }
}

/// Cells about as large as the mean box, but not many more than boxes.
void TriangleGrid::choose_cells() {
  constexpr int kMostPerAxis = 100;
  double mean = 0;
  for (const Bounds& box : boxes_) {
    mean += std::max({box.high[0] - box.low[0], box.high[1] - box.low[1], box.high[2] - box.low[2]});
  }
  mean /= static_cast<double>(boxes_.size());
  for (int k = 0; k < 3; ++k) {
    const double extent = whole_.high[k] - whole_.low[k];
    const double wanted = mean > 0 ? extent / mean : 1;
    cells_[k] = static_cast<int>(std::clamp(std::ceil(wanted), 1.0, static_cast<double>(kMostPerAxis)));
    per_metre_[k] = extent > 0 ? cells_[k] / extent : 0;
  }
}

/// Monotone in every component, so the cells between those of a box's corners hold every point of it:
/// rounding may move a border between cells but no box out of the cells that it overlaps.
std::array<int, 3> TriangleGrid::cell_of(const Point& p) const {
  std::array<int, 3> cell{};
  for (int k = 0; k < 3; ++k) {
    const double position = std::floor((p[k] - whole_.low[k]) * per_metre_[k]);
    cell[k] = static_cast<int>(std::clamp(position, 0.0, static_cast<double>(cells_[k] - 1)));
  }
  return cell;
}

}  // namespace oilskin::audit
