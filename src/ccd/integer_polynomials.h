/// Polynomials in time with integer coefficients, and the roots of those of degree two. Internal to the
/// module.
#pragma once

#include <array>

#include "ccd/big_integer.h"

namespace oilskin::ccd::detail {

/// Degree at most three, constant term first; degree −1 is zero.
struct Polynomial {
  std::array<BigInteger, 4> c;
  int degree = -1;

  Polynomial() = default;
  /// Constant term first. Zeros at the end do not count for the degree.
  template <std::size_t Count>
  explicit Polynomial(const std::array<BigInteger, Count>& terms);

  int leading_sign() const { return degree < 0 ? 0 : c[degree].sign; }
};

template <std::size_t Count>
Polynomial::Polynomial(const std::array<BigInteger, Count>& terms) {
  static_assert(Count <= 4, "degree at most three");
  for (std::size_t i = 0; i < Count; ++i) {
    c[i] = terms[i];
    if (terms[i].sign != 0) degree = static_cast<int>(i);
  }
}

/// The time (p ± √D) / d with d > 0 and D ≥ 0 (T.13).
struct Surd {
  BigInteger p, d, D;
  int side = 1;            ///< the sign before the square root
  double approximate = 0;  ///< the time within 2⁻⁴⁷ relative, or 2⁻¹⁰⁷⁴
};

/// Distinct real roots in ascending order.
struct SurdRoots {
  std::array<Surd, 2> at;
  int count = 0;
};

/// A polynomial scaled by a positive factor, with coefficients within 2⁻⁴⁹ relative (or 2⁻¹⁰⁷⁴ of the
/// largest).
class RoundedPolynomial {
 public:
  RoundedPolynomial() = default;
  explicit RoundedPolynomial(const Polynomial& f);

  double at(double t) const { return ((c_[3] * t + c_[2]) * t + c_[1]) * t + c_[0]; }
  /// The sign of the polynomial if it is certain and constant within 2⁻⁴⁷ of [from, to] ⊂ [0, 1]; else 0.
  int sign_between(double from, double to) const;

 private:
  std::array<double, 4> c_{};
  double sum_of_magnitudes_ = 0, max_slope_ = 0;
};

/// A polynomial prepared for the evaluation of signs.
struct Function {
  Polynomial exact;
  RoundedPolynomial rounded;

  Function() = default;
  explicit Function(const Polynomial& f) : exact(f), rounded(f) {}
};

/// Exact arithmetic in a workspace.
class Algebra {
 public:
  explicit Algebra(Workspace* workspace) : workspace_(*workspace) {}

  Polynomial sum(const Polynomial& f, const Polynomial& g);
  Polynomial derivative(const Polynomial& f);
  /// d^degree f((start + width s) / d), a polynomial in s.
  Polynomial reparametrised(const Polynomial& f, const BigInteger& start, const BigInteger& width,
                            const BigInteger& d);

  Surd fraction(const BigInteger& numerator, const BigInteger& denominator);
  /// For degree one or two.
  SurdRoots roots_of(const Polynomial& q);
  /// For t in [0, 1].
  int sign_at(const Function& f, const Surd& t);
  /// −1, 0 or 1 if s is less than, equal to or greater than the fraction t.
  int compare_with_fraction(const Surd& s, const Surd& t);

 private:
  BigInteger sum(const BigInteger& a, const BigInteger& b) { return workspace_.sum(a, b); }
  BigInteger difference(const BigInteger& a, const BigInteger& b) { return workspace_.difference(a, b); }
  BigInteger product(const BigInteger& a, const BigInteger& b) { return workspace_.product(a, b); }
  BigInteger multiple(const BigInteger& a, int factor) { return product(a, workspace_.small(factor)); }
  int sign_of_sum(const BigInteger& a, const BigInteger& b, const Surd& s);
  int exact_sign_at(const Polynomial& f, const Surd& t);
  double estimate(const Surd& t, const BigInteger& norm);

  Workspace& workspace_;
};

}  // namespace oilskin::ccd::detail
