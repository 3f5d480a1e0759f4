#include "support/exact.h"

#include <algorithm>
#include <cmath>

#include "support/exact_polynomial.h"

namespace oilskin::exact {
namespace {

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
    // All wedges are multiples of the normal, so one component has their orientation.
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
