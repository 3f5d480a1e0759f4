#include "study/cases/lintearia.h"

#include <algorithm>
#include <cmath>

namespace oilskin::demo {
namespace {

constexpr int steps = 480;  // of the integration, over half the strip
constexpr int halvings = 50;

/// x, y, θ, and the area between strip and water level.
using State = std::array<double, 4>;

struct Half {
  double depth, tension, weight;

  State slope(const State& s) const {
    const double over = std::max(0.0, depth - s[1]);
    return {std::cos(s[2]), std::sin(s[2]), (over + weight * std::cos(s[2])) / (tension + weight * s[1]),
            over * std::cos(s[2])};
  }
};

State moved(const State& s, const State& slope, double by) {
  State to = s;
  for (std::size_t k = 0; k < to.size(); ++k) to[k] += by * slope[k];
  return to;
}

/// Runge and Kutta's method of fourth order. `visit` is called at the start and after each step.
template <class Visit>
State integrate(const Half& half, const Visit& visit) {
  constexpr double h = 0.5 / steps;
  State s{};
  visit(0, s);
  for (int i = 1; i <= steps; ++i) {
    const State a = half.slope(s), b = half.slope(moved(s, a, 0.5 * h)), c = half.slope(moved(s, b, 0.5 * h)),
                d = half.slope(moved(s, c, h));
    for (std::size_t k = 0; k < s.size(); ++k) s[k] += h / 6 * (a[k] + 2 * b[k] + 2 * c[k] + d[k]);
    visit(i, s);
  }
  return s;
}

State end_of(const Half& half) {
  return integrate(half, [](int, const State&) {});
}

/// A strip under more tension is flatter and reaches farther.
Half tightened(const Trough& trough, double depth) {
  double low = 1e-4, high = 1e3;
  for (int i = 0; i < halvings; ++i) {
    const double middle = std::sqrt(low * high);
    const State end = end_of({depth, middle, trough.weight});
    // A strip that has rolled up is far too loose, wherever it ends.
    const bool loose = 2 * end[0] < trough.gap || end[2] > 2.5;
    (loose ? low : high) = middle;
  }
  return {depth, high, trough.weight};
}

Half filled(const Trough& trough) {
  double low = 0, high = 0.5;
  for (int i = 0; i < halvings; ++i) {
    const double middle = 0.5 * (low + high);
    (2 * end_of(tightened(trough, middle))[3] < trough.area ? low : high) = middle;
  }
  return tightened(trough, low);
}

}  // namespace

TroughShape trough_shape(const Trough& trough, int segments) {
  const Half half = filled(trough);
  std::vector<Point2> right;
  const auto visit = [&](int i, const State& s) {
    if (i * segments / steps >= static_cast<int>(right.size())) right.push_back({s[0], s[1]});
  };
  const State end = integrate(half, visit);
  TroughShape shape;
  shape.depth = half.depth;
  shape.sag = end[1];
  shape.end_angle = end[2];
  shape.pull = (half.tension + half.weight * end[1]) * std::cos(end[2]);
  for (auto p = right.rbegin(); p != right.rend(); ++p) shape.points.push_back({-(*p)[0], (*p)[1]});
  shape.points.insert(shape.points.end(), right.begin() + 1, right.end());
  return shape;
}

}  // namespace oilskin::demo
