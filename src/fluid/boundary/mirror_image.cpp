#include "fluid/boundary/mirror_image.h"

#include "fluid/lattice.h"

namespace oilskin::fluid {

MirrorImage::MirrorImage(double support_ratio) {
  // Bisection: d ln λ/dζ grows with a.
  const double mass = lattice_mass_beyond<CubicSpline>(support_ratio), z = 0.5 / support_ratio;
  const double slope = settled_pull * 2 * lattice_pull_beyond<CubicSpline>(support_ratio) / mass;
  double low = 0.5, high = 0.999 / z;
  for (int k = 0; k < 60; ++k) {
    const double offset = 0.5 * (low + high);
    (offset * plane_integral_slope(offset * z) < slope * plane_integral(offset * z) ? low : high) = offset;
  }
  offset_ = static_cast<float>(low);
  mass_ = static_cast<float>(mass / plane_integral(low * z));
  const double slot = 0.5,
               wall = static_cast<double>(lambda(static_cast<float>(slot / 2 / support_ratio), 1));
  both_ = static_cast<float>(settled_slot * (2 * wall + lattice_layer<CubicSpline>(support_ratio, slot) - 1) /
                             (wall * wall));
}

}  // namespace oilskin::fluid
