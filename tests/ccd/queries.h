/// Families of hard queries for the continuous test, from fixed seeds.
#pragma once

#include <functional>
#include <random>
#include <string>
#include <vector>

#include "ccd/point_triangle.h"
#include "support/exact.h"

namespace oilskin::test {

/// Point, a, b, c at t = 0, then at t = 1.
using Corners = std::array<Vec3, 8>;

ccd::PointTriangleMotion to_motion(const Corners& x);
exact::Motion to_exact(const Corners& x);

/// Random numbers that are the same on every platform (the standard's distributions are not).
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double uniform(double low, double high);
  int integer(int low, int high);  ///< both ends included
  Vec3 vector(double size);        ///< components within ±size
  Vec3 integer_vector(int size);   ///< integer components within ±size
  /// ±10^e with e uniform.
  double power_of_ten(double low, double high);

 private:
  std::mt19937_64 engine_;
};

struct Family {
  std::string name;
  std::function<Corners(Random&)> make;
  /// Coordinates whose sizes differ so much that exact arithmetic, the oracle's above all, takes its time.
  bool wide = false;
};

const std::vector<Family>& families();

}  // namespace oilskin::test
