/// Exact results for tests: every finite double is an integer times a power of two, so a query of the path or
/// of a distance can be decided without rounding. Slow, and on purpose another route than src/ccd: it shares
/// no code with the library and no method but the cubic of coplanarity itself.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace oilskin::exact {

using Point = std::array<double, 3>;

/// An integer of any size: sign and magnitude, 32 bits a limb, least significant first.
class Integer {
 public:
  Integer() = default;
  Integer(std::int64_t value);  // NOLINT: implicit, as for the built-in types
  /// mantissa · 2^shift of a finite double; `shift` must make it whole.
  static Integer from_double(double value, int shift);

  int sign() const { return magnitude_.empty() ? 0 : (negative_ ? -1 : 1); }
  int bits() const;            ///< length of the magnitude
  int trailing_zeros() const;  ///< of the magnitude; 0 for zero
  bool bit(int i) const;

  Integer operator-() const;
  Integer operator+(const Integer& other) const;
  Integer operator-(const Integer& other) const;
  Integer operator*(const Integer& other) const;
  Integer operator<<(int count) const;
  Integer operator>>(int count) const;  ///< of the magnitude, towards zero
  bool operator==(const Integer& other) const;

 private:
  static int compare_magnitudes(const Integer& a, const Integer& b);
  static Integer add_magnitudes(const Integer& a, const Integer& b);
  static Integer subtract_magnitudes(const Integer& larger, const Integer& smaller);
  void trim();

  std::vector<std::uint32_t> magnitude_;
  bool negative_ = false;
};

/// A polynomial in time with whole coefficients, constant term first, without leading zeros. Empty is zero.
using Polynomial = std::vector<Integer>;

/// The point p and the corners a, b, c at t = 0 and at t = 1; all move linearly.
struct Motion {
  std::array<Point, 4> t0;
  std::array<Point, 4> t1;
};

struct Answer {
  bool hit = false;       ///< the closed paths touch for some t in [0, 1]
  bool coplanar = false;  ///< the four points lie in one plane all the time
  bool crosses =
      false;  ///< at one of the touches the point changes sides of the plane (not in coplanar motion)
  /// Nearest doubles around the time of first touch; equal where it is a double itself. Only with `hit`.
  double touch_lower = 1;
  double touch_upper = 1;
};

/// The exact result, for any finite input: coplanar motion, segments, points, touching.
Answer point_triangle(const Motion& motion);

/// Is the distance of the point from the closed triangle less than `limit` (not negative)? Exact for any
/// finite input.
bool nearer_than(const Point& p, const Point& a, const Point& b, const Point& c, double limit);

}  // namespace oilskin::exact
