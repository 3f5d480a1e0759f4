#include "effects/wall_drag.h"

namespace oilskin::effects {

namespace {

constexpr int table_size = 128;

/// ∫_ζ^1 ψ q (q² − ζ²)² dq by Simpson's rule.
double half_space_integral(const fluid::ViscousWeights& weights, double zeta) {
  constexpr int intervals = 256;
  const double step = (1 - zeta) / intervals;
  double sum = 0;
  for (int k = 0; k <= intervals; ++k) {
    const double q = zeta + k * step, square = q * q - zeta * zeta;
    const double factor = k == 0 || k == intervals ? 1 : k % 2 == 1 ? 4 : 2;
    sum += factor * viscous_shape(weights, q) * q * square * square;
  }
  return sum * step / 3;
}

}  // namespace

double viscous_shape(const fluid::ViscousWeights& weights, double q) {
  const double u = std::max(0.0, 1 - q);
  const double slope = -fluid::CubicSpline::dw_over_q(q) / (q * q + 0.01);
  return std::max(0.0, weights.slope * slope + weights.hat * u * u);
}

WallDrag::WallDrag(double ratio) : ratio_(ratio) {
  const fluid::ViscousWeights weights = fluid::viscous_weights<fluid::CubicSpline>(ratio);
  for (int k = 0; k <= table_size; ++k)
    table_.push_back(half_space_integral(weights, static_cast<double>(k) / table_size));
  // The layers of a lattice, the first half a spacing off, feel the traction of a linear profile (V.6).
  double layers = 0;
  for (int k = 0; k + 0.5 < ratio; ++k) layers += 2 / ratio * (*this)((k + 0.5) / ratio);
  for (double& value : table_) value /= layers;
}

double WallDrag::operator()(double zeta) const {
  if (!(zeta < 1)) return 0;
  const double at = std::max(0.0, zeta) * table_size;
  const auto k = std::min(static_cast<std::size_t>(at), static_cast<std::size_t>(table_size - 1));
  const double t = at - static_cast<double>(k);
  return (1 - t) * table_[k] + t * table_[k + 1];
}

}  // namespace oilskin::effects
