#include "effects/wetting/sparse_solver.h"

#include <Eigen/SparseCore>
#include <Eigen/SparseLU>
#include <algorithm>
#include <cmath>
#include <limits>

namespace oilskin {

namespace {

/// The direct method takes about as long as this many iterations for some thousand rows.
constexpr int max_iterations = 80;

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

bool solve_directly(const SparseMatrix& a, const std::vector<double>& b, std::vector<double>& x) {
  using Matrix = Eigen::SparseMatrix<double>;
  const auto n = static_cast<Eigen::Index>(a.size());
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(a.value.size() + a.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    entries.emplace_back(static_cast<int>(i), static_cast<int>(i), a.diagonal[i]);
    for (std::uint32_t k = a.begin[i]; k < a.begin[i + 1]; ++k)
      entries.emplace_back(static_cast<int>(i), static_cast<int>(a.column[k]), a.value[k]);
  }
  Matrix m(n, n);
  m.setFromTriplets(entries.begin(), entries.end());
  Eigen::SparseLU<Matrix> lu;
  lu.compute(m);
  if (lu.info() != Eigen::Success) return false;
  const Eigen::VectorXd solution = lu.solve(Eigen::Map<const Eigen::VectorXd>(b.data(), n));
  if (lu.info() != Eigen::Success || !solution.allFinite()) return false;
  std::copy(solution.data(), solution.data() + n, x.begin());
  return true;
}

}  // namespace

void SparseMatrix::multiply(const std::vector<double>& x, std::vector<double>& y) const {
  for (std::size_t i = 0; i < size(); ++i) {
    double sum = diagonal[i] * x[i];
    for (std::uint32_t k = begin[i]; k < begin[i + 1]; ++k) sum += value[k] * x[column[k]];
    y[i] = sum;
  }
}

/// The tolerance, or what rounding leaves of a residual times its weight.
double SparseSolver::limit(const SparseMatrix& a, const std::vector<double>& weight, double tolerance,
                           double magnitude) {
  double scale = 0;
  for (std::size_t i = 0; i < a.size(); ++i) scale = std::max(scale, a.diagonal[i] * weight[i]);
  return std::max(tolerance, 8 * std::numeric_limits<double>::epsilon() * scale) * magnitude;
}

bool SparseSolver::is_solved(const std::vector<double>& weight, double limit) const {
  for (std::size_t i = 0; i < r_.size(); ++i)
    if (!(std::abs(r_[i]) * weight[i] <= limit)) return false;
  return true;
}

void SparseSolver::start(const SparseMatrix& a, const std::vector<double>& b, const std::vector<double>& x) {
  const std::size_t n = a.size();
  for (auto* v : {&r_, &inverse_, &v_, &t_, &y_}) v->resize(n);
  a.multiply(x, r_);
  for (std::size_t i = 0; i < n; ++i) {
    r_[i] = b[i] - r_[i];
    inverse_[i] = 1 / a.diagonal[i];
  }
  shadow_ = r_;
  p_ = r_;
  rho_ = dot(shadow_, r_);
  iterations_ = 0;
}

/// One iteration of BiCGSTAB; false: it broke down.
bool SparseSolver::iterate(const SparseMatrix& a, std::vector<double>& x) {
  const std::size_t n = a.size();
  for (std::size_t i = 0; i < n; ++i) y_[i] = inverse_[i] * p_[i];
  a.multiply(y_, v_);
  const double alpha = rho_ / dot(shadow_, v_);
  for (std::size_t i = 0; i < n; ++i) {
    x[i] += alpha * y_[i];
    r_[i] -= alpha * v_[i];
    y_[i] = inverse_[i] * r_[i];
  }
  a.multiply(y_, t_);
  const double tt = dot(t_, t_);
  const double omega = tt > 0 ? dot(t_, r_) / tt : 0;
  for (std::size_t i = 0; i < n; ++i) {
    x[i] += omega * y_[i];
    r_[i] -= omega * t_[i];
  }
  const double rho = dot(shadow_, r_);
  const double beta = rho / rho_ * (alpha / omega);
  for (std::size_t i = 0; i < n; ++i) p_[i] = r_[i] + beta * (p_[i] - omega * v_[i]);
  rho_ = rho;
  ++iterations_;
  return std::isfinite(alpha);
}

bool SparseSolver::solve(const SparseMatrix& a, const std::vector<double>& b,
                         const std::vector<double>& weight, double tolerance, double magnitude,
                         std::vector<double>& x) {
  start(a, b, x);
  const double largest = limit(a, weight, tolerance, magnitude);
  while (iterations_ < max_iterations) {
    if (is_solved(weight, largest)) return true;
    if (!iterate(a, x)) break;
  }
  iterations_ = 0;
  return solve_directly(a, b, x);
}

}  // namespace oilskin
