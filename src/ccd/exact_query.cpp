#include "ccd/exact_query.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <tuple>

#include "ccd/integer_polynomials.h"
#include "ccd/relative_polynomials.h"
#include "core/assert.h"

// Coordinates become integers, axis by axis (scaling an axis moves no contact), and functions of time become
// polynomials with integer coefficients. The four points are coplanar at the roots of a cubic f. A simple
// root of f is not computed: only the signs of quadratics q (areas) at the root are needed, and these follow
// from the position of the roots of q, surds (p ± √D) / d, relative to the extrema of f, and from the sign of
// f there. So every decision is the sign of a number a + b √D (T.14) with integers a, b, D, at worst that of
// a² − b² D (T.15): a bounded number of products and sums.

namespace oilskin::ccd::detail {
namespace {

using PolynomialVector = std::array<Polynomial, 3>;

/// A big integer with the workspace that stores the results of its operators.
struct BoundBigInteger {
  BigInteger value;
  Workspace* workspace;
};
BoundBigInteger operator+(const BoundBigInteger& a, const BoundBigInteger& b) {
  return {a.workspace->sum(a.value, b.value), a.workspace};
}
BoundBigInteger operator-(const BoundBigInteger& a, const BoundBigInteger& b) {
  return {a.workspace->difference(a.value, b.value), a.workspace};
}
BoundBigInteger operator*(const BoundBigInteger& a, const BoundBigInteger& b) {
  return {a.workspace->product(a.value, b.value), a.workspace};
}

#ifdef OILSKIN_CCD_WIDE_INTEGERS
/// Finite numbers divided by a common power of two: integers below 2¹²⁴, so that no later sum overflows.
/// False if their exponents differ too much.
template <std::size_t Count>
bool to_wide(const std::array<double, Count>& x, std::array<WideInteger<2>, Count>* wide) {
  constexpr int max_shift = 124 - 53;
  std::array<Decomposed, Count> parts;
  int min_exponent = 2000, max_exponent = -2000;
  for (std::size_t i = 0; i < Count; ++i) {
    parts[i] = decompose(x[i]);
    if (parts[i].mantissa == 0) continue;
    min_exponent = std::min(min_exponent, parts[i].exponent);
    max_exponent = std::max(max_exponent, parts[i].exponent);
  }
  if (max_exponent - min_exponent > max_shift) return false;
  for (std::size_t i = 0; i < Count; ++i) {
    const bool zero = parts[i].mantissa == 0;
    (*wide)[i] = wide_from(parts[i].mantissa, zero ? 0 : parts[i].exponent - min_exponent, x[i] < 0);
  }
  return true;
}
#endif

/// A time at which the point is in the triangle's plane: a known surd, or the only root of the cubic between
/// the breaks `piece` and `piece` + 1, where it changes sign.
struct Coplanarity {
  bool known = false;
  Surd at;
  int piece = 0;
};

/// A value that is computed at its first use.
template <class Value>
struct Lazy {
  bool known = false;
  Value value;
};

/// Times of impact are multiples of 1 / grid_steps.
constexpr double grid_steps = 0x1p52;
/// time_error exceeds the error of Surd::approximate for times of the step. Times whose approximations differ
/// by more than time_margin are different.
constexpr double time_error = 0x1p-46, time_margin = 0x1p-45;

/// Times in units of 1 / grid_steps. `low` is not after a root, `high` is after it.
struct GridSpan {
  double low = 0, high = 0;
};

class ExactQuery {
 public:
  ExactQuery(const PointTriangleMotion& m, Workspace* workspace);

  Impact first_impact(const TimeSpan& span, bool time_matters);

 private:
  BigInteger integer(double x) { return workspace_.from_double(x, 0); }
  Surd at_grid_time(double time) { return algebra_.fraction(integer(time), integer(grid_steps)); }
  void set_span(const TimeSpan& span);
  Impact first_of_cubic(bool time_matters);
  void find_breaks();
  int extrema_before(const Surd& t, bool* at_extremum);
  int compare_with(const Coplanarity& root, const Surd& t);
  int sign_at(const Coplanarity& root, const Function& q);

  Impact first_of_flat_motion();
  void impact_at_roots(const Polynomial& q, Impact* first);
  bool impact_at_roots_of_first_component(const PolynomialVector& v, Impact* first);

  void set_big_corners(const PointTriangleMotion& m);
  bool set_wide_corners(const PointTriangleMotion& m);
  template <class N>
  void set_cubic(const RelativeCorners<N>& corner);
  template <class Terms>
  Polynomial polynomial(const Terms& terms);
  template <class Make>
  Polynomial with_corners(Make make);
  const Function& area(int corner, int axis);
  const Polynomial& corner(int corner, int axis);
  PolynomialVector corner(int corner);
  bool inside(const Coplanarity& root);
  bool inside_segment(const Coplanarity& root);

  double estimate(const Coplanarity& root);
  double rounded_down(const Coplanarity& root);
  double bracketed(const Coplanarity& root, double guess);
  void narrow(const Coplanarity& root, GridSpan* span);
  bool not_after(double grid_time, const Coplanarity& root);

  Workspace& workspace_;
  Algebra algebra_;
  Surd begin_, end_;  // the part of the step that is examined
  // The corners relative to the point, in wide integers where they fit, else in big integers.
  bool wide_ = false;
#ifdef OILSKIN_CCD_WIDE_INTEGERS
  RelativeCorners<WideInteger<2>> wide_corner_;
#endif
  RelativeCorners<BoundBigInteger> big_corner_;
  std::array<std::array<Lazy<Polynomial>, 3>, 3> corner_;
  std::array<std::array<Lazy<Function>, 3>, 3> area_;
  Function cubic_, slope_;
  Lazy<Function> curvature_;
  // begin_, the extrema of the cubic in between, end_. Between two breaks the cubic is monotone.
  std::array<Surd, 4> break_;
  std::array<int, 4> sign_at_break_{};
  int breaks_ = 0;
  int extrema_at_or_before_start_ = 0;
};

std::array<const Vec3*, 8> points_of(const PointTriangleMotion& m) {
  return {&m.p_t0, &m.a_t0, &m.b_t0, &m.c_t0, &m.p_t1, &m.a_t1, &m.b_t1, &m.c_t1};
}

/// Motion of the corners relative to the point along an axis; x: the coordinates of all points at both ends.
template <class N>
void set_axis(const std::array<N, 8>& x, int axis, RelativeCorners<N>* corner) {
  for (int i = 0; i < 3; ++i) {
    const N start = x[1 + i] - x[0];
    (*corner)[i][axis] = {start, (x[5 + i] - x[4]) - start};
  }
}

ExactQuery::ExactQuery(const PointTriangleMotion& m, Workspace* workspace)
    : workspace_(*workspace), algebra_(workspace) {
  wide_ = set_wide_corners(m);
  if (!wide_) set_big_corners(m);
}

void ExactQuery::set_big_corners(const PointTriangleMotion& m) {
  const std::array<const Vec3*, 8> points = points_of(m);
  for (int k = 0; k < 3; ++k) {
    int exponent = 1024;
    for (const Vec3* x : points) {
      if ((*x)[k] != 0) exponent = std::min(exponent, decompose((*x)[k]).exponent);
    }
    std::array<BoundBigInteger, 8> x;
    for (int i = 0; i < 8; ++i) x[i] = {workspace_.from_double((*points[i])[k], exponent), &workspace_};
    set_axis(x, k, &big_corner_);
  }
  set_cubic(big_corner_);
}

/// False if coordinates of an axis differ too much in magnitude.
bool ExactQuery::set_wide_corners(const PointTriangleMotion& m) {
#ifdef OILSKIN_CCD_WIDE_INTEGERS
  const std::array<const Vec3*, 8> points = points_of(m);
  for (int k = 0; k < 3; ++k) {
    std::array<double, 8> x;
    for (int i = 0; i < 8; ++i) x[i] = (*points[i])[k];
    std::array<WideInteger<2>, 8> wide;
    if (!to_wide(x, &wide)) return false;
    set_axis(wide, k, &wide_corner_);
  }
  set_cubic(wide_corner_);
  return true;
#else
  static_cast<void>(m);
  return false;
#endif
}

template <class N>
void ExactQuery::set_cubic(const RelativeCorners<N>& corner) {
  const std::array areas{area_of(corner, 0, 0), area_of(corner, 0, 1), area_of(corner, 0, 2)};
  for (int k = 0; k < 3; ++k) area_[0][k] = {true, Function(polynomial(areas[k]))};
  cubic_ = Function(polynomial(volume_of(corner[0], areas)));
  slope_ = Function(algebra_.derivative(cubic_.exact));
}

BigInteger to_big(const BoundBigInteger& a, Workspace*) {
  return a.value;
}
#ifdef OILSKIN_CCD_WIDE_INTEGERS
template <int N>
BigInteger to_big(const WideInteger<N>& a, Workspace* workspace) {
  return workspace->from_wide(a);
}
#endif

template <class Terms>
Polynomial ExactQuery::polynomial(const Terms& terms) {
  std::array<BigInteger, std::tuple_size<Terms>::value> coefficients;
  for (std::size_t i = 0; i < coefficients.size(); ++i) coefficients[i] = to_big(terms[i], &workspace_);
  return Polynomial(coefficients);
}

/// Calls `make` with the corners in the kind of integer that is used.
template <class Make>
Polynomial ExactQuery::with_corners(Make make) {
#ifdef OILSKIN_CCD_WIDE_INTEGERS
  if (wide_) return make(wide_corner_);
#endif
  return make(big_corner_);
}

/// Lazy, because one axis is enough in most queries.
const Function& ExactQuery::area(int corner, int axis) {
  Lazy<Function>& area = area_[corner][axis];
  if (!area.known) {
    OILSKIN_ASSERT(!workspace_.in_scope());
    area = {true, Function(with_corners(
                      [&](const auto& corners) { return polynomial(area_of(corners, corner, axis)); }))};
  }
  return area.value;
}

const Polynomial& ExactQuery::corner(int corner, int axis) {
  Lazy<Polynomial>& result = corner_[corner][axis];
  if (!result.known) {
    OILSKIN_ASSERT(!workspace_.in_scope());
    result = {true, with_corners([&](const auto& corners) {
                const auto& x = corners[corner][axis];
                return polynomial(std::array{x.start, x.slope});
              })};
  }
  return result.value;
}

PolynomialVector ExactQuery::corner(int corner) {
  return {this->corner(corner, 0), this->corner(corner, 1), this->corner(corner, 2)};
}

Impact ExactQuery::first_impact(const TimeSpan& span, bool time_matters) {
  set_span(span);
  if (cubic_.exact.degree < 0) return first_of_flat_motion();
  return first_of_cubic(time_matters);
}

/// Rounds `span` outwards to the grid.
void ExactQuery::set_span(const TimeSpan& span) {
  begin_ = at_grid_time(std::floor(span.begin * grid_steps));
  end_ = at_grid_time(std::ceil(span.end * grid_steps));
}

// ---- Times of coplanarity ----

void ExactQuery::find_breaks() {
  breaks_ = 0;
  extrema_at_or_before_start_ = 0;
  break_[breaks_++] = begin_;
  if (slope_.exact.degree >= 1 && slope_.rounded.sign_between(begin_.approximate, end_.approximate) == 0) {
    const SurdRoots stationary = algebra_.roots_of(slope_.exact);
    // A double root of the slope is not an extremum.
    const int extrema = slope_.exact.degree == 2 && stationary.count == 1 ? 0 : stationary.count;
    for (int i = 0; i < extrema; ++i) {
      if (algebra_.compare_with_fraction(stationary.at[i], begin_) <= 0) {
        ++extrema_at_or_before_start_;
      } else if (algebra_.compare_with_fraction(stationary.at[i], end_) < 0) {
        break_[breaks_++] = stationary.at[i];
      }
    }
  }
  break_[breaks_++] = end_;
  if (breaks_ > 2 && !curvature_.known) curvature_ = {true, Function(algebra_.derivative(slope_.exact))};
  for (int i = 0; i < breaks_; ++i) sign_at_break_[i] = algebra_.sign_at(cubic_, break_[i]);
}

/// The number of extrema of the cubic on (−∞, t), from the signs of slope and curvature at t.
int ExactQuery::extrema_before(const Surd& t, bool* at_extremum) {
  const int lead = slope_.exact.leading_sign(), slope = algebra_.sign_at(slope_, t) * lead;
  *at_extremum = slope == 0;
  if (slope_.exact.degree == 1) return slope > 0 ? 1 : 0;
  if (slope < 0) return 1;
  const bool left = algebra_.sign_at(curvature_.value, t) * lead < 0;
  if (slope == 0) return left ? 0 : 1;
  return left ? 0 : 2;
}

/// −1, 0 or 1 if t is before, at or after the root.
int ExactQuery::compare_with(const Coplanarity& root, const Surd& t) {
  OILSKIN_ASSERT(!root.known);
  const Surd &from = break_[root.piece], &to = break_[root.piece + 1];
  if (t.approximate < from.approximate - time_margin) return -1;
  if (t.approximate > to.approximate + time_margin) return 1;
  if (t.approximate < from.approximate + time_margin || t.approximate > to.approximate - time_margin) {
    if (algebra_.compare_with_fraction(t, begin_) <= 0) return -1;
    if (algebra_.compare_with_fraction(t, end_) >= 0) return 1;
    if (breaks_ > 2) {
      bool at_extremum = false;
      const int piece = extrema_before(t, &at_extremum) - extrema_at_or_before_start_;
      if (at_extremum) return piece < root.piece ? -1 : 1;
      if (piece != root.piece) return piece < root.piece ? -1 : 1;
    }
  }
  const int sign = algebra_.sign_at(cubic_, t);
  return sign == 0 ? 0 : (sign == sign_at_break_[root.piece] ? -1 : 1);
}

/// The sign of q, of degree two at most, at the root.
int ExactQuery::sign_at(const Coplanarity& root, const Function& q) {
  if (root.known) return algebra_.sign_at(q, root.at);
  const int lead = q.exact.leading_sign();
  if (q.exact.degree < 1) return lead;
  const int rounded =
      q.rounded.sign_between(break_[root.piece].approximate, break_[root.piece + 1].approximate);
  if (rounded != 0) return rounded;
  const Workspace::Scope scope(&workspace_);
  const SurdRoots zeros = algebra_.roots_of(q.exact);
  // From the last zero to the first: after the last zero q has the sign `lead`. Its sign changes at each zero
  // unless the zero is double.
  int sign = lead;
  for (int i = zeros.count - 1; i >= 0; --i) {
    const int order = compare_with(root, zeros.at[i]);
    if (order == 0) return 0;
    if (order < 0) return sign;
    if (zeros.count == q.exact.degree) sign = -sign;
  }
  return sign;
}

Impact ExactQuery::first_of_cubic(bool time_matters) {
  find_breaks();
  for (int i = 0; i < breaks_; ++i) {
    const Coplanarity at_break{true, break_[i], i}, between{false, {}, i};
    if (sign_at_break_[i] == 0 && inside(at_break)) {
      return {true, time_matters ? rounded_down(at_break) : begin_.approximate};
    }
    if (i + 1 < breaks_ && sign_at_break_[i] * sign_at_break_[i + 1] < 0 && inside(between)) {
      return {true, time_matters ? rounded_down(between) : begin_.approximate};
    }
  }
  return {};
}

// ---- Coplanar motion ----

/// In coplanar motion a first touch after the start is on an edge, since a point inside was inside just
/// before. The area of that edge vanishes there. If it vanishes all the time, one end of the edge reaches the
/// point.
Impact ExactQuery::first_of_flat_motion() {
  std::array<PolynomialVector, 3> areas, corners;
  for (int i = 0; i < 3; ++i) corners[i] = corner(i);
  for (int i = 0; i < 3; ++i) areas[i] = {area(i, 0).exact, area(i, 1).exact, area(i, 2).exact};
  if (inside({true, begin_, 0})) return {true, begin_.approximate};
  Impact first;
  for (int i = 0; i < 3; ++i) {
    if (!impact_at_roots_of_first_component(areas[i], &first)) {
      impact_at_roots_of_first_component(corners[(i + 1) % 3], &first);
      impact_at_roots_of_first_component(corners[(i + 2) % 3], &first);
    }
  }
  return first;
}

/// False if v is zero at all times.
bool ExactQuery::impact_at_roots_of_first_component(const PolynomialVector& v, Impact* first) {
  for (const Polynomial& q : v) {
    if (q.degree < 0) continue;
    impact_at_roots(q, first);
    return true;
  }
  return false;
}

void ExactQuery::impact_at_roots(const Polynomial& q, Impact* first) {
  if (q.degree < 1) return;
  const Workspace::Scope scope(&workspace_);
  const SurdRoots roots = algebra_.roots_of(q);
  for (int i = 0; i < roots.count; ++i) {
    const Coplanarity root{true, roots.at[i], 0};
    const bool in_step = algebra_.compare_with_fraction(root.at, begin_) >= 0 &&
                         algebra_.compare_with_fraction(root.at, end_) <= 0;
    if (!in_step || (first->hit && not_after(first->time * grid_steps, root)) || !inside(root)) continue;
    *first = {true, rounded_down(root)};
  }
}

// ---- The triangle ----

/// Is the point, which is in the triangle's plane at this time, in the closed triangle? The areas are
/// multiples of the normal, so one non-zero component decides whether they have the normal's direction.
bool ExactQuery::inside(const Coplanarity& root) {
  for (int k = 0; k < 3; ++k) {
    const int normal = sign_at(
        root, Function(algebra_.sum(area(0, k).exact, algebra_.sum(area(1, k).exact, area(2, k).exact))));
    if (normal == 0) continue;
    for (int i = 0; i < 3; ++i) {
      if (sign_at(root, area(i, k)) * normal < 0) return false;
    }
    return true;
  }
  return inside_segment(root);
}

/// The same for a triangle that is a segment or a point: the point is on its line and within its box.
bool ExactQuery::inside_segment(const Coplanarity& root) {
  for (int k = 0; k < 3; ++k) {
    int signs = 0;
    for (int i = 0; i < 3; ++i) {
      if (sign_at(root, area(i, k)) != 0) return false;
      signs += sign_at(root, Function(corner(i, k)));
    }
    if (signs == 3 || signs == -3) return false;
  }
  return true;
}

// ---- The time of touch ----

/// Approximates the root by rounded arithmetic.
double ExactQuery::estimate(const Coplanarity& root) {
  if (root.known) return std::min(std::max(root.at.approximate, 0.0), 1.0);
  double before = break_[root.piece].approximate, after = break_[root.piece + 1].approximate;
  while (after - before > 1 / grid_steps) {
    const double t = 0.5 * (before + after);
    (cubic_.rounded.at(t) * sign_at_break_[root.piece] > 0 ? before : after) = t;
  }
  return before;
}

bool ExactQuery::not_after(double grid_time, const Coplanarity& root) {
  const Workspace::Scope scope(&workspace_);
  const Surd t = at_grid_time(grid_time);
  return root.known ? algebra_.compare_with_fraction(root.at, t) >= 0 : compare_with(root, t) <= 0;
}

/// A multiple of 2⁻⁵² that is certainly not after the root, and close to it.
double ExactQuery::rounded_down(const Coplanarity& root) {
  const double guess = std::floor(estimate(root) * grid_steps);
  double time = guess;
  if (!root.known) {
    time = bracketed(root, guess);
  } else if (!not_after(guess, root)) {
    time = std::max(guess - time_error * grid_steps, 0.0);
  }
  OILSKIN_ASSERT(time >= 0 && time <= grid_steps);
  return time / grid_steps;
}

/// A grid time not after the root and within wide_span of it, if the guess is. The guess may be bad: close to
/// multiple roots the rounded cubic is inaccurate.
double ExactQuery::bracketed(const Coplanarity& root, double guess) {
  constexpr double wide_span = 4096;
  GridSpan span{std::max(std::floor((break_[root.piece].approximate - time_error) * grid_steps), 0.0),
                std::ceil((break_[root.piece + 1].approximate + time_error) * grid_steps)};
  const auto cut_at = [&](double time) { (not_after(time, root) ? span.low : span.high) = time; };
  for (double reach = 1; span.low < guess - reach; reach *= 64) cut_at(guess - reach);
  for (double reach = 1; guess + reach < span.high; reach *= 64) cut_at(guess + reach);
  while (span.high - span.low > wide_span) {
    const double width = span.high - span.low;
    narrow(root, &span);
    if (span.high - span.low > 0.5 * width) cut_at(std::floor(0.5 * (span.low + span.high)));
  }
  if (span.low < guess && guess < span.high) cut_at(guess);
  return span.low;
}

/// On the span, reparametrised to [0, 1], the cubic has coefficients as large as its values. So its rounded
/// form decides for most times of the span on which side of the root they are.
void ExactQuery::narrow(const Coplanarity& root, GridSpan* span) {
  const double first = std::max(span->low,
                                std::ceil((break_[root.piece].approximate + time_margin) * grid_steps)),
               last = std::min(span->high,
                               std::floor((break_[root.piece + 1].approximate - time_margin) * grid_steps));
  if (!(first < last)) return;
  const Workspace::Scope scope(&workspace_);
  const RoundedPolynomial cubic(
      algebra_.reparametrised(cubic_.exact, integer(first), integer(last - first), integer(grid_steps)));
  const int before = sign_at_break_[root.piece];
  const auto sign_at = [&](double time) {
    const double t = (time - first) / (last - first);
    return cubic.sign_between(t, t);
  };
  // The last time that is certainly before the root, the first that is certainly after it.
  for (const int sign : {before, -before}) {
    double known = sign == before ? first : last, unknown = sign == before ? last : first;
    if (sign_at(known) != sign) continue;
    while (std::abs(unknown - known) > 1) {
      const double middle = std::floor(0.5 * (known + unknown));
      (sign_at(middle) == sign ? known : unknown) = middle;
    }
    (sign == before ? span->low : span->high) = known;
  }
}

bool finite(const PointTriangleMotion& m) {
  return m.p_t0.allFinite() && m.a_t0.allFinite() && m.b_t0.allFinite() && m.c_t0.allFinite() &&
         m.p_t1.allFinite() && m.a_t1.allFinite() && m.b_t1.allFinite() && m.c_t1.allFinite();
}

}  // namespace

Impact exact_impact(const PointTriangleMotion& m) {
  if (!finite(m)) return {true, 0};
  Workspace workspace;
  ExactQuery query(m, &workspace);
  const Impact impact = query.first_impact({0, 1}, true);
  OILSKIN_ASSERT(!workspace.exhausted());
  return workspace.exhausted() ? Impact{true, 0} : impact;
}

Impact exact_impact_from(const PointTriangleMotion& m, const TimeSpan& first) {
  if (!finite(m)) return {true, 0};
  Workspace workspace;
  ExactQuery query(m, &workspace);
  Impact impact = query.first_impact(first, false);
  if (!impact.hit && first.end < 1) impact = query.first_impact({first.end, 1}, true);
  OILSKIN_ASSERT(!workspace.exhausted());
  return workspace.exhausted() ? Impact{true, 0} : impact;
}

#ifdef OILSKIN_CCD_WIDE_INTEGERS
ExactLocation exact_location(const PointTriangleMotion& m, int end) {
  const std::array<const Vec3*, 8> points = points_of(m);
  std::array<std::array<WideInteger<2>, 3>, 3> corner;
  for (int k = 0; k < 3; ++k) {
    std::array<double, 4> x;
    for (int i = 0; i < 4; ++i) x[i] = (*points[4 * end + i])[k];
    std::array<WideInteger<2>, 4> wide;
    if (!to_wide(x, &wide)) return ExactLocation::unknown;
    for (int i = 0; i < 3; ++i) corner[i][k] = wide[1 + i] - wide[0];
  }
  const auto area = [&corner](int opposite, int axis) {
    const auto &u = corner[(opposite + 1) % 3], &v = corner[(opposite + 2) % 3];
    const int x = (axis + 1) % 3, y = (axis + 2) % 3;
    return u[x] * v[y] - u[y] * v[x];
  };
  const std::array<WideInteger<4>, 3> first{area(0, 0), area(0, 1), area(0, 2)};
  // The cubic has the sign of the point's height above the triangle. This determinant has that of a corner's
  // height above the point, hence the minus.
  const int side = -(corner[0][0] * first[0] + corner[0][1] * first[1] + corner[0][2] * first[2]).sign();
  if (side != 0) return side > 0 ? ExactLocation::positive_side : ExactLocation::negative_side;
  for (int k = 0; k < 3; ++k) {
    const WideInteger<4> second = area(1, k), third = area(2, k);
    const int normal = (first[k] + second + third).sign();
    if (normal == 0) continue;
    const bool inside =
        first[k].sign() * normal >= 0 && second.sign() * normal >= 0 && third.sign() * normal >= 0;
    return inside ? ExactLocation::inside : ExactLocation::outside;
  }
  return ExactLocation::unknown;
}
#else
ExactLocation exact_location(const PointTriangleMotion&, int) {
  return ExactLocation::unknown;
}
#endif

}  // namespace oilskin::ccd::detail
