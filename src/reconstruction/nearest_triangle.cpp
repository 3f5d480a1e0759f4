#include "reconstruction/nearest_triangle.h"

namespace oilskin::reconstruction {

void NearestTriangle::set(const Obstacles& obstacles, const Box& points, double reach) {
  obstacles_ = &obstacles;
  reach_ = reach;
  origin_ = (points.min + points.max) / 2;
  triangles_.clear();
  obstacles.query(points.inflated(reach), triangles_);
  for (std::size_t a = 0; a < 3; ++a) {
    low_[a].clear();
    high_[a].clear();
  }
  for (const std::uint32_t t : triangles_) {
    const Box box = obstacles.box(t);
    for (std::size_t a = 0; a < 3; ++a) {
      low_[a].push_back(static_cast<float>(box.min[int(a)] - origin_[int(a)]));
      high_[a].push_back(static_cast<float>(box.max[int(a)] - origin_[int(a)]));
    }
  }
  for (std::size_t a = 0; a < 3; ++a) {
    low_[a].resize((triangles_.size() + 7) / 8 * 8, 1e15f);
    high_[a].resize(low_[a].size(), 1e15f);
  }
}

simd::F8 NearestTriangle::squared_distances(std::size_t c, const Vec3& x) const {
  F8 squared = 0.0f;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto at = static_cast<float>(x[int(a)] - origin_[int(a)]);
    const F8 off = larger(positive_part(F8::load(&low_[a][c]) - at), F8(at) - F8::load(&high_[a][c]));
    squared = squared + off * off;
  }
  return squared;
}

ClosestPoint NearestTriangle::find(const Vec3& x) const {
  ClosestPoint best;
  best.distance = reach_;
  for (std::size_t c = 0; c < low_[0].size(); c += 8) {
    const double limit = with_rounding(x, best.distance);
    for (std::uint32_t bits = 0xff & ~greater_mask(squared_distances(c, x), float(limit * limit)); bits != 0;
         bits &= bits - 1) {
      const Corners k = obstacles_->corners(triangles_[c + std::size_t(__builtin_ctz(bits))]);
      const ClosestPoint p = closest_point(x, k[0], k[1], k[2]);
      if (p.distance < best.distance) best = p;
    }
  }
  return best;
}

}  // namespace oilskin::reconstruction
