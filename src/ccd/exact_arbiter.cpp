#include "ccd/exact_arbiter.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "ccd/whole_polynomials.h"
#include "core/assert.h"

// The method. Coordinates become whole numbers, axis by axis (scaling an axis moves no contact), and
// functions of time polynomials with whole coefficients. The four points are coplanar at the roots of a cubic
// F. A simple root of F is not computed: all that is asked of it are the signs of quadratics q (barycentric
// numerators), and these follow from where the roots of q, numbers (p ± √D) / d, lie among the extrema of F
// and what sign F has there. So every decision is the sign of a number a + b √D with whole a, b, D, at worst
// that of a² − b² D: a bounded number of products and sums.

namespace oilskin::ccd::detail {
namespace {

using PolynomialVector = std::array<Polynomial, 3>;

/// A time at which the point is in the triangle's plane: one that is known, or the only root of the cubic
/// between the breaks `piece` and `piece` + 1, where it changes sign.
struct Coplanarity {
  bool known = false;
  Surd at;
  int piece = 0;
};

/// Twice the area of the point and the edge opposite to a corner, as seen along an axis.
struct Area {
  bool known = false;
  Polynomial value;
};

class ExactQuery {
 public:
  ExactQuery(const PointTriangleMotion& m, Workspace* workspace);

  Meeting first_meeting() { return cubic_.degree < 0 ? first_of_flat_motion() : first_of_cubic(); }

 private:
  Meeting first_of_cubic();
  void find_breaks();
  int extrema_before(const Surd& t, bool* at_extremum);
  int compare_with(const Coplanarity& root, const Surd& t);
  int sign_at(const Coplanarity& root, const Polynomial& q);

  Meeting first_of_flat_motion();
  void meet_at_roots(const Polynomial& q, Meeting* first);
  bool meet_at_roots_of_first_component(const PolynomialVector& v, Meeting* first);

  const Polynomial& area(int corner, int axis);
  bool inside(const Coplanarity& root);
  bool inside_segment(const Coplanarity& root);

  double estimate(const Coplanarity& root);
  double rounded_down(const Coplanarity& root);
  bool not_after(double grid_time, const Coplanarity& root);

  Workspace& workspace_;
  Algebra algebra_;
  Surd zero_, one_;
  std::array<PolynomialVector, 3> corner_;  ///< relative to the point
  std::array<std::array<Area, 3>, 3> area_;
  Polynomial cubic_, slope_, curvature_;
  // 0, the extrema of the cubic inside the step, 1; between two of them the cubic is monotone.
  std::array<Surd, 4> break_;
  std::array<int, 4> sign_at_break_{};
  int breaks_ = 0;
  int extrema_at_or_before_start_ = 0;
};

/// The exponent that makes all eight coordinates of an axis whole.
int common_exponent(const std::array<const Vec3*, 8>& points, int axis) {
  int least = 1024;
  for (const Vec3* x : points) {
    if ((*x)[axis] != 0) least = std::min(least, lowest_exponent((*x)[axis]));
  }
  return least;
}

ExactQuery::ExactQuery(const PointTriangleMotion& m, Workspace* workspace)
    : workspace_(*workspace), algebra_(workspace) {
  const Whole one = workspace_.small(1);
  zero_ = algebra_.fraction({}, one);
  one_ = algebra_.fraction(one, one);
  const std::array<const Vec3*, 8> points{&m.p_t0, &m.a_t0, &m.b_t0, &m.c_t0,
                                          &m.p_t1, &m.a_t1, &m.b_t1, &m.c_t1};
  for (int k = 0; k < 3; ++k) {
    const int exponent = common_exponent(points, k);
    std::array<Whole, 8> x;
    for (int i = 0; i < 8; ++i) x[i] = workspace_.from_double((*points[i])[k], exponent);
    for (int i = 0; i < 3; ++i) {
      corner_[i][k] =
          algebra_.linear(workspace_.difference(x[1 + i], x[0]), workspace_.difference(x[5 + i], x[4]));
    }
  }
  for (int k = 0; k < 3; ++k) {
    cubic_ = algebra_.sum(cubic_, algebra_.product(corner_[0][k], area(0, k)));
  }
  slope_ = algebra_.derivative(cubic_);
  curvature_ = algebra_.derivative(slope_);
}

/// Made when first asked for: mostly one axis is enough.
const Polynomial& ExactQuery::area(int corner, int axis) {
  Area& area = area_[corner][axis];
  if (!area.known) {
    OILSKIN_ASSERT(!workspace_.in_scope());
    const PolynomialVector &u = corner_[(corner + 1) % 3], &v = corner_[(corner + 2) % 3];
    const int x = (axis + 1) % 3, y = (axis + 2) % 3;
    area.value = algebra_.difference(algebra_.product(u[x], v[y]), algebra_.product(u[y], v[x]));
    area.known = true;
  }
  return area.value;
}

// ---- Times of coplanarity ----

void ExactQuery::find_breaks() {
  break_[breaks_++] = zero_;
  if (slope_.degree >= 1) {
    const SurdRoots stationary = algebra_.roots_of(slope_);
    // A double root of the slope is no extremum.
    const int extrema = slope_.degree == 2 && stationary.count == 1 ? 0 : stationary.count;
    for (int i = 0; i < extrema; ++i) {
      if (algebra_.compare_with_fraction(stationary.at[i], zero_) <= 0) {
        ++extrema_at_or_before_start_;
      } else if (algebra_.compare_with_fraction(stationary.at[i], one_) < 0) {
        break_[breaks_++] = stationary.at[i];
      }
    }
  }
  break_[breaks_++] = one_;
  for (int i = 0; i < breaks_; ++i) sign_at_break_[i] = algebra_.sign_at(cubic_, break_[i]);
}

/// How many extrema of the cubic, wherever they are, lie before t. The signs of slope and curvature tell.
int ExactQuery::extrema_before(const Surd& t, bool* at_extremum) {
  const int lead = slope_.leading_sign(), slope = algebra_.sign_at(slope_, t) * lead;
  *at_extremum = slope == 0;
  if (slope_.degree == 1) return slope > 0 ? 1 : 0;
  if (slope < 0) return 1;
  const bool left = algebra_.sign_at(curvature_, t) * lead < 0;
  if (slope == 0) return left ? 0 : 1;
  return left ? 0 : 2;
}

/// −1, 0, 1 as t is before, at or after the root.
int ExactQuery::compare_with(const Coplanarity& root, const Surd& t) {
  OILSKIN_ASSERT(!root.known);
  if (algebra_.compare_with_fraction(t, zero_) <= 0) return -1;
  if (algebra_.compare_with_fraction(t, one_) >= 0) return 1;
  if (breaks_ > 2) {
    bool at_extremum = false;
    const int piece = extrema_before(t, &at_extremum) - extrema_at_or_before_start_;
    if (at_extremum) return piece < root.piece ? -1 : 1;
    if (piece != root.piece) return piece < root.piece ? -1 : 1;
  }
  const int sign = algebra_.sign_at(cubic_, t);
  return sign == 0 ? 0 : (sign == sign_at_break_[root.piece] ? -1 : 1);
}

/// The sign that q, of degree two at most, has at the root.
int ExactQuery::sign_at(const Coplanarity& root, const Polynomial& q) {
  if (root.known) return algebra_.sign_at(q, root.at);
  const int lead = q.leading_sign();
  if (q.degree < 1) return lead;
  const Workspace::Scope scope(&workspace_);
  const SurdRoots zeros = algebra_.roots_of(q);
  // From the last zero to the first: q has the sign `lead` after the last, and changes it at each unless that
  // is double.
  int sign = lead;
  for (int i = zeros.count - 1; i >= 0; --i) {
    const int order = compare_with(root, zeros.at[i]);
    if (order == 0) return 0;
    if (order < 0) return sign;
    if (zeros.count == q.degree) sign = -sign;
  }
  return sign;
}

Meeting ExactQuery::first_of_cubic() {
  find_breaks();
  for (int i = 0; i < breaks_; ++i) {
    const Coplanarity at_break{true, break_[i], i}, between{false, {}, i};
    if (sign_at_break_[i] == 0 && inside(at_break)) return {true, rounded_down(at_break)};
    if (i + 1 < breaks_ && sign_at_break_[i] * sign_at_break_[i + 1] < 0 && inside(between)) {
      return {true, rounded_down(between)};
    }
  }
  return {};
}

// ---- Coplanar all the time ----

/// In flat motion a first touch after the start is on an edge, for a point inside was inside just before. The
/// edge's area vanishes there, and where it vanishes all the time, one of the edge's ends reaches the point.
Meeting ExactQuery::first_of_flat_motion() {
  std::array<PolynomialVector, 3> areas;
  for (int i = 0; i < 3; ++i) areas[i] = {area(i, 0), area(i, 1), area(i, 2)};
  if (inside({true, zero_, 0})) return {true, 0};
  Meeting first;
  for (int i = 0; i < 3; ++i) {
    if (!meet_at_roots_of_first_component(areas[i], &first)) {
      meet_at_roots_of_first_component(corner_[(i + 1) % 3], &first);
      meet_at_roots_of_first_component(corner_[(i + 2) % 3], &first);
    }
  }
  return first;
}

/// False if v is always zero.
bool ExactQuery::meet_at_roots_of_first_component(const PolynomialVector& v, Meeting* first) {
  for (const Polynomial& q : v) {
    if (q.degree < 0) continue;
    meet_at_roots(q, first);
    return true;
  }
  return false;
}

void ExactQuery::meet_at_roots(const Polynomial& q, Meeting* first) {
  if (q.degree < 1) return;
  const Workspace::Scope scope(&workspace_);
  const SurdRoots roots = algebra_.roots_of(q);
  for (int i = 0; i < roots.count; ++i) {
    const Coplanarity root{true, roots.at[i], 0};
    const bool in_step = algebra_.compare_with_fraction(root.at, zero_) >= 0 &&
                         algebra_.compare_with_fraction(root.at, one_) <= 0;
    if (!in_step || !inside(root)) continue;
    const double time = rounded_down(root);
    *first = {true, first->hit ? std::min(first->time, time) : time};
  }
}

// ---- The triangle ----

/// Is the point, in the triangle's plane at this time, in the closed triangle? The areas are multiples of the
/// normal, so one component of both tells whether they have its direction.
bool ExactQuery::inside(const Coplanarity& root) {
  for (int k = 0; k < 3; ++k) {
    const int normal = sign_at(root, algebra_.sum(area(0, k), algebra_.sum(area(1, k), area(2, k))));
    if (normal == 0) continue;
    for (int i = 0; i < 3; ++i) {
      if (sign_at(root, area(i, k)) * normal < 0) return false;
    }
    return true;
  }
  return inside_segment(root);
}

/// The same where the triangle is a segment or a point: on its line, and on each axis between the outermost.
bool ExactQuery::inside_segment(const Coplanarity& root) {
  for (int k = 0; k < 3; ++k) {
    int signs = 0;
    for (int i = 0; i < 3; ++i) {
      if (sign_at(root, area(i, k)) != 0) return false;
      signs += sign_at(root, corner_[i][k]);
    }
    if (signs == 3 || signs == -3) return false;
  }
  return true;
}

// ---- The time of touch ----

constexpr double kGrid = 0x1p52;

/// A time close to the root, as far as rounding allows.
double ExactQuery::estimate(const Coplanarity& root) {
  if (root.known) return algebra_.estimate(root.at);
  const RoundedPolynomial rounded(cubic_);
  double before = algebra_.estimate(break_[root.piece]), after = algebra_.estimate(break_[root.piece + 1]);
  while (after - before > 1 / kGrid) {
    const double t = 0.5 * (before + after);
    (rounded.at(t) * sign_at_break_[root.piece] > 0 ? before : after) = t;
  }
  return before;
}

bool ExactQuery::not_after(double grid_time, const Coplanarity& root) {
  const Workspace::Scope scope(&workspace_);
  const Whole numerator = workspace_.from_double(grid_time, 0),
              denominator = workspace_.from_double(kGrid, 0);
  const Surd t = algebra_.fraction(numerator, denominator);
  return root.known ? algebra_.compare_with_fraction(root.at, t) >= 0 : compare_with(root, t) <= 0;
}

/// A multiple of 2⁻⁵² that is certainly not after the root and close to it. The estimate is bracketed, and
/// where it was bad (near multiple roots) the bracket is halved until it is narrow.
double ExactQuery::rounded_down(const Coplanarity& root) {
  constexpr double kWide = 4096;
  const double guess = std::floor(estimate(root) * kGrid);
  double low = 0, high = kGrid + 1;  // not after, and after
  for (double reach = 1; low < guess - reach; reach *= 64) {
    (not_after(guess - reach, root) ? low : high) = guess - reach;
    if (low == guess - reach) break;
  }
  for (double reach = 1; guess + reach < high; reach *= 64) {
    (not_after(guess + reach, root) ? low : high) = guess + reach;
    if (high == guess + reach) break;
  }
  while (high - low > kWide) {
    const double middle = std::floor(0.5 * (low + high));
    (not_after(middle, root) ? low : high) = middle;
  }
  if (not_after(guess, root)) low = std::max(low, guess);
  OILSKIN_ASSERT(low >= 0 && low <= kGrid);
  return low / kGrid;
}

bool finite(const PointTriangleMotion& m) {
  return m.p_t0.allFinite() && m.a_t0.allFinite() && m.b_t0.allFinite() && m.c_t0.allFinite() &&
         m.p_t1.allFinite() && m.a_t1.allFinite() && m.b_t1.allFinite() && m.c_t1.allFinite();
}

}  // namespace

Meeting exact_meeting(const PointTriangleMotion& m) {
  if (!finite(m)) return {true, 0};
  Workspace workspace;
  ExactQuery query(m, &workspace);
  const Meeting meeting = query.first_meeting();
  OILSKIN_ASSERT(!workspace.exhausted());
  return workspace.exhausted() ? Meeting{true, 0} : meeting;
}

}  // namespace oilskin::ccd::detail
