/// The motion of a triangle relative to a point as polynomials in time, over any exact number type N with
/// +, − and *. Internal to the module.
#pragma once

#include <array>

namespace oilskin::ccd::detail {

/// start + slope t
template <class N>
struct Linear {
  N start, slope;
};

/// Corner minus point, per corner and axis.
template <class N>
using RelativeCorners = std::array<std::array<Linear<N>, 3>, 3>;

/// Twice the area of the point and the edge opposite to a corner, projected along an axis; constant term
/// first.
template <class N>
auto area_of(const RelativeCorners<N>& corner, int opposite, int axis) {
  const auto &u = corner[(opposite + 1) % 3], &v = corner[(opposite + 2) % 3];
  const int x = (axis + 1) % 3, y = (axis + 2) % 3;
  using Product = decltype(u[x].start * v[y].start);
  return std::array<Product, 3>{
      u[x].start * v[y].start - u[y].start * v[x].start,
      (u[x].start * v[y].slope + u[x].slope * v[y].start) -
          (u[y].start * v[x].slope + u[y].slope * v[x].start),
      u[x].slope * v[y].slope - u[y].slope * v[x].slope,
  };
}

/// Six times the volume of the tetrahedron of point and triangle: its roots are the times of coplanarity.
template <class N, class Area>
auto volume_of(const std::array<Linear<N>, 3>& corner, const std::array<Area, 3>& area) {
  using Product = decltype(corner[0].start * area[0][0]);
  const auto sum = [](const Product& a, const Product& b, const Product& c) { return a + b + c; };
  const auto term = [&](int axis) {
    const Linear<N>& w = corner[axis];
    const Area& a = area[axis];
    return std::array<Product, 4>{w.start * a[0], w.start * a[1] + w.slope * a[0],
                                  w.start * a[2] + w.slope * a[1], w.slope * a[2]};
  };
  const std::array<Product, 4> x = term(0), y = term(1), z = term(2);
  return std::array<Product, 4>{sum(x[0], y[0], z[0]), sum(x[1], y[1], z[1]), sum(x[2], y[2], z[2]),
                                sum(x[3], y[3], z[3])};
}

}  // namespace oilskin::ccd::detail
