#include "ccd/whole_polynomials.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/assert.h"

namespace oilskin::ccd::detail {
namespace {

void trim(Polynomial* f) {
  while (f->degree >= 0 && f->c[f->degree].sign == 0) --f->degree;
}

/// −1 or 1 as a² is certainly less or greater than b² D; 0 where leading bits do not tell.
int compare_leading_bits(const Whole& a, const Whole& b, const Whole& D) {
  const Scaled x = approximation(a), y = approximation(b), z = approximation(D);
  const int difference = 2 * x.exponent - 2 * y.exponent - z.exponent;
  if (difference > 4) return 1;
  if (difference < -6) return -1;
  // Five factors within 2⁻⁵⁰ and a few roundings.
  constexpr double kMargin = 0x1p-46;
  const double ratio =
      std::ldexp(x.mantissa * x.mantissa / (y.mantissa * y.mantissa * z.mantissa), difference);
  return ratio > 1 + kMargin ? 1 : (ratio < 1 - kMargin ? -1 : 0);
}

}  // namespace

RoundedPolynomial::RoundedPolynomial(const Polynomial& f) {
  std::array<Scaled, 4> exact;
  int largest = std::numeric_limits<int>::min();
  for (int i = 0; i <= f.degree; ++i) {
    exact[i] = approximation(f.c[i]);
    if (exact[i].mantissa != 0) largest = std::max(largest, exact[i].exponent);
  }
  for (int i = 0; i <= f.degree; ++i) {
    if (exact[i].mantissa != 0) c[i] = std::ldexp(exact[i].mantissa, exact[i].exponent - largest);
    sum_of_magnitudes += std::abs(c[i]);
  }
}

Polynomial Algebra::linear(const Whole& start, const Whole& end) {
  Polynomial f{{start, difference(end, start)}, 1};
  trim(&f);
  return f;
}

Polynomial Algebra::sum(const Polynomial& f, const Polynomial& g) {
  Polynomial h;
  h.degree = std::max(f.degree, g.degree);
  for (int i = 0; i <= h.degree; ++i) h.c[i] = sum(f.c[i], g.c[i]);
  trim(&h);
  return h;
}

Polynomial Algebra::difference(const Polynomial& f, const Polynomial& g) {
  Polynomial minus = g;
  for (Whole& a : minus.c) a = negated(a);
  return sum(f, minus);
}

Polynomial Algebra::product(const Polynomial& f, const Polynomial& g) {
  Polynomial h;
  if (f.degree < 0 || g.degree < 0) return h;
  h.degree = f.degree + g.degree;
  OILSKIN_ASSERT(h.degree <= 3);
  for (int i = 0; i <= f.degree; ++i) {
    for (int j = 0; j <= g.degree; ++j) h.c[i + j] = sum(h.c[i + j], product(f.c[i], g.c[j]));
  }
  return h;
}

Polynomial Algebra::derivative(const Polynomial& f) {
  Polynomial g;
  g.degree = std::max(f.degree - 1, -1);
  for (int i = 0; i <= g.degree; ++i) g.c[i] = multiple(f.c[i + 1], i + 1);
  return g;
}

Surd Algebra::fraction(const Whole& numerator, const Whole& denominator) {
  OILSKIN_ASSERT(denominator.sign != 0 || workspace_.exhausted());
  const bool flip = denominator.sign < 0;
  return {flip ? negated(numerator) : numerator, flip ? negated(denominator) : denominator, {}, 1};
}

SurdRoots Algebra::roots_of(const Polynomial& q) {
  OILSKIN_ASSERT(q.degree == 1 || q.degree == 2);
  SurdRoots roots;
  if (q.degree == 1) {
    roots.at[0] = fraction(negated(q.c[0]), q.c[1]);
    roots.count = 1;
    return roots;
  }
  const Whole D = difference(product(q.c[1], q.c[1]), multiple(product(q.c[2], q.c[0]), 4));
  if (D.sign < 0) return roots;
  Surd root = fraction(negated(q.c[1]), multiple(q.c[2], 2));
  root.D = D;
  roots.count = D.sign == 0 ? 1 : 2;
  root.side = -1;
  roots.at[0] = root;
  root.side = 1;
  roots.at[1] = root;
  return roots;
}

/// Sign of a + b (± √D), the surd's root.
int Algebra::sign_of_sum(const Whole& a, const Whole& b, const Surd& s) {
  const int root_sign = s.D.sign * s.side * b.sign;
  if (root_sign == 0 || root_sign == a.sign) return a.sign;
  if (a.sign == 0) return root_sign;
  int order = compare_leading_bits(a, b, s.D);
  if (order == 0) order = compare_magnitudes(product(a, a), product(product(b, b), s.D));
  return order > 0 ? a.sign : (order < 0 ? root_sign : 0);
}

/// Rounded arithmetic decides most: with S the sum of the coefficients' magnitudes, the computed value is
/// wrong by 2⁻⁴⁹ S from the coefficients, by |f′| 2⁻⁴⁷ ≤ 3 · 2⁻⁴⁷ S from the time, and by 6 · 2⁻⁵³ S from the
/// three steps of Horner's rule.
int Algebra::sign_at(const Polynomial& f, const Surd& t) {
  const RoundedPolynomial rounded(f);
  const double value = rounded.at(estimate(t)), error = 0x1p-45 * rounded.sum_of_magnitudes;
  if (std::abs(value) > error) return value > 0 ? 1 : -1;
  return exact_sign_at(f, t);
}

/// Horner's rule for dⁿ f(t) = a + b (± √D), which has the sign of f.
int Algebra::exact_sign_at(const Polynomial& f, const Surd& t) {
  const Workspace::Scope scope(&workspace_);
  if (f.degree < 0) return 0;
  Whole a = f.c[f.degree], b, power = t.d;
  for (int i = f.degree - 1; i >= 0; --i) {
    const Whole next = sum(sum(product(a, t.p), product(b, t.D)), product(f.c[i], power));
    b = sum(product(b, t.p), a);
    a = next;
    if (i > 0) power = product(power, t.d);
  }
  return sign_of_sum(a, b, t);
}

int Algebra::compare_with_fraction(const Surd& s, const Surd& t) {
  OILSKIN_ASSERT(t.D.sign == 0);
  const Workspace::Scope scope(&workspace_);
  // (p ± √D) t.d − t.p d
  return sign_of_sum(difference(product(s.p, t.d), product(t.p, s.d)), t.d, s);
}

/// p, d, D, and p² − D are known within 2⁻⁵⁰ relative, and nothing below cancels: the result is within 2⁻⁴⁸.
double Algebra::estimate(const Surd& t) {
  const Workspace::Scope scope(&workspace_);
  const Scaled p = approximation(t.p), d = approximation(t.d), D = approximation(t.D);
  const int exponent =
      std::max(t.p.sign == 0 ? D.exponent / 2 : p.exponent, t.D.sign == 0 ? p.exponent : D.exponent / 2);
  const double sum = std::ldexp(p.mantissa, p.exponent - exponent);
  const double root = t.side * std::sqrt(std::ldexp(D.mantissa, D.exponent - 2 * exponent));
  double value;
  if (sum * root >= 0) {
    value = std::ldexp((sum + root) / d.mantissa, exponent - d.exponent);
  } else {  // where the two would cancel: (p² − D) / (p ∓ √D)
    const Scaled n = approximation(difference(product(t.p, t.p), t.D));
    value = std::ldexp(n.mantissa / (d.mantissa * (sum - root)), n.exponent - d.exponent - exponent);
  }
  OILSKIN_ASSERT(value >= 0 && value <= 1 + 0x1p-47);
  return std::min(value, 1.0);
}

}  // namespace oilskin::ccd::detail
