#include "fluid/pressure/gradient_correction.h"

#include <Eigen/Eigenvalues>
#include <algorithm>

namespace oilskin::fluid {

namespace {

/// Bound on |eigenvalue of K_i − 1|. In settled water the moments scatter by a tenth. At a free surface a
/// moment may be half of that of the bulk: a pressure force that is twice as strong there ejects particles.
constexpr float max_correction = 0.25f;

/// Keeps M invertible where a particle has neighbours on one side only.
constexpr float least_moment = 0.05f;

/// Σ_T |γ_T| ζ_T n n^T: the part of M_i that belongs to the walls, whose term of the divergence is not
/// corrected.
Eigen::Matrix3f wall_moments(const Boundary& boundary, const WallPoint& point) {
  Eigen::Matrix3f m = Eigen::Matrix3f::Zero();
  for (std::uint32_t w = point.begin; w < point.end; ++w) {
    const Wall& wall = boundary.walls()[w];
    const float gamma = wall.gamma.norm();
    if (gamma > 0) m += (wall.distance / gamma) * wall.gamma * wall.gamma.transpose();
  }
  return m;
}

}  // namespace

void GradientCorrection::resize(std::size_t particles) {
  moments_.resize(particles);
  largest_.resize(particles);
  diagonal_.resize(particles + 1);
  other_.resize(particles + 1);
  diagonal_[particles] = other_[particles] = Record{0, 0, 0, 0};
}

/// With K M + M^walls = 1 the divergence of a linear field that satisfies the walls' condition is exact
/// (F.57).
void GradientCorrection::build(const StepState& state) {
  using Matrix = Eigen::Matrix3f;
  state.for_each([&](std::size_t i) {
    Matrix& m = moments_[i];
    const std::uint32_t k = state.boundary.empty() ? Boundary::none : state.boundary.point_of(i);
    Matrix rest = (1 + least_moment) * Matrix::Identity();
    if (k != Boundary::none) rest -= wall_moments(state.boundary, state.boundary.points()[k]);
    const Matrix q = rest * Matrix(m + least_moment * Matrix::Identity()).inverse();
    Eigen::SelfAdjointEigenSolver<Matrix> solver;
    solver.computeDirect(Matrix(0.5f * (q + q.transpose())));
    if (!(solver.info() == Eigen::Success && solver.eigenvalues().allFinite() &&
          solver.eigenvectors().allFinite())) {
      m.setIdentity();
      largest_[i] = 1;
      return;
    }
    const Eigen::Vector3f e =
        solver.eigenvalues().array().max(1 - max_correction).min(1 + max_correction).matrix();
    m = solver.eigenvectors() * e.asDiagonal() * solver.eigenvectors().transpose();
    largest_[i] = e.maxCoeff();
  });
}

void GradientCorrection::set_pressures(const StepState& state, const std::vector<float>& phi) {
  state.for_each([&](std::size_t i) {
    const Eigen::Matrix3f& k = moments_[i];
    const float p = phi[i];
    diagonal_[i] = {p * k(0, 0), p * k(1, 1), p * k(2, 2), 0};
    other_[i] = {p * k(0, 1), p * k(0, 2), p * k(1, 2), 0};
  });
}

float GradientCorrection::compression(const StepState& state, const std::vector<Record>& y,
                                      std::size_t i) const {
  const std::uint32_t* j = state.neighbours.list(i);
  const float* gradient = gradients(state, i);
  const Record& own = y[i];
  const Eigen::Matrix3f& k = moments_[i];
  const F4 xx(k(0, 0)), yy(k(1, 1)), zz(k(2, 2)), xy(k(0, 1)), xz(k(0, 2)), yz(k(1, 2));
  F4 sum;
  for (std::uint32_t b = state.neighbours.blocks(i); b > 0; --b, j += 4, gradient += 12) {
    const Record4 v(y.data(), j);
    const F4 gx = load(gradient), gy = load(gradient + 4), gz = load(gradient + 8);
    sum += (F4(own.x) - v.x) * (xx * gx + xy * gy + xz * gz) +
           (F4(own.y) - v.y) * (xy * gx + yy * gy + yz * gz) +
           (F4(own.z) - v.z) * (xz * gx + yz * gy + zz * gz);
  }
  return total(sum);
}

}  // namespace oilskin::fluid
