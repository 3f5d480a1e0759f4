#include "support/exact.h"

#include <algorithm>
#include <cmath>

namespace oilskin::exact {
namespace {

// ---- Polynomials with whole coefficients ----

void trim(Polynomial* f) {
  while (!f->empty() && f->back().sign() == 0) f->pop_back();
}

int degree(const Polynomial& f) {
  return static_cast<int>(f.size()) - 1;
}

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

// ---- Roots in [0, 1] ----

/// The number n / 2^k.
struct Dyadic {
  Integer n;
  int k = 0;
};

int sign_at(const Polynomial& f, const Dyadic& t) {
  Integer value;
  for (int i = degree(f); i >= 0; --i) value = value * t.n + (f[i] << (t.k * (degree(f) - i)));
  return value.sign();
}

/// f(x + c) for whole c, by repeated synthetic division.
void shift_argument(Polynomial* f, const Integer& c) {
  for (int i = 0; i < degree(*f); ++i) {
    for (int j = degree(*f) - 1; j >= i; --j) (*f)[j] = (*f)[j] + c * (*f)[j + 1];
  }
}

/// Signs of the Bernstein coefficients of f on [n / 2^k, (n + 1) / 2^k], the last end first.
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

int variations(const std::vector<int>& signs) {
  int count = 0, last = 0;
  for (const int s : signs) {
    if (s == 0) continue;
    if (last != 0 && s != last) ++count;
    last = s;
  }
  return count;
}

/// A real number: the only root of the square-free f in the open interval (n / 2^k, (n + 1) / 2^k), or n /
/// 2^k itself.
struct Root {
  Polynomial f;
  Dyadic at;
  bool dyadic = false;
  int sign_before = 0;

  void refine() {
    const Dyadic middle{(at.n << 1) + Integer(1), at.k + 1};
    const int s = sign_at(f, middle);
    if (s == 0) {
      at = middle;
      dyadic = true;
    } else {
      at = s == sign_before ? middle : Dyadic{at.n << 1, at.k + 1};
    }
  }
};

void isolate(const Polynomial& f, const Dyadic& t, std::vector<Root>* roots) {
  const std::vector<int> signs = bernstein_signs(f, t);
  const int count = variations(signs);
  if (count == 0) return;
  // One variation: exactly one root inside. The sign just after the left end is what refinement compares
  // with; a root at the left end itself has been recorded apart, and the first non-zero coefficient tells the
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

/// All roots in [0, 1] of a polynomial that is not zero.
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

/// Does g, known to share roots with root->f or not, vanish at the root?
bool vanishes(const Polynomial& g, const Root& root) {
  const Polynomial common = common_divisor(root.f, g);
  if (degree(common) < 1) return false;
  // `common` divides f: its only possible root in the interval is this one, and it is simple.
  return variations(bernstein_signs(common, root.at)) % 2 == 1;
}

/// Sign of g at a root; refines the root as far as needed.
int sign_at_root(const Polynomial& g, Root* root) {
  if (g.empty()) return 0;
  bool known_not_zero = false;
  for (int tries = 0;; ++tries) {
    if (root->dyadic) return sign_at(g, root->at);
    const std::vector<int> signs = bernstein_signs(g, root->at);
    const int first = signs.front();
    if (first != 0 && std::all_of(signs.begin(), signs.end(), [&](int s) { return s == first; }))
      return first;
    // The greatest common divisor is dear: first see whether a few bits decide.
    if (tries == 4 && !known_not_zero) {
      if (vanishes(g, *root)) return 0;
      known_not_zero = true;
    }
    for (int i = 0; i < 8 && !root->dyadic; ++i) root->refine();
  }
}

// ---- The query ----

using Vector = std::array<Polynomial, 3>;

Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

Polynomial dot(const Vector& a, const Vector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

Vector minus(const Vector& a, const Vector& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

bool is_zero(const Vector& a) {
  return a[0].empty() && a[1].empty() && a[2].empty();
}

/// The least power of two that makes all numbers whole.
template <class Points>
int whole_shift(const Points& points, int shift = -10000) {
  for (const Point& point : points) {
    for (const double x : point) {
      if (x == 0) continue;
      int exponent = 0;
      std::frexp(x, &exponent);
      shift = std::max(shift, 53 - exponent);
    }
  }
  return shift;
}

/// Everything about the triangle as seen from the point, as polynomials in time.
struct Query {
  std::array<Vector, 3> corner;  // relative to the point
  std::array<Vector, 3> wedge;   // corner i+1 × corner i+2: zero when the point is on that edge's line
  Vector normal;                 // of the triangle, its sum
  Polynomial coplanarity;        // six times the signed volume
};

Query make_query(const Motion& motion) {
  const int shift = std::max(whole_shift(motion.t0), whole_shift(motion.t1));
  Query q;
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) {
      const auto whole = [&](double x) { return Integer::from_double(x, shift); };
      const Integer start = whole(motion.t0[i + 1][k]) - whole(motion.t0[0][k]);
      const Integer end = whole(motion.t1[i + 1][k]) - whole(motion.t1[0][k]);
      q.corner[i][k] = {start, end - start};
      trim(&q.corner[i][k]);
    }
  }
  for (int i = 0; i < 3; ++i) q.wedge[i] = cross(q.corner[(i + 1) % 3], q.corner[(i + 2) % 3]);
  for (int k = 0; k < 3; ++k) q.normal[k] = q.wedge[0][k] + q.wedge[1][k] + q.wedge[2][k];
  q.coplanarity = dot(q.corner[0], q.wedge[0]);
  return q;
}

bool all_zero_at(const Vector& v, Root* root) {
  return std::all_of(v.begin(), v.end(), [&](const Polynomial& f) { return sign_at_root(f, root) == 0; });
}

/// Is the point on the closed edge opposite to corner i?
bool on_edge(const Query& q, int i, Root* root) {
  return all_zero_at(q.wedge[i], root) &&
         sign_at_root(dot(q.corner[(i + 1) % 3], q.corner[(i + 2) % 3]), root) <= 0;
}

/// At a time when the four points are coplanar: is the point in the closed triangle?
bool in_triangle(const Query& q, Root* root) {
  for (int k = 0; k < 3; ++k) {
    const int facing = sign_at_root(q.normal[k], root);
    if (facing == 0) continue;
    // All wedges are multiples of the normal, so one component tells their orientation.
    for (int i = 0; i < 3; ++i) {
      if (sign_at_root(q.wedge[i][k], root) * facing < 0) return false;
    }
    return true;
  }
  return on_edge(q, 0, root) || on_edge(q, 1, root) || on_edge(q, 2, root);
}

void append_roots(const Polynomial& f, std::vector<Root>* events) {
  for (Root& root : roots_of(f)) events->push_back(std::move(root));
}

void append_roots_of_first_component(const Vector& v, std::vector<Root>* events) {
  for (const Polynomial& f : v) {
    if (f.empty()) continue;
    append_roots(f, events);
    return;
  }
}

/// Times at which a first touch can happen when the four points are always coplanar: at the start, or else on
/// an edge, for a point inside was inside just before. On an edge its wedge vanishes; where the wedge
/// vanishes all the time, the touch begins at an end of the edge.
std::vector<Root> coplanar_events(const Query& q) {
  std::vector<Root> events{{{}, Dyadic{0, 0}, true, 0}};
  for (int i = 0; i < 3; ++i) {
    append_roots_of_first_component(q.wedge[i], &events);
    if (!is_zero(q.wedge[i])) continue;
    append_roots_of_first_component(q.corner[(i + 1) % 3], &events);
    append_roots_of_first_component(q.corner[(i + 2) % 3], &events);
  }
  return events;
}

/// The largest double that is not above n / 2^k, for n not negative.
double double_below(const Dyadic& t) {
  const int excess = std::max(0, t.n.bits() - 53);
  const Integer leading = t.n >> excess;
  double value = 0;
  for (int i = leading.bits() - 1; i >= 0; --i) value = 2 * value + (leading.bit(i) ? 1 : 0);
  return std::ldexp(value, excess - t.k);
}

void record_touch(Root root, Answer* answer) {
  constexpr int kFinest = 200;  // bits after the point
  while (!root.dyadic && root.at.k < kFinest) root.refine();
  const double lower = double_below(root.at);
  const bool exact = root.dyadic && root.at.n == Integer::from_double(lower, root.at.k);
  const double upper = exact ? lower : std::nextafter(lower, 2);
  answer->touch_lower = answer->hit ? std::min(answer->touch_lower, lower) : lower;
  answer->touch_upper = answer->hit ? std::min(answer->touch_upper, upper) : upper;
  answer->hit = true;
}

/// Does f change its sign at the root, a time strictly between 0 and 1?
bool changes_sign(const Polynomial& f, const Root& root) {
  if (!root.dyadic) {
    std::vector<int> signs =
        bernstein_signs(f, root.at);  // f may touch the interval's ends: they do not count
    signs.erase(std::remove(signs.begin(), signs.end(), 0), signs.end());
    return signs.front() != signs.back();
  }
  if (root.at.n.sign() == 0 || root.at.n == Integer(1) << root.at.k) return false;
  int multiplicity = 0;
  for (Polynomial g = f; sign_at(g, root.at) == 0; g = derivative(g)) ++multiplicity;
  return multiplicity % 2 == 1;
}

}  // namespace

Answer point_triangle(const Motion& motion) {
  Answer answer;
  const Query q = make_query(motion);
  answer.coplanar = q.coplanarity.empty();
  std::vector<Root> events = answer.coplanar ? coplanar_events(q) : roots_of(q.coplanarity);
  for (Root& root : events) {
    if (!in_triangle(q, &root)) continue;
    answer.crosses = answer.crosses || (!answer.coplanar && changes_sign(q.coplanarity, root));
    record_touch(root, &answer);
  }
  return answer;
}

namespace {

/// Constants of a query at rest: polynomials of degree 0, as plain integers.
Integer constant(const Polynomial& f) {
  return f.empty() ? Integer() : f[0];
}

}  // namespace

bool nearer_than(const Point& p, const Point& a, const Point& b, const Point& c, double limit) {
  const std::array<Point, 4> points{p, a, b, c};
  const Query q = make_query({points, points});
  // make_query scales by 2^shift; the limit's square is scaled alike, by the larger of both needs.
  const int shift = whole_shift(points);
  const int limit_shift = std::max(shift, whole_shift(std::array<Point, 1>{Point{limit, 0, 0}}));
  const Integer scaled_limit = Integer::from_double(limit, limit_shift);
  const Integer square = scaled_limit * scaled_limit;
  // value / scale < limit² with value, scale in the query's units.
  const auto below = [&](const Integer& value, const Integer& scale) {
    return ((value << (2 * (limit_shift - shift))) - square * scale).sign() < 0;
  };
  for (int i = 0; i < 3; ++i) {
    if (below(constant(dot(q.corner[i], q.corner[i])), 1)) return true;
  }
  const auto squared = [](const Vector& v) { return constant(dot(v, v)); };
  for (int i = 0; i < 3; ++i) {  // the edge opposite to corner i, where the foot is between its ends
    const Vector &u = q.corner[(i + 1) % 3], &v = q.corner[(i + 2) % 3], edge = minus(v, u);
    const bool between = constant(dot(u, edge)).sign() < 0 && constant(dot(v, edge)).sign() > 0;
    if (between && below(squared(q.wedge[i]), squared(edge))) return true;
  }
  if (is_zero(q.normal)) return false;
  for (int i = 0; i < 3; ++i) {
    if (constant(dot(q.wedge[i], q.normal)).sign() < 0) return false;
  }
  const Integer volume = constant(q.coplanarity);
  return below(volume * volume, squared(q.normal));
}

}  // namespace oilskin::exact
