/// Pairs of points within a radius, and the kernels of the methods that have a fluid of their own.
#pragma once

#include <algorithm>

#include "oilskin/types.h"

namespace oilskin::study {

/// Lists of near points by a grid of cells as wide as the radius; only occupied cells are stored.
class NeighbourLists {
 public:
  /// For each query the points nearer than `radius` [m] > 0, in an order that depends on the points alone.
  /// With `same` the queries are the points, and no point is its own neighbour.
  void search(Span<const Vec3> queries, Span<const Vec3> points, double radius, bool same);

  Span<const std::uint32_t> of(std::size_t query) const {
    return {list_.data() + begin_[query], begin_[query + 1] - begin_[query]};
  }
  /// Where the list of a query begins among all pairs; begin(queries) is their number.
  std::size_t begin(std::size_t query) const { return begin_[query]; }

 private:
  struct Entry {
    std::uint64_t cell;
    std::uint32_t point;
  };
  std::vector<Entry> entries_;  // by cell
  std::vector<Vec3> sorted_;    // the points in that order
  std::vector<std::uint32_t> list_;
  std::vector<std::size_t> begin_;
};

constexpr double pi = 3.14159265358979323846;

/// [Monaghan1992], the kernel of [Akinci2012] [1/m³]. r and the support radius h in [m], here and below.
inline double cubic_spline(double r, double h) {
  const double q = r / h, u = std::max(1 - q, 0.0), v = std::max(0.5 - q, 0.0);
  return 8 / (pi * h * h * h) * (2 * u * u * u - 8 * v * v * v);
}

/// W'(r)/r of it [1/m⁵], so that ∇W = x W'(r)/r; 0 at r = 0.
inline double cubic_spline_slope(double r, double h) {
  if (r <= 0) return 0;
  const double q = r / h, u = std::max(1 - q, 0.0), v = std::max(0.5 - q, 0.0);
  return 8 / (pi * h * h * h * h * r) * (24 * v * v - 6 * u * u);
}

/// [Mueller2003] Eq. 20: densities of [Macklin2013].
inline double poly6(double r, double h) {
  const double q = r / h, u = std::max(1 - q * q, 0.0);
  return 315 / (64 * pi * h * h * h) * u * u * u;
}

/// [Mueller2003] Eq. 21, W'(r)/r: gradients of [Macklin2013]; 0 at r = 0.
inline double spiky_slope(double r, double h) {
  if (r <= 0) return 0;
  const double u = std::max(1 - r / h, 0.0);
  return -45 / (pi * h * h * h * h * r) * u * u;
}

/// Σ of a kernel W(r, h) over the cubic lattice of `spacing`, the origin included: 1 over the volume that a
/// particle of water at rest has [1/m³].
double lattice_sum(double (*kernel)(double, double), double spacing, double h);

}  // namespace oilskin::study
