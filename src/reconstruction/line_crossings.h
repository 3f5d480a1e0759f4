/// How many parts of a closed mesh a point lies in.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "oilskin/types.h"

namespace oilskin::reconstruction {

/// Counts how often lines along an axis pass through triangles (R.20). Triangles that follow each other in
/// the mesh lie near each other, so a box for some of them excludes most.
class LineCrossings {
 public:
  /// Of no triangles yet. The mesh must outlive it.
  LineCrossings(const std::vector<std::array<float, 3>>& positions, const std::vector<Triangle>& triangles,
                int axis = 2);

  void add(std::uint32_t triangle);
  void add_all();
  /// How many triangles whose normals point along the axis lie beyond x on it, less those with opposite
  /// normals: for a closed mesh its winding number around x.
  int beyond(const Vec3& x) const;

 private:
  using Point = std::array<double, 3>;  // along the axis in the end

  static constexpr std::size_t group = 64;
  struct Group {
    static constexpr float infinity = std::numeric_limits<float>::infinity();
    std::array<float, 2> low = {infinity, infinity}, high = {-infinity, -infinity};
    float top = -infinity;

    bool may_be_beyond(const Point& x) const {
      return x[2] <= double(top) && x[0] >= double(low[0]) && x[0] <= double(high[0]) &&
             x[1] >= double(low[1]) && x[1] <= double(high[1]);
    }
  };

  bool is_left_of(std::uint32_t from, std::uint32_t to, const Point& x, double& area) const;
  int beyond(const Point& x, const Triangle& t) const;

  const std::vector<std::array<float, 3>>& positions_;
  const std::vector<Triangle>& triangles_;
  std::array<std::size_t, 3> axes_;  // that of the lines is the last
  std::vector<std::uint32_t> numbers_;
  std::vector<Group> groups_;
};

}  // namespace oilskin::reconstruction
