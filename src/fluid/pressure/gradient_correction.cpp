#include "fluid/pressure/gradient_correction.h"

#include "core/assert.h"
#include "fluid/pressure/wall_response.h"

namespace oilskin::fluid {

namespace {

using Eigen::Matrix3d;

/// Largest Frobenius norm of B: K stays positive.
constexpr double largest_correction = 1;

/// e of (F.77): the asymmetry |Ξ − γ| from which on nothing is corrected. At the surface of the water a half
/// of the moments is missing. With 2 for all particles, columns at rest on contact alone boil. At walls the
/// images complete the moments.
constexpr double largest_pull_inside = 0.6, largest_pull_at_walls = 2;

/// How fast the correction ends with the part of the walls that is missing (F.77). An image stands for a
/// whole plane; where fluid goes around an edge the moments are those of neither. A box in a tank made the
/// water around it move three times as fast.
constexpr double per_uncovered = 4;

/// c_i of (F.77).
double weight(double relative_density, double pull, double largest_pull, double covered) {
  return std::clamp(20 * (relative_density - 0.9), 0.0, 1.0) *
         std::clamp(2 - 2 * pull / largest_pull, 0.0, 1.0) *
         std::clamp(1 - per_uncovered * (1 - covered), 0.0, 1.0);
}

/// B of (F.77): (tr M/3) M⁻¹ − 1 by the adjugate, at most of the norm `largest_correction`; 0 where M is
/// singular.
Matrix3d correction_of(const Matrix3d& m) {
  const double xx = m(1, 1) * m(2, 2) - m(1, 2) * m(1, 2), yy = m(0, 0) * m(2, 2) - m(0, 2) * m(0, 2),
               zz = m(0, 0) * m(1, 1) - m(0, 1) * m(0, 1), xy = m(0, 2) * m(1, 2) - m(0, 1) * m(2, 2),
               xz = m(0, 1) * m(1, 2) - m(0, 2) * m(1, 1), yz = m(0, 1) * m(0, 2) - m(0, 0) * m(1, 2);
  const double determinant = m(0, 0) * xx + m(0, 1) * xy + m(0, 2) * xz;
  if (!(determinant > 0)) return Matrix3d::Zero();
  Matrix3d b;
  b << xx, xy, xz, xy, yy, yz, xz, yz, zz;
  b = m.trace() / 3 / determinant * b - Matrix3d::Identity();
  const double norm = b.norm();
  if (!std::isfinite(norm)) return Matrix3d::Zero();
  return norm > largest_correction ? Matrix3d(largest_correction / norm * b) : b;
}

}  // namespace

void GradientCorrection::begin_step(StepState& state, std::vector<Record>& sums, float density_scale) {
  OILSKIN_ASSERT(is_on() && sums.size() == state.size() && !tensors_.empty());
  state.for_each([&](std::size_t i) { set_tensor(state, i, sums[i], density_scale); });
}

/// K_i (F.77), and what K_i makes of the sum.
void GradientCorrection::set_tensor(const StepState& state, std::size_t i, Record& sum_and_squares,
                                    float density_scale) {
  const SecondMoments s = tensors_[i];
  const double d = static_cast<double>(density_scale);
  const Eigen::Vector3f sum(sum_and_squares.x, sum_and_squares.y, sum_and_squares.z);
  Matrix3d m;
  m << static_cast<double>(s.xx), static_cast<double>(s.xy), static_cast<double>(s.xz),
      static_cast<double>(s.xy), static_cast<double>(s.yy), static_cast<double>(s.yz),
      static_cast<double>(s.xz), static_cast<double>(s.yz), static_cast<double>(s.zz);
  m *= -d;
  Eigen::Vector3f pull = density_scale * sum;
  double largest_pull = largest_pull_inside, covered = 1;
  const std::uint32_t k = state.wall_point_of(i);
  if (k != Boundary::none) {
    const WallPoint& point = state.boundary.points()[k];
    pull -= point.gamma;
    largest_pull = largest_pull_at_walls;
    covered = static_cast<double>(point.covered);
    for (std::uint32_t w = point.begin; w < point.end; ++w) {
      const Wall& wall = state.boundary.walls()[w];
      const Vec3 normal = wall.normal.cast<double>();
      m += static_cast<double>(wall.gamma.norm() * wall.distance) * normal * normal.transpose();
    }
  }
  const double c = weight(static_cast<double>(state.relative_density[i]), static_cast<double>(pull.norm()),
                          largest_pull, covered);
  const Matrix3d tensor =
      c > 0 ? Matrix3d(Matrix3d::Identity() + share_ * c * correction_of(m)) : Matrix3d(Matrix3d::Identity());
  const Eigen::Matrix3f k_i = tensor.cast<float>();
  tensors_.set(i, {k_i(0, 0), k_i(1, 1), k_i(2, 2), k_i(0, 1), k_i(0, 2), k_i(1, 2)});
  sum_and_squares.x = k_i(0, 0) * sum.x() + k_i(0, 1) * sum.y() + k_i(0, 2) * sum.z();
  sum_and_squares.y = k_i(0, 1) * sum.x() + k_i(1, 1) * sum.y() + k_i(1, 2) * sum.z();
  sum_and_squares.z = k_i(0, 2) * sum.x() + k_i(1, 2) * sum.y() + k_i(2, 2) * sum.z();
}

void GradientCorrection::push(StepState& state, const std::vector<Record>& x_phi,
                              const std::vector<Record>& own, PairRange range, Record* out) const {
  pair_kernels().corrected.pressure(pair_table(state, range.begin), x_phi.data(), tensors_.view(), range,
                                    out);
  for (std::size_t i = range.begin; i < range.end; ++i, ++out) {
    out->x += x_phi[i].w * own[i].x;
    out->y += x_phi[i].w * own[i].y;
    out->z += x_phi[i].w * own[i].z;
  }
}

void GradientCorrection::compression(StepState& state, const std::vector<Record>& y, PairRange range,
                                     float* out) const {
  pair_kernels().corrected.compression(pair_table(state, range.begin), state.position().data(),
                                       tensors_.view(), y.data(), range, out);
}

void GradientCorrection::apply_pressure(StepState& state, const std::vector<Record>& x_phi,
                                        double scale) const {
  state.for_chunks([&](std::size_t begin, std::size_t end) {
    Change sum[chunk_size];
    pair_kernels().corrected.pressure_exact(pair_table(state, begin), x_phi.data(), tensors_.view(),
                                            {begin, end}, sum);
    for (std::size_t i = begin; i < end; ++i) state.dv[i] -= scale * to_vector(sum[i - begin]);
  });
}

}  // namespace oilskin::fluid
