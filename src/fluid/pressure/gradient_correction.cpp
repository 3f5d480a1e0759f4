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

/// c_i of (F.77).
double weight(double relative_density, double pull, double largest_pull) {
  return std::clamp(20 * (relative_density - 0.9), 0.0, 1.0) *
         std::clamp(2 - 2 * pull / largest_pull, 0.0, 1.0);
}

/// B of (F.77): (tr M/3) M⁻¹ − 1 by the adjugate, at most of the norm `largest_correction`; 0 where M is
/// singular.
Matrix3d correction_of(const Matrix3d& m) {
  const double xx = m(1, 1) * m(2, 2) - m(1, 2) * m(1, 2), yy = m(0, 0) * m(2, 2) - m(0, 2) * m(0, 2),
               zz = m(0, 0) * m(1, 1) - m(0, 1) * m(0, 1), xy = m(0, 2) * m(1, 2) - m(0, 1) * m(2, 2),
               xz = m(0, 1) * m(1, 2) - m(0, 2) * m(1, 1), yz = m(0, 1) * m(0, 2) - m(0, 0) * m(1, 2);
  const double determinant = m(0, 0) * xx + m(0, 1) * xy + m(0, 2) * xz;
  Matrix3d b;
  b << xx, xy, xz, xy, yy, yz, xz, yz, zz;
  b = m.trace() / 3 / determinant * b - Matrix3d::Identity();
  const double norm = b.norm();
  if (!(determinant > 0) || !std::isfinite(norm)) return Matrix3d::Zero();
  return norm > largest_correction ? Matrix3d(largest_correction / norm * b) : b;
}

}  // namespace

void GradientCorrection::begin_step(StepState& state, const std::vector<Record>& sums, float density_scale) {
  const std::size_t n = state.size();
  OILSKIN_ASSERT(is_on() && sums.size() == n && moments_.size() == n);
  for (std::vector<Record>* of_particles : {&diagonal_, &rest_}) {
    of_particles->resize(n + 1);
    of_particles->back() = {0, 0, 0, 0};
  }
  own_.resize(n);
  state.for_each([&](std::size_t i) { set_tensor(state, i, sums, density_scale); });
}

/// K_i (F.77), and what K_i makes of the sums.
void GradientCorrection::set_tensor(const StepState& state, std::size_t i, const std::vector<Record>& sums,
                                    float density_scale) {
  const SecondMoments& s = moments_[i];
  const double d = static_cast<double>(density_scale);
  const Eigen::Vector3f sum(sums[i].x, sums[i].y, sums[i].z);
  Matrix3d m;
  m << static_cast<double>(s.xx), static_cast<double>(s.xy), static_cast<double>(s.xz),
      static_cast<double>(s.xy), static_cast<double>(s.yy), static_cast<double>(s.yz),
      static_cast<double>(s.xz), static_cast<double>(s.yz), static_cast<double>(s.zz);
  m *= -d;
  Eigen::Vector3f pull = density_scale * sum;
  const std::uint32_t k = WallResponse::point_of(state, i);
  if (k != Boundary::none) {
    const WallPoint& point = state.boundary.points()[k];
    pull -= point.gamma;
    for (std::uint32_t w = point.begin; w < point.end; ++w) {
      const Wall& wall = state.boundary.walls()[w];
      const Vec3 normal = wall.normal.cast<double>();
      m += static_cast<double>(wall.gamma.norm() * wall.distance) * normal * normal.transpose();
    }
  }
  const double c = weight(static_cast<double>(state.relative_density[i]), static_cast<double>(pull.norm()),
                          k != Boundary::none ? largest_pull_at_walls : largest_pull_inside);
  const Matrix3d tensor =
      c > 0 ? Matrix3d(Matrix3d::Identity() + share_ * c * correction_of(m)) : Matrix3d(Matrix3d::Identity());
  diagonal_[i] = to_record({tensor(0, 0), tensor(1, 1), tensor(2, 2)});
  rest_[i] = to_record({tensor(0, 1), tensor(0, 2), tensor(1, 2)});
  const Eigen::Vector3f own = times(i, sum);
  own_[i] = {own.x(), own.y(), own.z(), 0};
}

Eigen::Vector3f GradientCorrection::times(std::size_t i, const Eigen::Vector3f& g) const {
  const Record &d = diagonal_[i], &r = rest_[i];
  return {d.x * g.x() + r.x * g.y() + r.y * g.z(), r.x * g.x() + d.y * g.y() + r.z * g.z(),
          r.y * g.x() + r.z * g.y() + d.z * g.z()};
}

void GradientCorrection::push(StepState& state, const std::vector<Record>& x_phi, PairRange range,
                              Record* out) const {
  pair_kernels().corrected.pressure(pair_table(state, range.begin), x_phi.data(), tensors(), range, out);
  for (std::size_t i = range.begin; i < range.end; ++i, ++out) {
    out->x += x_phi[i].w * own_[i].x;
    out->y += x_phi[i].w * own_[i].y;
    out->z += x_phi[i].w * own_[i].z;
  }
}

void GradientCorrection::compression(StepState& state, const std::vector<Record>& y, PairRange range,
                                     float* out) const {
  pair_kernels().corrected.compression(pair_table(state, range.begin), state.position().data(), tensors(),
                                       y.data(), range, out);
}

void GradientCorrection::apply_pressure(StepState& state, const std::vector<Record>& x_phi,
                                        double scale) const {
  state.for_chunks([&](std::size_t begin, std::size_t end) {
    Change sum[chunk_size];
    pair_kernels().corrected.pressure_exact(pair_table(state, begin), x_phi.data(), tensors(), {begin, end},
                                            sum);
    for (std::size_t i = begin; i < end; ++i) state.dv[i] -= scale * to_vector(sum[i - begin]);
  });
}

}  // namespace oilskin::fluid
