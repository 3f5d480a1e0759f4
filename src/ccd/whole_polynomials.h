/// Polynomials in time with whole coefficients, and the roots of those of degree two: what the exact answer
/// is made of. Internal to the room.
#pragma once

#include <array>

#include "ccd/whole_numbers.h"

namespace oilskin::ccd::detail {

/// Degree at most three, constant term first; degree −1 is zero.
struct Polynomial {
  std::array<Whole, 4> c;
  int degree = -1;

  int leading_sign() const { return degree < 0 ? 0 : c[degree].sign; }
};

/// The time (p ± √D) / d with d > 0 and D ≥ 0.
struct Surd {
  Whole p, d, D;
  int side = 1;  ///< the sign before the root
};

/// Different real roots in ascending order.
struct SurdRoots {
  std::array<Surd, 2> at;
  int count = 0;
};

/// The coefficients by a common factor, within 2⁻⁴⁹ relative (or 2⁻¹⁰⁷⁴ of the largest), and the sum of their
/// magnitudes.
struct RoundedPolynomial {
  std::array<double, 4> c{};
  double sum_of_magnitudes = 0;

  explicit RoundedPolynomial(const Polynomial& f);
  double at(double t) const { return ((c[3] * t + c[2]) * t + c[1]) * t + c[0]; }
};

/// Exact arithmetic in a workspace.
class Algebra {
 public:
  explicit Algebra(Workspace* workspace) : workspace_(*workspace) {}

  /// From its values at 0 and 1.
  Polynomial linear(const Whole& start, const Whole& end);
  Polynomial sum(const Polynomial& f, const Polynomial& g);
  Polynomial difference(const Polynomial& f, const Polynomial& g);
  Polynomial product(const Polynomial& f, const Polynomial& g);
  Polynomial derivative(const Polynomial& f);

  Surd fraction(const Whole& numerator, const Whole& denominator);
  /// Of a polynomial of degree one or two.
  SurdRoots roots_of(const Polynomial& q);
  /// For t in [0, 1].
  int sign_at(const Polynomial& f, const Surd& t);
  /// −1, 0, 1 as s is less than, equal to or greater than the fraction t.
  int compare_with_fraction(const Surd& s, const Surd& t);
  /// Within 2⁻⁴⁷ of t, which must lie in [0, 1].
  double estimate(const Surd& t);

 private:
  Whole sum(const Whole& a, const Whole& b) { return workspace_.sum(a, b); }
  Whole difference(const Whole& a, const Whole& b) { return workspace_.difference(a, b); }
  Whole product(const Whole& a, const Whole& b) { return workspace_.product(a, b); }
  Whole multiple(const Whole& a, int factor) { return product(a, workspace_.small(factor)); }
  int sign_of_sum(const Whole& a, const Whole& b, const Surd& s);
  int exact_sign_at(const Polynomial& f, const Surd& t);

  Workspace& workspace_;
};

}  // namespace oilskin::ccd::detail
