/// Smoothing kernels in three dimensions with support radius H (F.1): W(r) = c w(q), W'(r) = (c/H) w'(q), q =
/// r/H and c = norm/H³. The shapes w take any scalar with + − * / and larger(): double, F4 or
/// F8. They are 0 for
/// q ≥ 1 without a branch.
#pragma once

#include <algorithm>

#include "core/simd.h"

namespace oilskin::fluid {

using simd::larger;  // for double, where no argument names the namespace

constexpr double pi = 3.14159265358979323846;

/// Lower bound of q in denominators: the force of pairs closer than 1e-6 H falls to 0 with r, and coincident
/// particles exert none.
constexpr float min_q = 1e-6f;

/// [Mueller2003] Eq. 20.
struct Poly6 {
  static constexpr double norm = 315 / (64 * pi);
  template <class T>
  static T w(T q) {
    const T u = larger(T(1) - q * q, T(0));
    return u * u * u;
  }
  template <class T>
  static T dw_over_q(T q) {
    const T u = larger(T(1) - q * q, T(0));
    return T(-6) * u * u;
  }
  /// H²/c times the Laplacian.
  template <class T>
  static T laplacian(T q) {
    return T(-6) * larger(T(1) - q * q, T(0)) * (T(3) - T(7) * q * q);
  }
};

/// [Desbrun1996]; [Mueller2003] Eq. 21.
struct Spiky {
  static constexpr double norm = 15 / pi;
  template <class T>
  static T w(T q) {
    const T u = larger(T(1) - q, T(0));
    return u * u * u;
  }
  template <class T>
  static T dw_over_q(T q) {
    const T u = larger(T(1) - q, T(0));
    return T(-3) * u * u / larger(q, T(min_q));
  }
};

/// [Mueller2003] Eq. 22. W is infinite at 0; only the Laplacian is used.
struct ViscosityKernel {
  static constexpr double norm = 15 / (2 * pi);
  template <class T>
  static T w(T q) {
    // Equal to −q³/2 + q² + 1/(2q) − 1, which cancels near q = 1.
    const T u = larger(T(1) - q, T(0));
    return u * u * u * (T(1) + q) / (T(2) * larger(q, T(min_q)));
  }
  template <class T>
  static T dw_over_q(T q) {
    // w' = −3q²/2 + 2q − 1/(2q²) = −(1−q)² (3q² + 2q + 1)/(2q²)
    const T u = larger(T(1) - q, T(0)), s = larger(q, T(min_q));
    return T(-1) * u * u * (T(3) * q * q + T(2) * q + T(1)) / (T(2) * s * s * s);
  }
  template <class T>
  static T laplacian(T q) {
    return T(6) * larger(T(1) - q, T(0));
  }
};

/// [Monaghan1992]: w = 6(q³−q²)+1 for q ≤ ½ and 2(1−q)³ above, both as 2(1−q)³₊ − 8(½−q)³₊ (F.3).
struct CubicSpline {
  static constexpr double norm = 8 / pi;
  template <class T>
  static T w(T q) {
    const T u = larger(T(1) - q, T(0)), v = larger(T(0.5f) - q, T(0));
    return T(2) * u * u * u - T(8) * v * v * v;
  }
  template <class T>
  static T dw_over_q(T q) {
    const T u = larger(T(1) - q, T(0)), v = larger(T(0.5f) - q, T(0));
    return (T(24) * v * v - T(6) * u * u) / larger(q, T(min_q));
  }
};

/// [Wendland1995] C².
struct WendlandC2 {
  static constexpr double norm = 21 / (2 * pi);
  template <class T>
  static T w(T q) {
    const T u = larger(T(1) - q, T(0));
    return u * u * u * u * (T(1) + T(4) * q);
  }
  template <class T>
  static T dw_over_q(T q) {
    const T u = larger(T(1) - q, T(0));
    return T(-20) * u * u * u;
  }
  /// The integral over a plane at the distance ζ [supports], with the norm.
  static double plane(double z) {
    const double u = std::max(1 - z, 0.0);
    return u * u * u * u * u * (21 - u * (31.5 - 12 * u));
  }
};

/// [Wendland1995] C⁴.
struct WendlandC4 {
  static constexpr double norm = 495 / (32 * pi);
  template <class T>
  static T w(T q) {
    const T u = larger(T(1) - q, T(0)), u2 = u * u;
    return u2 * u2 * u2 * (T(1) + T(6) * q + T(35.0 / 3) * q * q);
  }
  template <class T>
  static T dw_over_q(T q) {
    const T u = larger(T(1) - q, T(0)), u2 = u * u;
    return T(-56.0 / 3) * (T(1) + T(5) * q) * u2 * u2 * u;
  }
};

/// W(r) and W'(r) with their dimensions [1/m³, 1/m⁴].
template <class Kernel>
double kernel_value(double r, double support_radius) {
  const double h = support_radius;
  return Kernel::norm / (h * h * h) * Kernel::w(r / h);
}
template <class Kernel>
double kernel_slope(double r, double support_radius) {
  const double h = support_radius, q = r / h;
  return Kernel::norm / (h * h * h * h) * q * Kernel::dw_over_q(q);
}

}  // namespace oilskin::fluid
