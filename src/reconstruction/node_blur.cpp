#include "reconstruction/node_blur.h"

#include <algorithm>
#include <cmath>

#include "reconstruction/node_bits.h"

namespace oilskin::reconstruction {

namespace {

constexpr int longest_step = 4;

/// Passes with the weights ¼, ½, ¼ at −step, 0, step have the variance step²/2 each. The steps of passes with
/// about this variance together, short ones first: they remove what is too fine for the long ones.
std::vector<int> steps_for(double variance) {
  std::vector<int> steps;
  for (int step = longest_step; step > 1; step /= 2) {
    const double own = step * step / 2.0;
    while (variance >= 1.5 * own) {
      steps.push_back(step);
      variance -= own;
    }
  }
  const auto single = static_cast<std::size_t>(std::lround(2 * variance));
  steps.insert(steps.end(), single, 1);
  std::reverse(steps.begin(), steps.end());
  return steps;
}

class NodeBlur {
 public:
  NodeBlur(const Grid& grid, const CubeLattice& lattice, const Workers& workers)
      : grid_(grid), lattice_(lattice), workers_(workers), around_(neighbours_of(grid)) {
    outside_.fill(0);
    solid_.fill(1);
  }
  /// `combine`: of the values at −step, 0 and step.
  template <class F>
  void pass(const NodeValues& from, std::size_t axis, int step, const F& combine, NodeValues& to) const {
    workers_.for_each(lattice_.size(), 16, [&](std::size_t n) {
      const std::array<std::uint32_t, 6>& around = around_[lattice_.block(n)];
      const float *const before = values(from, around[2 * axis]), *const after =
                                                                      values(from, around[2 * axis + 1]);
      if (axis == 0)
        along_rows(before, from[n].data(), after, step, combine, to[n].data());
      else
        across_rows(before, from[n].data(), after, axis, step, combine, to[n].data());
    });
  }

 private:
  const float* values(const NodeValues& from, std::uint32_t block) const {
    if (const std::uint32_t place = lattice_.place(block); place != none) return from[place].data();
    return block != none && grid_.blocks[block].solid ? solid_.data() : outside_.data();
  }
  template <class F>
  static void along_rows(const float* before, const float* own, const float* after, int step,
                         const F& combine, float* to) {
    for (int row = 0; row < nodes; row += side) {
      std::array<float, side + 2 * longest_step> line;
      std::copy(before + row + side - longest_step, before + row + side, line.begin());
      std::copy(own + row, own + row + side, line.begin() + longest_step);
      std::copy(after + row, after + row + longest_step, line.begin() + longest_step + side);
      const float* const at = &line[longest_step];
      for (int i = 0; i < side; ++i) to[row + i] = combine(at[i - step], at[i], at[i + step]);
    }
  }
  template <class F>
  static void across_rows(const float* before, const float* own, const float* after, std::size_t axis,
                          int step, const F& combine, float* to) {
    const int along = axis == 1 ? side : side * side, other = axis == 1 ? side * side : side;
    const auto row = [&](int at, int beside) {
      const float* const block = at < 0 ? before : (at < side ? own : after);
      return block + (at & (side - 1)) * along + beside * other;
    };
    for (int beside = 0; beside < side; ++beside)
      for (int at = 0; at < side; ++at) {
        const float *const below = row(at - step, beside), *const middle = row(at, beside),
                           *const above = row(at + step, beside);
        float* const result = to + at * along + beside * other;
        for (int i = 0; i < side; ++i) result[i] = combine(below[i], middle[i], above[i]);
      }
  }

  const Grid& grid_;
  const CubeLattice& lattice_;
  const Workers& workers_;
  std::vector<std::array<std::uint32_t, 6>> around_;  // per block of the grid
  std::array<float, nodes> outside_, solid_;
};

}  // namespace

NodeValues inside_parts(const Grid& grid, const CubeLattice& lattice, const Workers& workers) {
  NodeValues parts(lattice.size());
  const std::vector<std::array<std::uint32_t, 6>> neighbours = neighbours_of(grid);
  const auto slice = [&](std::uint32_t block, int k) { return grid.slice(block, k); };
  workers.for_each(lattice.size(), 16, [&](std::size_t n) {
    const std::uint32_t b = lattice.block(n);
    for (int k = 0; k < side; ++k) {
      const std::uint64_t in = grid.slice(b, k);
      std::uint64_t all = ~0ull, any = 0;
      for (const std::uint64_t beside : bits_beside(b, neighbours[b], k, slice)) {
        all &= beside;
        any |= beside;
      }
      for (int at = 0; at < 64; ++at) {
        const int node = 64 * k + at;
        float& part = parts[n][std::size_t(node)];
        part = in >> at & 1 ? 1.0f : 0.0f;
        // Next to the surface, the part of half a cell to each side of the node. Deeper inside values may be
        // small between particles.
        const bool at_surface = (in >> at & 1) ? !(all >> at & 1) : any >> at & 1;
        if (at_surface && grid.blocks[b].field != none)
          part = std::clamp(0.5f - grid.value({b, node}), 0.0f, 1.0f);
      }
    }
  });
  return parts;
}

NodeValues inside_shares(NodeValues parts, double deviation, const Grid& grid, const CubeLattice& lattice,
                         const Workers& workers) {
  NodeValues other(lattice.size());
  const NodeBlur blur(grid, lattice, workers);
  const auto mean = [](float below, float own, float above) { return 0.5f * own + 0.25f * (below + above); };
  for (const int step : steps_for(deviation * deviation))
    for (std::size_t axis = 0; axis < 3; ++axis) {
      blur.pass(parts, axis, step, mean, other);
      std::swap(parts, other);
    }
  return parts;
}

NodeValues largest_around(NodeValues values, int reach, const Grid& grid, const CubeLattice& lattice,
                          const Workers& workers) {
  NodeValues other(lattice.size());
  const NodeBlur blur(grid, lattice, workers);
  const auto largest = [](float below, float own, float above) { return std::max({below, own, above}); };
  for (int reached = 0; reached < reach;) {
    // A longer step would leave gaps.
    const int step = std::min({longest_step, 2 * reached + 1, reach - reached});
    for (std::size_t axis = 0; axis < 3; ++axis) {
      blur.pass(values, axis, step, largest, other);
      std::swap(values, other);
    }
    reached += step;
  }
  return values;
}

}  // namespace oilskin::reconstruction
