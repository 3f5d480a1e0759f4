/// Velocities and displacements at the start of volumes.
#include <cmath>

#include "core/assert.h"
#include "fluid/kernels.h"
#include "oilskin/emitter.h"

namespace oilskin {

VectorField linear_field(const Vec3& origin, const Eigen::Matrix3d& gradient) {
  return [origin, gradient](const Vec3& x) -> Vec3 { return gradient * (x - origin); };
}

VectorField rotation_field(const Vec3& origin, const Vec3& axis, double rate) {
  const Vec3 spin = rate * axis.stableNormalized();
  return [origin, spin](const Vec3& x) -> Vec3 { return spin.cross(x - origin); };
}

/// (F.69)
VectorField taylor_green_field(const Vec3& corner, const Vec3& edge_u, const Vec3& edge_v, double amplitude) {
  const double pi = fluid::pi, lu = edge_u.stableNorm(), lv = edge_v.stableNorm();
  const Vec3 u = edge_u / lu, v = edge_v / lv;
  return [=](const Vec3& x) -> Vec3 {
    const double a = pi * (x - corner).dot(u) / lu, b = pi * (x - corner).dot(v) / lv;
    return amplitude * (std::sin(a) * std::cos(b) * u - lv / lu * std::cos(a) * std::sin(b) * v);
  };
}

/// (F.70), with exponentials that do not overflow in deep water.
VectorField standing_wave_field(const StandingWave& w) {
  const Vec3 along = w.along.stableNormalized(), up = w.up.stableNormalized();
  const double k = 2 * fluid::pi / w.wavelength;
  return [=](const Vec3& x) -> Vec3 {
    const double s = k * (x - w.origin).dot(along), z = (x - w.origin).dot(up);
    const double rising = std::exp(k * (z - w.depth)), falling = std::exp(-k * (z + w.depth));
    const double scale = w.amplitude / (1 - std::exp(-2 * k * w.depth));
    return scale * ((rising - falling) * std::cos(s) * up - (rising + falling) * std::sin(s) * along);
  };
}

}  // namespace oilskin
