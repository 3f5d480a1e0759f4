#include "reconstruction/cube_lattice.h"

#include <algorithm>
#include <cmath>

namespace oilskin::reconstruction {

namespace {

/// Rings of blocks around those with surface.
constexpr int rings = 3;

}  // namespace

std::vector<std::array<std::uint32_t, 6>> neighbours_of(const Grid& grid) {
  std::array<std::uint32_t, 6> alone;
  alone.fill(none);
  std::vector<std::array<std::uint32_t, 6>> result(grid.blocks.size(), alone);
  for (std::uint32_t b = 0; b < grid.blocks.size(); ++b)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::uint32_t up = grid.blocks[b].plus[std::size_t{1} << axis];
      if (up == none) continue;
      result[b][2 * axis + 1] = up;
      result[up][2 * axis] = b;
    }
  return result;
}

CubeLattice::CubeLattice(const Grid& grid, std::vector<std::uint8_t> has_surface)
    : grid_(grid), place_of_(grid.blocks.size(), none) {
  OILSKIN_ASSERT(has_surface.size() == grid.blocks.size());
  const auto around = neighbours_of(grid);
  for (std::size_t pass = 0; pass < 3 * rings; ++pass) {
    const std::vector<std::uint8_t> before = has_surface;
    for (std::size_t b = 0; b < before.size(); ++b)
      for (const std::uint32_t n : {around[b][2 * (pass % 3)], around[b][2 * (pass % 3) + 1]})
        if (before[b] && n != none) has_surface[n] = 1;
  }
  for (std::uint32_t b = 0; b < has_surface.size(); ++b) {
    if (!has_surface[b]) continue;
    place_of_[b] = static_cast<std::uint32_t>(blocks_.size());
    blocks_.push_back(b);
  }
  neighbours_.resize(blocks_.size());
  for (std::size_t n = 0; n < blocks_.size(); ++n)
    for (std::size_t k = 0; k < 6; ++k) neighbours_[n][k] = place(around[blocks_[n]][k]);
}

/// Two passes along an axis at once: weights 1, 4, 6, 4, 1 over 16.
void CubeLattice::smooth_twice(const Cubes& from, std::size_t axis, Cubes& to, const Workers& workers) const {
  static constexpr std::array<float, 8> nothing{};
  const std::size_t bit = std::size_t{1} << axis;
  workers.for_each(from.size(), 128, [&](std::size_t n) {
    const std::uint32_t down = neighbours_[n][2 * axis], up = neighbours_[n][2 * axis + 1];
    const std::array<float, 8>&own = from[n], &before = down == none ? nothing : from[down],
                            &after = up == none ? nothing : from[up];
    for (std::size_t low = 0; low < 8; ++low) {
      if (low & bit) continue;
      const std::size_t high = low | bit;
      to[n][low] =
          0.0625f * (before[low] + after[low]) + 0.25f * (before[high] + own[high]) + 0.375f * own[low];
      to[n][high] =
          0.0625f * (before[high] + after[high]) + 0.25f * (own[low] + after[low]) + 0.375f * own[high];
    }
  });
}

void CubeLattice::smooth(Cubes& values, int passes, const Workers& workers) const {
  OILSKIN_ASSERT(values.size() == size() && passes % 2 == 0);
  Cubes other(size());
  for (int pass = 0; pass < passes / 2; ++pass)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      smooth_twice(values, axis, other, workers);
      std::swap(values, other);
    }
}

CubeLattice::Around::Around(const CubeLattice& lattice, const Cubes& values, std::uint32_t block) {
  const Grid& grid = lattice.grid_;
  std::array<const std::array<float, 8>*, 27> at{};
  for (int o = 0; o < 27; ++o) {
    const Int3 step{o % 3 - 1, o / 3 % 3 - 1, o / 9 - 1};
    const std::uint32_t b = step == Int3{} ? block : grid.index.find(key_of(grid.blocks[block].at + step));
    const std::uint32_t place = lattice.place(b);
    if (place != none) at[std::size_t(o)] = &values[place];
  }
  for (int k = -1; k <= 2; ++k)
    for (int j = -1; j <= 2; ++j)
      for (int i = -1; i <= 2; ++i) {
        const int o = ((i >> 1) + 1) + 3 * ((j >> 1) + 1) + 9 * ((k >> 1) + 1);
        const auto* const cubes = at[std::size_t(o)];
        values_[std::size_t((i + 1) + 4 * (j + 1) + 16 * (k + 1))] =
            cubes ? (*cubes)[std::size_t((i & 1) | (j & 1) << 1 | (k & 1) << 2)] : 0.0f;
      }
}

bool CubeLattice::Around::is_zero() const {
  return std::all_of(values_.begin(), values_.end(), [](float v) { return v == 0; });
}

double CubeLattice::Around::at_node(int node) const {
  return at(Vec3(node & 7, node >> 3 & 7, node >> 6) + Vec3::Constant(0.5));
}

double CubeLattice::Around::at(const Vec3& x) const {
  std::array<std::size_t, 3> low;
  std::array<double, 3> f;
  for (int a = 0; a < 3; ++a) {
    const double q = std::clamp(x[a] / cube_side + 0.5, 0.0, 2.999);
    low[std::size_t(a)] = static_cast<std::size_t>(q);
    f[std::size_t(a)] = q - std::floor(q);
  }
  double sum = 0;
  for (std::size_t o = 0; o < 8; ++o) {
    const std::size_t i = o & 1, j = o >> 1 & 1, k = o >> 2;
    const double weight = (i ? f[0] : 1 - f[0]) * (j ? f[1] : 1 - f[1]) * (k ? f[2] : 1 - f[2]);
    sum += weight * double(values_[(low[0] + i) + 4 * (low[1] + j) + 16 * (low[2] + k)]);
  }
  return sum;
}

}  // namespace oilskin::reconstruction
