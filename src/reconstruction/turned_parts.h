/// Connected parts of a mesh that are inside out.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/parallel.h"
#include "oilskin/types.h"
#include "reconstruction/line_crossings.h"

namespace oilskin::reconstruction {

/// What the parts of a mesh enclose: at the first vertex of each part its signed volume, elsewhere 0.
/// `of_vertex`: the first vertex of the part of each vertex.
std::vector<double> part_volumes(const std::vector<std::array<float, 3>>& positions,
                                 const std::vector<Triangle>& triangles,
                                 const std::vector<std::uint32_t>& of_vertex, const Workers& workers);

/// Finds the parts whose volume is negative although most of their surface lies in no part with a positive
/// one: they are no bubbles in water.
class TurnedParts {
 public:
  /// `volume`: part_volumes(). The mesh must outlive it.
  TurnedParts(const std::vector<std::array<float, 3>>& positions, const std::vector<Triangle>& triangles,
              const std::vector<std::uint32_t>& of_vertex, const std::vector<double>& volume,
              const Workers& workers);
  ~TurnedParts();
  TurnedParts(const TurnedParts&) = delete;
  TurnedParts& operator=(const TurnedParts&) = delete;

  /// Their first vertices, ascending.
  const std::vector<std::uint32_t>& numbers() const { return numbers_; }
  /// Does x lie in a part with a positive volume? Only if there are turned ones.
  bool is_in_water(const Vec3& x) const;

 private:
  std::unique_ptr<LineCrossings> positive_;
  std::vector<std::uint32_t> numbers_;
};

}  // namespace oilskin::reconstruction
