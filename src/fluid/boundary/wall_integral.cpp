#include "fluid/boundary/wall_integral.h"

#include <cmath>

#include "core/assert.h"
#include "fluid/kernels.h"

namespace oilskin::fluid {

namespace {

// Gauss–Legendre on [−1, 1].
constexpr int nodes = 6;
constexpr float abscissa[nodes] = {-0.932469514f, -0.661209386f, -0.238619186f,
                                   0.238619186f,  0.661209386f,  0.932469514f};
constexpr float gauss_weight[nodes] = {0.171324492f, 0.360761573f, 0.467913935f,
                                       0.467913935f, 0.360761573f, 0.171324492f};

/// Angle between (d, a) and (d, b) as seen from the origin, a ≤ b, d > 0.
float angle_between(float d, float a, float b) {
  return std::atan2(d * (b - a), d * d + a * b);
}

/// ∫ [Λ(ζ) − ζ Λ(r)/r] dϕ along an edge from t = a to b > a, whose line passes the foot at the distance d >
/// 0. With dϕ = d dt/(d² + t²) the integrand is smooth in t; beyond r = 1 it is constant, and the integral is
/// an angle.
float edge_integral(float z, float mass_at_z, float d, float a, float b) {
  const float reach2 = 1 - z * z - d * d;
  const float reach = reach2 > 0 ? std::sqrt(reach2) : 0;
  const float low = std::clamp(a, -reach, reach), high = std::clamp(b, -reach, reach);
  if (!(high > low)) return mass_at_z * angle_between(d, a, b);
  float outside = 0;
  if (a < low) outside += angle_between(d, a, low);
  if (b > high) outside += angle_between(d, high, b);
  const float middle = 0.5f * (low + high), half = 0.5f * (high - low);
  float mass = 0;
  for (int k = 0; k < nodes; ++k) {
    const float t = middle + half * abscissa[k], square = t * t + d * d;
    const float r = std::sqrt(z * z + square);
    mass += gauss_weight[k] / square * (mass_at_z - z * half_space_mass(r) / r);
  }
  return outside * mass_at_z + half * d * mass;
}

}  // namespace

WallPlane::WallPlane(const std::array<Eigen::Vector3f, 3>& x) {
  const Eigen::Vector3f cross = (x[1] - x[0]).cross(x[2] - x[0]);
  const float area2 = cross.norm();
  const float longest =
      std::max({(x[1] - x[0]).squaredNorm(), (x[2] - x[0]).squaredNorm(), (x[2] - x[1]).squaredNorm()});
  if (!(area2 > 1e-6f * longest)) return;
  normal = cross / area2;
  offset = normal.dot(x[0]);
}

float shadow_of(const WallPlane& plane, Span<const Eigen::Vector3f> polygon) {
  const float z = plane.distance(), mass_at_z = half_space_mass(z);
  float sum = 0;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Eigen::Vector3f &u = polygon[k], &v = polygon[k + 1 < polygon.size() ? k + 1 : 0];
    const Eigen::Vector3f along = (v - u).normalized();
    const float d = -u.dot(plane.normal.cross(along));  // > 0: the foot lies on the inner side of the edge
    if (d == 0) continue;
    const float edge = edge_integral(z, mass_at_z, std::abs(d), u.dot(along), v.dot(along));
    sum += d > 0 ? edge : -edge;
  }
  return sum;
}

WallView view_with_shadow(const WallPlane& plane, float shadow) {
  WallView view;
  const float mass = static_cast<float>(2 * pi) * half_space_mass(plane.distance());
  OILSKIN_ASSERT(plane.acts() && mass > 0);
  view.distance = plane.distance();
  view.share = std::clamp(shadow / mass, 0.0f, 1.0f);
  view.normal = plane.to_particle();
  return view;
}

WallView view_of_wall(const std::array<Eigen::Vector3f, 3>& corners) {
  const WallPlane plane(corners);
  return plane.acts() ? view_with_shadow(plane, shadow_of(plane, {corners.data(), 3})) : WallView();
}

}  // namespace oilskin::fluid
