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
}

}  // namespace oilskin::fluid
