#include "support/exact_polynomial.h"

#include <algorithm>

namespace oilskin::exact {

void trim(Polynomial* f) {
  while (!f->empty() && f->back().sign() == 0) f->pop_back();
}

namespace {

int degree(const Polynomial& f) {
  return static_cast<int>(f.size()) - 1;
}

}  // namespace

Polynomial operator+(const Polynomial& f, const Polynomial& g) {
  Polynomial sum(std::max(f.size(), g.size()));
  for (std::size_t i = 0; i < sum.size(); ++i) {
    sum[i] = (i < f.size() ? f[i] : Integer()) + (i < g.size() ? g[i] : Integer());
  }
  trim(&sum);
  return sum;
}

Polynomial operator-(const Polynomial& f, const Polynomial& g) {
  Polynomial difference(std::max(f.size(), g.size()));
  for (std::size_t i = 0; i < difference.size(); ++i) {
    difference[i] = (i < f.size() ? f[i] : Integer()) - (i < g.size() ? g[i] : Integer());
  }
  trim(&difference);
  return difference;
}

Polynomial operator*(const Polynomial& f, const Polynomial& g) {
  if (f.empty() || g.empty()) return {};
  Polynomial product(f.size() + g.size() - 1);
  for (std::size_t i = 0; i < f.size(); ++i) {
    for (std::size_t j = 0; j < g.size(); ++j) product[i + j] = product[i + j] + f[i] * g[j];
  }
  trim(&product);
  return product;
}

Polynomial derivative(const Polynomial& f) {
  Polynomial result;
  for (std::size_t i = 1; i < f.size(); ++i) result.push_back(f[i] * Integer(static_cast<std::int64_t>(i)));
  return result;
}

namespace {

/// Takes out the common power of two, which keeps numbers short without division.
Polynomial without_common_twos(Polynomial f) {
  int twos = -1;
  for (const Integer& a : f) {
    if (a.sign() != 0) twos = twos < 0 ? a.trailing_zeros() : std::min(twos, a.trailing_zeros());
  }
  if (twos > 0) {
    for (Integer& a : f) a = a >> twos;
  }
  return f;
}

/// Divides up to a constant factor: m f = q g + r with deg r < deg g. Returns r; the quotient if asked for.
Polynomial pseudo_remainder(Polynomial f, const Polynomial& g, Polynomial* quotient = nullptr) {
  Polynomial q(f.size() >= g.size() ? f.size() - g.size() + 1 : 0);
  while (!f.empty() && f.size() >= g.size()) {
    const std::size_t shift = f.size() - g.size();
    const Integer lead = f.back();
    for (Integer& a : f) a = a * g.back();
    for (Integer& a : q) a = a * g.back();
    q[shift] = q[shift] + lead;
    for (std::size_t i = 0; i < g.size(); ++i) f[i + shift] = f[i + shift] - lead * g[i];
    trim(&f);
  }
  if (quotient != nullptr) {
    trim(&q);
    *quotient = without_common_twos(q);
  }
  return without_common_twos(f);
}

/// Greatest common divisor, up to a constant factor.
Polynomial common_divisor(Polynomial f, Polynomial g) {
  while (!g.empty()) {
    Polynomial rest = pseudo_remainder(f, g);
    f = std::move(g);
    g = std::move(rest);
  }
  return without_common_twos(f);
}

Polynomial square_free(const Polynomial& f) {
  const Polynomial repeated = common_divisor(f, derivative(f));
  if (degree(repeated) < 1) return without_common_twos(f);
  Polynomial quotient;
  pseudo_remainder(f, repeated, &quotient);
  return quotient;
}

}  // namespace

int sign_at(const Polynomial& f, const Dyadic& t) {
  Integer value;
  for (int i = degree(f); i >= 0; --i) value = value * t.n + (f[i] << (t.k * (degree(f) - i)));
  return value.sign();
}

namespace {

/// f(x + c) for whole c, by repeated synthetic division.
void shift_argument(Polynomial* f, const Integer& c) {
  for (int i = 0; i < degree(*f); ++i) {
    for (int j = degree(*f) - 1; j >= i; --j) (*f)[j] = (*f)[j] + c * (*f)[j + 1];
  }
}

}  // namespace

std::vector<int> bernstein_signs(const Polynomial& f, const Dyadic& t) {
  Polynomial local = f;
  const int n = degree(f);
  for (int i = 0; i <= n; ++i) local[i] = local[i] << (t.k * (n - i));
  shift_argument(&local, t.n);  // now the interval is [0, 1]
  std::reverse(local.begin(), local.end());
  shift_argument(&local, 1);  // (1 + x)^n f(1 / (1 + x)): the Bernstein coefficients times binomials
  std::vector<int> signs;
  for (const Integer& a : local) signs.push_back(a.sign());
  return signs;
}

namespace {

int variations(const std::vector<int>& signs) {
  int count = 0, last = 0;
  for (const int s : signs) {
    if (s == 0) continue;
    if (last != 0 && s != last) ++count;
    last = s;
  }
  return count;
}

}  // namespace

void Root::refine() {
  const Dyadic middle{(at.n << 1) + Integer(1), at.k + 1};
  const int s = sign_at(f, middle);
  if (s == 0) {
    at = middle;
    dyadic = true;
  } else {
    at = s == sign_before ? middle : Dyadic{at.n << 1, at.k + 1};
  }
}

namespace {

void isolate(const Polynomial& f, const Dyadic& t, std::vector<Root>* roots) {
  const std::vector<int> signs = bernstein_signs(f, t);
  const int count = variations(signs);
  if (count == 0) return;
  // One variation: exactly one root inside. The sign just after the left end is what refinement compares
  // with; a root at the left end itself has been recorded apart, and the first non-zero coefficient has the
  // sign.
  if (count == 1 && signs.back() != 0) {
    roots->push_back({f, t, false, signs.back()});
    return;
  }
  const Dyadic left{t.n << 1, t.k + 1}, right{left.n + Integer(1), t.k + 1};
  isolate(f, left, roots);
  if (sign_at(f, right) == 0) roots->push_back({f, right, true, 0});
  isolate(f, right, roots);
}

}  // namespace

std::vector<Root> roots_of(const Polynomial& polynomial) {
  std::vector<Root> roots;
  if (degree(polynomial) < 1) return roots;
  const Polynomial f = square_free(polynomial);
  const Dyadic zero{0, 0}, one{1, 0};
  if (sign_at(f, zero) == 0) roots.push_back({f, zero, true, 0});
  isolate(f, zero, &roots);
  if (sign_at(f, one) == 0) roots.push_back({f, one, true, 0});
  return roots;
}

namespace {

/// Does g, known to share roots with root->f or not, vanish at the root?
bool vanishes(const Polynomial& g, const Root& root) {
  const Polynomial common = common_divisor(root.f, g);
  if (degree(common) < 1) return false;
  // `common` divides f: its only possible root in the interval is this one, and it is simple.
  return variations(bernstein_signs(common, root.at)) % 2 == 1;
}

}  // namespace

int sign_at_root(const Polynomial& g, Root* root) {
  if (g.empty()) return 0;
  bool known_not_zero = false;
  for (int tries = 0;; ++tries) {
    if (root->dyadic) return sign_at(g, root->at);
    const std::vector<int> signs = bernstein_signs(g, root->at);
    const int first = signs.front();
    if (first != 0 && std::all_of(signs.begin(), signs.end(), [&](int s) { return s == first; }))
      return first;
    // The greatest common divisor is costly: first see whether a few bits decide.
    if (tries == 4 && !known_not_zero) {
      if (vanishes(g, *root)) return 0;
      known_not_zero = true;
    }
    for (int i = 0; i < 8 && !root->dyadic; ++i) root->refine();
  }
}

}  // namespace oilskin::exact
