#include "ccd/point_triangle.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "ccd/coplanarity_cubic.h"
#include "ccd/separation.h"

// The method. Every answer "no hit" is certified, either by a bound of the cubic's
// rounding error (the four points are never coplanar) or by a direction that separates point and triangle
// beyond the rounding error of its dot products. What cannot be certified is a hit.

namespace oilskin::ccd {
namespace {

using detail::Coefficients;
using detail::CoplanarityCubic;
using detail::RelativeMotion;
using detail::TimeSpan;

static_assert(sizeof(PointTriangleMotion) == 24 * sizeof(double), "end points are compared as one block");

bool nothing_moves(const PointTriangleMotion& m) {
  return std::memcmp(m.p_t0.data(), m.p_t1.data(), 12 * sizeof(double)) == 0;
}

/// Fills `relative` axis by axis; true as soon as an axis separates. The six signs are exact, and what has
/// one sign at both ends of a linear motion has it in between: no error analysis needed.
bool axis_separates(const PointTriangleMotion& m, RelativeMotion* relative) {
  for (int k = 0; k < 3; ++k) {
    const double p0 = m.p_t0[k], p1 = m.p_t1[k];
    const double a0 = m.a_t0[k] - p0, b0 = m.b_t0[k] - p0, c0 = m.c_t0[k] - p0;
    const double a1 = m.a_t1[k] - p1, b1 = m.b_t1[k] - p1, c1 = m.c_t1[k] - p1;
    const double least = std::min(std::min(std::min(a0, b0), std::min(c0, a1)), std::min(b1, c1));
    const double greatest = std::max(std::max(std::max(a0, b0), std::max(c0, a1)), std::max(b1, c1));
    if (least > 0 || greatest < 0) return true;
    relative->t0[0][k] = a0;
    relative->t0[1][k] = b0;
    relative->t0[2][k] = c0;
    relative->t1[0][k] = a1;
    relative->t1[1][k] = b1;
    relative->t1[2][k] = c1;
  }
  return false;
}

/// How the signs of the coefficients limit the number of roots (Descartes' rule for the Bernstein basis).
enum class Roots { kNone, kOne, kUnknown, kInvisible };

Roots count_roots(const CoplanarityCubic& cubic, const Coefficients& c) {
  const int s0 = cubic.sign(c.k[0]), s1 = cubic.sign(c.k[1]), s2 = cubic.sign(c.k[2]),
            s3 = cubic.sign(c.k[3]);
  const int total = s0 + s1 + s2 + s3;
  if (total == 4 || total == -4) return Roots::kNone;
  // One variation of sign whatever the sign of the uncertain coefficient: exactly one root, and it is simple.
  if (s0 * s3 == -1 && (s1 == s0 || s2 == s3)) return Roots::kOne;
  if (s0 == 0 && s1 == 0 && s2 == 0 && s3 == 0) return Roots::kInvisible;
  return Roots::kUnknown;
}

/// Is the point well inside the triangle at time t, as far as rounding can tell? A "yes" only saves work.
bool well_inside(const RelativeMotion& motion, double t) {
  double corner[3][3];
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) corner[i][k] = (1 - t) * motion.t0[i][k] + t * motion.t1[i][k];
  }
  const auto cross = [](const double* a, const double* b, double* c) {
    c[0] = a[1] * b[2] - a[2] * b[1];
    c[1] = a[2] * b[0] - a[0] * b[2];
    c[2] = a[0] * b[1] - a[1] * b[0];
  };
  double area[3][3], normal[3], weight[3], sum = 0;
  for (int i = 0; i < 3; ++i) cross(corner[(i + 1) % 3], corner[(i + 2) % 3], area[i]);
  for (int k = 0; k < 3; ++k) normal[k] = area[0][k] + area[1][k] + area[2][k];
  for (int i = 0; i < 3; ++i) {
    weight[i] = area[i][0] * normal[0] + area[i][1] * normal[1] + area[i][2] * normal[2];
    sum += weight[i];
  }
  constexpr double kMargin = 1e-7;
  return weight[0] > kMargin * sum && weight[1] > kMargin * sum && weight[2] > kMargin * sum;
}

/// The single crossing of the plane within `span`: through the triangle or beside it?
Meeting meet_at_crossing(const CoplanarityCubic& cubic, const RelativeMotion& motion, const TimeSpan& span) {
  const TimeSpan root = narrow_crossing(cubic, span);
  if (well_inside(motion, root.middle())) return {true, root.begin};
  return detail::meet_by_subdivision(motion, root);
}

/// Where to cut a span whose roots cannot be counted, and how many halvings each part is worth. In the
/// middle; but where only the coefficient of one end is uncertain (a touch at the start or the end of the
/// step), close to it.
struct Cut {
  double time;
  int early_depth, late_depth;
};

Cut choose_cut(const CoplanarityCubic& cubic, const Coefficients& c, const TimeSpan& span) {
  constexpr int kHalvings = 13;
  constexpr double kPart = 0x1p-13;
  const int s0 = cubic.sign(c.k[0]), s1 = cubic.sign(c.k[1]), s2 = cubic.sign(c.k[2]),
            s3 = cubic.sign(c.k[3]);
  if (s1 != 0 && s1 == s2 && s0 == s1 && s3 == 0) return {span.end - kPart * span.width(), 1, kHalvings};
  if (s1 != 0 && s1 == s2 && s3 == s1 && s0 == 0) return {span.begin + kPart * span.width(), kHalvings, 1};
  return {span.middle(), 1, 1};
}

/// Isolates the roots of the cubic from the earliest to the latest, and answers at the first that meets.
Meeting first_meeting(const CoplanarityCubic& cubic, const RelativeMotion& motion, const TimeSpan& span,
                      const Coefficients& coefficients, int depth) {
  // Halving a double root this often narrows it to 1.5e-8, where rounding hides the cubic.
  constexpr int kMaxDepth = 26;
  switch (count_roots(cubic, coefficients)) {
    case Roots::kNone:
      return {};
    case Roots::kOne:
      return meet_at_crossing(cubic, motion, span);
    case Roots::kInvisible:
      return detail::meet_by_subdivision(motion, span);
    case Roots::kUnknown:
      break;
  }
  if (depth >= kMaxDepth) return detail::meet_by_subdivision(motion, span);
  const Cut cut = choose_cut(cubic, coefficients, span);
  const TimeSpan early{span.begin, cut.time}, late{cut.time, span.end};
  const Meeting meeting = first_meeting(cubic, motion, early, cubic.on(early), depth + cut.early_depth);
  if (meeting.hit) return meeting;
  return first_meeting(cubic, motion, late, cubic.on(late), depth + cut.late_depth);
}

}  // namespace

Meeting point_triangle(const PointTriangleMotion& m) {
  if (nothing_moves(m)) return {};
  RelativeMotion relative;
  if (axis_separates(m, &relative)) return {};
  const CoplanarityCubic cubic(m, relative);
  if (!cubic.bounded()) return detail::meet_by_subdivision(relative, {0, 1});
  return first_meeting(cubic, relative, {0, 1}, cubic.coefficients(), 0);
}

}  // namespace oilskin::ccd
