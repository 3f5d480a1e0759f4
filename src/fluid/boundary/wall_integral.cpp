#include "fluid/boundary/wall_integral.h"

#include <cmath>

#include "core/assert.h"
#include "core/simd.h"
#include "fluid/kernels.h"

namespace oilskin::fluid {

namespace {

using simd::F4;

// Gauss–Legendre on [−1, 1] with 4 nodes, and with 8.
alignas(16) constexpr float abscissa[] = {-0.861136312f, -0.339981044f, 0.339981044f,  0.861136312f,
                                          -0.960289856f, -0.796666477f, -0.525532410f, -0.183434642f,
                                          0.183434642f,  0.525532410f,  0.796666477f,  0.960289856f};
alignas(16) constexpr float gauss_weight[] = {0.347854845f, 0.652145155f, 0.652145155f, 0.347854845f,
                                              0.101228536f, 0.222381034f, 0.313706646f, 0.362683783f,
                                              0.362683783f, 0.313706646f, 0.222381034f, 0.101228536f};

/// Λ (B.1) of four distances.
F4 half_space_mass(F4 z) {
  const F4 u = simd::larger(F4(1.0f) - z, F4(0.0f)), v = simd::larger(F4(0.5f) - z, F4(0.0f));
  const F4 u2 = u * u, v2 = v * v;
  return F4(8.0f / 15) * (u2 * u2 * u * (F4(1.0f) + F4(2.0f) * z) - v2 * v2 * v * (F4(2.0f) + F4(8.0f) * z));
}

/// The angle of (x, y) from the first axis, y ≥ 0, not both 0, to the precision of float. Not std::atan2,
/// whose last bits depend on the C library: this has the same bits everywhere. The angle is halved twice, so
/// that the series converges by 0.17 a term.
float angle_of(double x, double y) {
  const double length = std::sqrt(x * x + y * y);
  const double half = y / (length + std::abs(x));  // tangent of half the angle from ±x, 0 … 1
  const double t = half / (1 + std::sqrt(1 + half * half)), t2 = t * t;
  double series = 0;
  for (int k = 21; k >= 1; k -= 2) series = 1.0 / k - t2 * series;
  const double angle = 4 * t * series;
  return static_cast<float>(x < 0 ? pi - angle : angle);
}

/// Angle between (d, a) and (d, b) as seen from the origin, a ≤ b, d > 0.
float angle_between(float d, float a, float b) {
  return angle_of(d * d + a * b, d * (b - a));
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
  // The integrand varies over a length of √(d² + ζ²): 4 nodes are enough on an edge that is short beside it.
  const bool is_short = half * half < 0.25f * (d * d + z * z);
  F4 mass(0.0f);
  for (int k = is_short ? 0 : 4; k < (is_short ? 4 : 12); k += 4) {
    const F4 t = F4(middle) + F4(half) * simd::load(abscissa + k), square = t * t + F4(d * d);
    const F4 r = simd::root(F4(z * z) + square);
    mass += simd::load(gauss_weight + k) * (F4(mass_at_z) * r - F4(z) * half_space_mass(r)) / (square * r);
  }
  return outside * mass_at_z + half * d * simd::total(mass);
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
  const float z = plane.distance(), mass_at_z = fluid::half_space_mass(z);
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
