#include "effects/viscosity/wall_drag.h"

namespace oilskin::effects {

namespace {

constexpr int table_size = 128;

/// The integrals of (V.5) by Simpson's rule, up to a factor that both share.
WallDrag::Share half_space_integrals(const fluid::ViscousWeights& weights, double zeta) {
  constexpr int intervals = 256;
  const double step = (1 - zeta) / intervals, z2 = zeta * zeta;
  WallDrag::Share sum;
  for (int k = 0; k <= intervals; ++k) {
    const double q = zeta + k * step, q2 = q * q;
    const double factor = k == 0 || k == intervals ? 1 : k % 2 == 1 ? 4 : 2;
    const double shell = factor * viscous_shape(weights, q) * q * step / 3;
    sum.along += shell * (q2 - z2) * (q2 - z2);
    sum.across += 2 * shell * (q2 * q2 - z2 * z2);
  }
  return sum;
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
    table_.push_back(half_space_integrals(weights, static_cast<double>(k) / table_size));
  Share layers;  // of a lattice, the first half a spacing off
  for (int k = 0; k + 0.5 < ratio; ++k) {
    const Share at = (*this)((k + 0.5) / ratio);
    layers.along += 2 / ratio * at.along;
    layers.across += 2 / ratio * at.across;
  }
  for (Share& s : table_) {  // (V.6)
    s.along /= layers.along;
    s.across *= 3 / layers.across;
  }
}

WallDrag::Share WallDrag::operator()(double zeta) const {
  if (!(zeta < 1)) return {};
  const double at = std::max(0.0, zeta) * table_size;
  const auto k = std::min(static_cast<std::size_t>(at), static_cast<std::size_t>(table_size - 1));
  const double t = at - static_cast<double>(k);
  const Share &a = table_[k], &b = table_[k + 1];
  return {(1 - t) * a.along + t * b.along, (1 - t) * a.across + t * b.across};
}

}  // namespace oilskin::effects
