#include "reconstruction/cube_lattice.h"

#include <algorithm>
#include <cmath>

namespace oilskin::reconstruction {

CubeLattice::CubeLattice(const Grid& grid) : grid_(grid), neighbours_(grid.blocks.size()) {
  for (std::size_t b = 0; b < grid.blocks.size(); ++b)
    for (int axis = 0; axis < 3; ++axis) {
      const Int3 step{axis == 0, axis == 1, axis == 2};
      neighbours_[b][std::size_t(2 * axis)] = grid.index.find(key_of(grid.blocks[b].at - step));
      neighbours_[b][std::size_t(2 * axis + 1)] = grid.index.find(key_of(grid.blocks[b].at + step));
    }
}

std::uint32_t CubeLattice::cube_at(const Vec3& x) const {
  const auto part = [](double v) { return static_cast<int>(std::floor(v / cube_side)); };
  const int i = part(x.x()), j = part(x.y()), k = part(x.z());
  const std::uint32_t b = grid_.index.find(key_of({i >> 1, j >> 1, k >> 1}));
  return b == none ? none : 8 * b + static_cast<std::uint32_t>((i & 1) | (j & 1) << 1 | (k & 1) << 2);
}

/// The value at the next cube along an axis.
float CubeLattice::next(const Cubes& values, std::size_t b, std::size_t cube, int axis, bool up) const {
  const std::size_t bit = std::size_t{1} << axis, other = cube ^ bit;
  if (((cube & bit) != 0) != up) return values[b][other];
  const std::uint32_t n = neighbours_[b][std::size_t(2 * axis + up)];
  return n == none ? 0 : values[n][other];
}

Cubes CubeLattice::smoothed(Cubes values, int passes, const Workers& workers) const {
  Cubes next_values = zeros();
  for (int pass = 0; pass < 3 * passes; ++pass) {
    const int axis = pass % 3;
    workers.for_each(values.size(), 64, [&](std::size_t b) {
      for (std::size_t c = 0; c < 8; ++c)
        next_values[b][c] =
            0.5f * values[b][c] + 0.25f * (next(values, b, c, axis, false) + next(values, b, c, axis, true));
    });
    std::swap(values, next_values);
  }
  return values;
}

CubeLattice::Around::Around(const CubeLattice& lattice, const Cubes& values, std::uint32_t block) {
  const Grid& grid = lattice.grid_;
  for (int k = -1; k <= 2; ++k)
    for (int j = -1; j <= 2; ++j)
      for (int i = -1; i <= 2; ++i) {
        const Int3 step{i >> 1, j >> 1, k >> 1};
        const std::uint32_t b =
            step == Int3{} ? block : grid.index.find(key_of(grid.blocks[block].at + step));
        values_[std::size_t((i + 1) + 4 * (j + 1) + 16 * (k + 1))] =
            b == none ? 0 : values[b][std::size_t((i & 1) | (j & 1) << 1 | (k & 1) << 2)];
      }
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
