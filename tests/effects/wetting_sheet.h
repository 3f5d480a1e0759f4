/// Sheets and strips of textile with liquid, for tests of its transport.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "effects/wetting/wetting_transport.h"
#include "support/random.h"

namespace oilskin::test {

/// A mesh, its transport and its liquid.
struct WettingSheet {
  std::vector<Vec3> x;
  std::vector<Triangle> triangles;
  std::vector<double> liquid;
  std::vector<std::uint32_t> held;
  std::unique_ptr<WettingTransport> transport;
  /// Of the held nodes, since the start.
  double supplied = 0;

  void make(const Fabric& fabric) {
    transport = std::make_unique<WettingTransport>(x, triangles, fabric);
    liquid.assign(x.size(), 0);
  }
  double saturation(std::size_t i) const { return liquid[i] / transport->capacity()[i]; }
  void set_saturation(std::size_t i, double s) { liquid[i] = s * transport->capacity()[i]; }
  void step(double dt, const Vec3& gravity = Vec3::Zero()) {
    TransportReport report;
    const Status s = transport->step(dt, x, gravity, liquid, held, &report);
    ASSERT_TRUE(s.ok()) << s.message;
    supplied += report.supplied;
  }
  /// Of all nodes, the held ones included. In more digits, so that the sum itself has no error to speak of.
  double total() const {
    long double sum = 0;
    for (const double m : liquid) sum += m;
    return static_cast<double>(sum);
  }
  double lowest() const {
    double s = INFINITY;
    for (std::size_t i = 0; i < x.size(); ++i) s = std::min(s, saturation(i));
    return s;
  }
  double highest() const {
    double s = 0;
    for (std::size_t i = 0; i < x.size(); ++i) s = std::max(s, saturation(i));
    return s;
  }
  /// Holds the nodes with x = 0 at S = 1.
  void hold_left() {
    for (std::uint32_t i = 0; i < x.size(); ++i)
      if (x[i].x() == 0) held.push_back(i), set_saturation(i, 1);
  }
};

/// nx × ny cells of dx × dy, from the origin on; right-angled triangles.
inline WettingSheet wetting_grid(std::size_t nx, std::size_t ny, double dx, double dy) {
  WettingSheet sheet;
  for (std::size_t j = 0; j <= ny; ++j)
    for (std::size_t i = 0; i <= nx; ++i)
      sheet.x.emplace_back(static_cast<double>(i) * dx, static_cast<double>(j) * dy, 0);
  const auto node = [&](std::size_t i, std::size_t j) {
    return static_cast<std::uint32_t>(j * (nx + 1) + i);
  };
  for (std::size_t j = 0; j < ny; ++j)
    for (std::size_t i = 0; i < nx; ++i) {
      sheet.triangles.push_back({node(i, j), node(i + 1, j), node(i + 1, j + 1)});
      sheet.triangles.push_back({node(i, j), node(i + 1, j + 1), node(i, j + 1)});
    }
  return sheet;
}

/// Horizontal without gravity unless `rise` is finite; C is 0.3 kg/m².
inline Fabric plain_fabric(double diffusivity, double exponent, double rise = INFINITY) {
  Fabric f;
  f.diffusivity = diffusivity;
  f.mobility_exponent = exponent;
  f.capillary_rise = rise;
  f.saturation_limit = 1;
  return f;
}

/// Moves the nodes inside a grid of square cells by up to `part` of their width.
inline void jitter(WettingSheet& sheet, double width, double part, std::uint64_t seed) {
  Random random(seed);
  Vec3 low = sheet.x.front(), high = sheet.x.back();
  for (Vec3& x : sheet.x) {
    const Vec3 move(random.uniform(-part, part) * width, random.uniform(-part, part) * width, 0);
    const bool inside =
        (x - low).head<2>().minCoeff() > width / 2 && (high - x).head<2>().minCoeff() > width / 2;
    if (inside) x += move;
  }
}

/// Second moments of the liquid about its centre of mass [m²].
inline Eigen::Matrix2d spread(const WettingSheet& sheet) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < sheet.x.size(); ++i) mean += sheet.liquid[i] * sheet.x[i].head<2>();
  mean /= sheet.total();
  Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
  for (std::size_t i = 0; i < sheet.x.size(); ++i) {
    const Eigen::Vector2d d = sheet.x[i].head<2>() - mean;
    sum += sheet.liquid[i] * d * d.transpose();
  }
  return sum / sheet.total();
}

}  // namespace oilskin::test
