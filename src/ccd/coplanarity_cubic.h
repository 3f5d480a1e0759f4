/// The cubic whose roots are the times at which a moving point lies in the plane of a moving triangle
/// [Provot1997] (T.3), in Bernstein form on [0, 1] (T.4), with a bound of its rounding error (T.6). Internal
/// to the module.
#pragma once

#include "ccd/separation.h"

namespace oilskin::ccd::detail {

/// The four Bernstein coefficients of the cubic on an interval.
struct Coefficients {
  double k[4];
};

class CoplanarityCubic {
 public:
  CoplanarityCubic(const PointTriangleMotion& m, const RelativeMotion& relative);

  /// False if a product may have underflowed or overflowed: the error bound does not hold.
  bool bounded() const { return bounded_; }
  /// Bounds the error of a computed value and of a computed coefficient on any interval.
  double error() const { return error_; }
  /// +1 or −1 if a computed coefficient or value has a certain sign, else 0.
  int sign(double value) const { return value > error_ ? 1 : (value < -error_ ? -1 : 0); }

  const Coefficients& coefficients() const { return on_step_; }
  Coefficients on(const TimeSpan& span) const;
  double value(double t) const;
  double value_and_slope(double t, double* slope) const;

 private:
  Coefficients on_step_;
  double error_ = 0;
  bool bounded_ = false;
};

/// Narrows an interval at whose ends the cubic has certain, opposite signs, and keeps this property.
TimeSpan narrow_crossing(const CoplanarityCubic& cubic, TimeSpan bracket);

}  // namespace oilskin::ccd::detail
