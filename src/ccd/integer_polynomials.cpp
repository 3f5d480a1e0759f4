#include "ccd/integer_polynomials.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/assert.h"

namespace oilskin::ccd::detail {
namespace {

/// −1 or 1 if a² is certainly less or greater than b² D; 0 if the leading bits do not decide.
int compare_leading_bits(const BigInteger& a, const BigInteger& b, const BigInteger& D) {
  const Scaled x = approximation(a), y = approximation(b), z = approximation(D);
  const int difference = 2 * x.exponent - 2 * y.exponent - z.exponent;
  if (difference > 4) return 1;
  if (difference < -6) return -1;
  // Five factors within 2⁻⁵⁰ and a few roundings.
  constexpr double margin = 0x1p-46;
  const double ratio = scaled(x.mantissa * x.mantissa / (y.mantissa * y.mantissa * z.mantissa), difference);
  return ratio > 1 + margin ? 1 : (ratio < 1 - margin ? -1 : 0);
}

}  // namespace

RoundedPolynomial::RoundedPolynomial(const Polynomial& f) {
  std::array<Scaled, 4> exact;
  int max_exponent = std::numeric_limits<int>::min();
  for (int i = 0; i <= f.degree; ++i) {
    exact[i] = approximation(f.c[i]);
    if (exact[i].mantissa != 0) max_exponent = std::max(max_exponent, exact[i].exponent);
  }
  for (int i = 0; i <= f.degree; ++i) {
    if (exact[i].mantissa != 0) c_[i] = scaled(exact[i].mantissa, exact[i].exponent - max_exponent);
    sum_of_magnitudes_ += std::abs(c_[i]);
    max_slope_ += i * std::abs(c_[i]);
  }
}

/// With S the sum of the coefficients' magnitudes, the error of the value computed for the middle is 2⁻⁴⁹ S
/// from the coefficients, |f′| 2⁻⁴⁷ ≤ 3 · 2⁻⁴⁷ S from the approximate ends, and 6 · 2⁻⁵³ S from the three
/// steps of Horner's rule; the rest of 2⁻⁴⁵ S covers the roundings of the middle and of the slope.
int RoundedPolynomial::sign_between(double from, double to) const {
  const double value = at(0.5 * (from + to));
  const double error = 0x1p-45 * sum_of_magnitudes_ + 0.5 * (to - from) * max_slope_;
  return value > error ? 1 : (value < -error ? -1 : 0);
}

Polynomial Algebra::sum(const Polynomial& f, const Polynomial& g) {
  std::array<BigInteger, 4> terms;
  for (int i = 0; i < 4; ++i) terms[i] = sum(f.c[i], g.c[i]);
  return Polynomial(terms);
}

Polynomial Algebra::derivative(const Polynomial& f) {
  Polynomial g;
  g.degree = std::max(f.degree - 1, -1);
  for (int i = 0; i <= g.degree; ++i) g.c[i] = multiple(f.c[i + 1], i + 1);
  return g;
}

/// Horner's rule in s.
Polynomial Algebra::reparametrised(const Polynomial& f, const BigInteger& start, const BigInteger& width,
                                   const BigInteger& d) {
  if (f.degree < 0) return {};
  std::array<BigInteger, 4> c{f.c[f.degree]};
  BigInteger power = d;
  for (int i = f.degree - 1; i >= 0; --i) {
    for (int k = f.degree - i; k > 0; --k) c[k] = sum(product(c[k], start), product(c[k - 1], width));
    c[0] = sum(product(c[0], start), product(f.c[i], power));
    if (i > 0) power = product(power, d);
  }
  return Polynomial(c);
}

Surd Algebra::fraction(const BigInteger& numerator, const BigInteger& denominator) {
  OILSKIN_ASSERT(denominator.sign != 0 || workspace_.exhausted());
  const bool flip = denominator.sign < 0;
  Surd t{flip ? negated(numerator) : numerator, flip ? negated(denominator) : denominator, {}, 1, 0};
  t.approximate = estimate(t, {});
  return t;
}

SurdRoots Algebra::roots_of(const Polynomial& q) {
  OILSKIN_ASSERT(q.degree == 1 || q.degree == 2);
  SurdRoots roots;
  if (q.degree == 1) {
    roots.at[0] = fraction(negated(q.c[0]), q.c[1]);
    roots.count = 1;
    return roots;
  }
  const BigInteger norm = multiple(product(q.c[2], q.c[0]), 4);
  const BigInteger D = difference(product(q.c[1], q.c[1]), norm);
  if (D.sign < 0) return roots;
  Surd root = fraction(negated(q.c[1]), multiple(q.c[2], 2));
  root.D = D;
  roots.count = D.sign == 0 ? 1 : 2;
  for (int i = 0; i < 2; ++i) {
    root.side = i == 0 ? -1 : 1;
    root.approximate = estimate(root, norm);
    roots.at[i] = root;
  }
  return roots;
}

/// Sign of a + b (± √D) with the square root of the surd (T.15).
int Algebra::sign_of_sum(const BigInteger& a, const BigInteger& b, const Surd& s) {
  const int root_sign = s.D.sign * s.side * b.sign;
  if (root_sign == 0 || root_sign == a.sign) return a.sign;
  if (a.sign == 0) return root_sign;
  int order = compare_leading_bits(a, b, s.D);
  if (order == 0) order = compare_magnitudes(product(a, a), product(product(b, b), s.D));
  return order > 0 ? a.sign : (order < 0 ? root_sign : 0);
}

int Algebra::sign_at(const Function& f, const Surd& t) {
  OILSKIN_ASSERT(t.approximate >= -0x1p-47 && t.approximate <= 1 + 0x1p-46);
  const int sign = f.rounded.sign_between(t.approximate, t.approximate);
  return sign != 0 ? sign : exact_sign_at(f.exact, t);
}

/// Horner's rule for dⁿ f(t) = a + b (± √D) (T.14), which has the sign of f.
int Algebra::exact_sign_at(const Polynomial& f, const Surd& t) {
  const Workspace::Scope scope(&workspace_);
  if (f.degree < 0) return 0;
  BigInteger a = f.c[f.degree], b, power = t.d;
  for (int i = f.degree - 1; i >= 0; --i) {
    const BigInteger next = sum(sum(product(a, t.p), product(b, t.D)), product(f.c[i], power));
    b = sum(product(b, t.p), a);
    a = next;
    if (i > 0) power = product(power, t.d);
  }
  return sign_of_sum(a, b, t);
}

int Algebra::compare_with_fraction(const Surd& s, const Surd& t) {
  OILSKIN_ASSERT(t.D.sign == 0);
  const double margin = 0x1p-45 * (std::abs(s.approximate) + std::abs(t.approximate)) + 0x1p-1000;
  if (s.approximate < t.approximate - margin) return -1;
  if (s.approximate > t.approximate + margin) return 1;
  const Workspace::Scope scope(&workspace_);
  // (p ± √D) t.d − t.p d
  return sign_of_sum(difference(product(s.p, t.d), product(t.p, s.d)), t.d, s);
}

/// p, d, D and norm = p² − D are accurate to 2⁻⁵⁰ relative, and nothing below cancels, so the result is
/// accurate to 2⁻⁴⁸.
double Algebra::estimate(const Surd& t, const BigInteger& norm) {
  const Scaled p = approximation(t.p), d = approximation(t.d), D = approximation(t.D);
  if (t.D.sign == 0) return scaled(p.mantissa / d.mantissa, p.exponent - d.exponent);
  const int exponent = t.p.sign == 0 ? D.exponent / 2 : std::max(p.exponent, D.exponent / 2);
  const double sum = scaled(p.mantissa, p.exponent - exponent);
  const double root = t.side * std::sqrt(scaled(D.mantissa, D.exponent - 2 * exponent));
  if (sum * root >= 0) return scaled((sum + root) / d.mantissa, exponent - d.exponent);
  // p ± √D would cancel: use (p² − D) / (p ∓ √D).
  const Scaled n = approximation(norm);
  return scaled(n.mantissa / (d.mantissa * (sum - root)), n.exponent - d.exponent - exponent);
}

}  // namespace oilskin::ccd::detail
