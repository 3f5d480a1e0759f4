/// The nearest of a set of triangles within a given reach.
#pragma once

#include <unordered_map>

#include "core/closest_point.h"
#include "oilskin/surface_motion.h"

namespace oilskin::demo {

class NearestSurface {
 public:
  struct Hit {
    int surface = -1;
    Triangle nodes{};
    ClosestPoint point;
  };

  /// Finds triangles within `reach` [m] > 0 of a point.
  explicit NearestSurface(double reach) : reach_(reach), cell_(std::max(2 * reach, 1e-9)) {}

  /// Positions are taken from x_t1 and must stay where they are.
  void add(const SurfaceMotion& motion, int surface);
  /// False when nothing is within reach.
  bool find(const Vec3& p, Hit* hit) const;

  /// Does an ellipsoid about p, half axis `along` on the unit vector n and `across` at right angles to it,
  /// keep clear of every triangle? Neither half axis may exceed the reach.
  bool is_clear(const Vec3& p, const Vec3& n, double along, double across) const;

 private:
  struct Entry {
    const SurfaceMotion* motion;
    std::uint32_t triangle;
    int surface;
  };
  using Cell = std::array<std::int64_t, 3>;
  struct CellHash {
    std::size_t operator()(const Cell& c) const {
      return static_cast<std::size_t>(c[0] * 73856093 ^ c[1] * 19349663 ^ c[2] * 83492791);
    }
  };

  Cell cell_of(const Vec3& p) const;
  void improve(const Entry& entry, const Vec3& p, Hit* hit) const;

  double reach_, cell_;
  std::unordered_map<Cell, std::vector<Entry>, CellHash> cells_;
  std::vector<Entry> large_;  ///< triangles over too many cells to list: always looked at
};

}  // namespace oilskin::demo
