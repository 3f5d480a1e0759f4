#include "study/comparators/neighbour_lists.h"

#include <algorithm>
#include <cmath>

namespace oilskin::study {
namespace {

constexpr int bits = 21;  // of a coordinate in a key
using Cell = std::array<std::int64_t, 3>;

Cell cell_of(const Vec3& x, double radius) {
  Cell cell;
  for (int k = 0; k < 3; ++k) {
    // Farther cells fall together with the outermost: that costs time, and loses no pair.
    constexpr double outermost = (1 << (bits - 1)) - 2;
    cell[static_cast<std::size_t>(k)] =
        static_cast<std::int64_t>(std::clamp(std::floor(x[k] / radius), -outermost, outermost));
  }
  return cell;
}

/// x lowest, so that the three cells of a row around a cell follow each other.
std::uint64_t key_of(const Cell& cell) {
  std::uint64_t key = 0;
  for (int k = 2; k >= 0; --k)
    key = key << bits |
          static_cast<std::uint64_t>(cell[static_cast<std::size_t>(k)] + (std::int64_t{1} << (bits - 1)));
  return key;
}

}  // namespace

void NeighbourLists::search(Span<const Vec3> queries, Span<const Vec3> points, double radius, bool same) {
  entries_.clear();
  for (std::size_t i = 0; i < points.size(); ++i)
    entries_.push_back({key_of(cell_of(points[i], radius)), static_cast<std::uint32_t>(i)});
  std::sort(entries_.begin(), entries_.end(), [](const Entry& a, const Entry& b) {
    return a.cell != b.cell ? a.cell < b.cell : a.point < b.point;
  });
  sorted_.clear();
  for (const Entry& e : entries_) sorted_.push_back(points[e.point]);
  list_.clear();
  begin_.assign(1, 0);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const Cell cell = cell_of(queries[i], radius);
    for (std::int64_t row = 0; row < 9; ++row) {
      const Cell from = {cell[0] - 1, cell[1] + row % 3 - 1, cell[2] + row / 3 - 1};
      const std::uint64_t low = key_of(from), high = low + 2;
      auto e = std::lower_bound(entries_.begin(), entries_.end(), low,
                                [](const Entry& entry, std::uint64_t key) { return entry.cell < key; });
      for (; e != entries_.end() && e->cell <= high; ++e) {
        const Vec3& x = sorted_[static_cast<std::size_t>(e - entries_.begin())];
        if ((x - queries[i]).squaredNorm() < radius * radius && !(same && e->point == i))
          list_.push_back(e->point);
      }
    }
    begin_.push_back(list_.size());
  }
}

double lattice_sum(double (*kernel)(double, double), double spacing, double h) {
  const int n = static_cast<int>(std::ceil(h / spacing));
  double sum = 0;
  for (int a = -n; a <= n; ++a)
    for (int b = -n; b <= n; ++b)
      for (int c = -n; c <= n; ++c) sum += kernel(spacing * std::sqrt(double(a * a + b * b + c * c)), h);
  return sum;
}

}  // namespace oilskin::study
