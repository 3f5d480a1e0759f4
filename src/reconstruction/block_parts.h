/// Places of a block in eight parts, so that searches around those of a part look at fewer particles.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "reconstruction/grid.h"

namespace oilskin::reconstruction {

class BlockParts {
 public:
  struct Part {
    std::array<float, 3> low, high;  ///< the bounds of its places
    std::vector<std::uint32_t> numbers;
    std::vector<std::array<float, 3>> places;  ///< relative to the block [cells]
  };

  void clear() {
    for (Part& p : parts_) {
      p.low.fill(1e30f);
      p.high.fill(-1e30f);
      p.numbers.clear();
      p.places.clear();
    }
  }
  /// `place` relative to the block [cells].
  void add(std::uint32_t number, const Vec3& place) {
    const std::array<float, 3> x = {float(place.x()), float(place.y()), float(place.z())};
    constexpr float middle = side / 2.0f;
    Part& p = parts_[std::size_t((x[0] > middle) | (x[1] > middle) << 1 | (x[2] > middle) << 2)];
    p.numbers.push_back(number);
    p.places.push_back(x);
    for (std::size_t a = 0; a < 3; ++a) {
      p.low[a] = std::min(p.low[a], x[a]);
      p.high[a] = std::max(p.high[a], x[a]);
    }
  }
  /// Calls f(part) for the parts with places.
  template <class F>
  void for_each(const F& f) const {
    for (const Part& p : parts_)
      if (!p.numbers.empty()) f(p);
  }

 private:
  std::array<Part, 8> parts_;
};

}  // namespace oilskin::reconstruction
