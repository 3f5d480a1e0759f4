/// Points in cells, to find those near to a place.
#pragma once

#include <array>
#include <cmath>
#include <unordered_map>
#include <vector>

#include "core/hash.h"
#include "oilskin/types.h"

namespace oilskin::world {

/// Points with their numbers. A search visits 27 cells.
class PointCells {
 public:
  /// Searches reach `distance` > 0 [m].
  explicit PointCells(double distance) : distance_(distance) {}

  void add(std::size_t number, const Vec3& x) { cells_[cell_of(x)].push_back({number, x}); }

  /// f(number) for each point nearer than the distance. The order depends on that of add() alone.
  template <class F>
  void for_near(const Vec3& x, const F& f) const {
    if (cells_.empty()) return;
    const Cell middle = cell_of(x);
    for (int k = 0; k < 27; ++k) {
      const int x_step = k % 3 - 1, y_step = k / 3 % 3 - 1, z_step = k / 9 - 1;
      const auto found = cells_.find({middle[0] + x_step, middle[1] + y_step, middle[2] + z_step});
      if (found == cells_.end()) continue;
      for (const Entry& e : found->second)
        if ((e.x - x).squaredNorm() < distance_ * distance_) f(e.number);
    }
  }

  bool has_near(const Vec3& x) const {
    bool found = false;
    for_near(x, [&](std::size_t) { found = true; });
    return found;
  }

 private:
  struct Entry {
    std::size_t number;
    Vec3 x;
  };
  using Cell = std::array<double, 3>;  // integers, at any distance from the origin
  struct HashOfCell {
    std::size_t operator()(const Cell& c) const {
      Hash64 hash;
      for (const double x : c) hash.add(x + 0.0);  // −0 is 0
      return hash.value();
    }
  };
  Cell cell_of(const Vec3& x) const {
    return {std::floor(x[0] / distance_), std::floor(x[1] / distance_), std::floor(x[2] / distance_)};
  }

  double distance_;
  std::unordered_map<Cell, std::vector<Entry>, HashOfCell> cells_;
};

}  // namespace oilskin::world
