#include "reconstruction/nearest_triangle.h"

#include <algorithm>
#include <cmath>

#include "reconstruction/visibility.h"

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

void NearestTriangle::set_planes() {
  for (std::vector<float>& n : normal_) n.assign(low_[0].size(), 0.0f);
  offset_.assign(low_[0].size(), 0.0f);
  for (std::size_t k = 0; k < triangles_.size(); ++k) {
    const Vec3& n = obstacles_->normal(triangles_[k]);
    for (std::size_t a = 0; a < 3; ++a) normal_[a][k] = static_cast<float>(n[int(a)]);
    offset_[k] =
        static_cast<float>(n.dot(obstacles_->vertex(obstacles_->indices(triangles_[k])[0]) - origin_));
  }
}

NearestTriangle::Between::Between(const Vec3& from, const Vec3& to, double reach) {
  double largest = reach;
  for (std::size_t a = 0; a < 3; ++a) {
    const double x = from[int(a)], y = to[int(a)];
    p[a] = static_cast<float>(x);
    q[a] = static_cast<float>(y);
    low[a] = std::min(p[a], q[a]);
    high[a] = std::max(p[a], q[a]);
    largest = std::max({largest, std::abs(x), std::abs(y)});
  }
  rounding = static_cast<float>(1e-5 * largest);
}

std::uint32_t NearestTriangle::between_mask(std::size_t c, const Between& s) const {
  F8 at_p = 0.0f - F8::load(&offset_[c]), at_q = at_p, apart = 0.0f;
  for (std::size_t a = 0; a < 3; ++a) {
    const F8 n = F8::load(&normal_[a][c]);
    at_p = at_p + n * s.p[a];
    at_q = at_q + n * s.q[a];
    apart = larger(apart, larger(F8::load(&low_[a][c]) - s.high[a], F8(s.low[a]) - F8::load(&high_[a][c])));
  }
  // On one side of the plane: both heights are positive, or both negative.
  const F8 one_side = larger(0.0f - larger(0.0f - at_p, 0.0f - at_q), 0.0f - larger(at_p, at_q));
  return 0xff & ~greater_mask(larger(apart, one_side), s.rounding);
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

template <class May, class Accept>
ClosestPoint NearestTriangle::nearest(const Vec3& x, double within, const May& may,
                                      const Accept& accept) const {
  ClosestPoint best;
  best.distance = within;
  for (std::size_t c = 0; c < low_[0].size(); c += 8) {
    const double limit = with_rounding(x, best.distance);
    for (std::uint32_t bits = may(c) & ~greater_mask(squared_distances(c, x), float(limit * limit));
         bits != 0; bits &= bits - 1) {
      const std::uint32_t t = triangles_[c + std::size_t(__builtin_ctz(bits))];
      const Corners k = obstacles_->corners(t);
      const ClosestPoint p = closest_point(x, k[0], k[1], k[2]);
      if (p.distance < best.distance && accept(p, t)) best = p;
    }
  }
  return best;
}

ClosestPoint NearestTriangle::find(const Vec3& x, double within) const {
  return nearest(
      x, within, [](std::size_t) { return 0xffu; }, [](const ClosestPoint&, std::uint32_t) { return true; });
}

ClosestPoint NearestTriangle::find_opposite(const Vec3& x, const Vec3& normal) const {
  // What it looks for is in front of a triangle's plane, on the side to which the triangle's normal is at
  // more than 90° to `normal`.
  const Vec3 from_origin = x - origin_;
  const float rounding = static_cast<float>(1e-5 * (from_origin.cwiseAbs().maxCoeff() + reach_));
  const auto may_face = [&](std::size_t c) {
    F8 ahead = 0.0f, alike = 0.0f;  // ahead: how far a box reaches along the normal from x, at most
    F8 height = 0.0f - F8::load(&offset_[c]);
    for (std::size_t a = 0; a < 3; ++a) {
      const auto at = static_cast<float>(from_origin[int(a)]), n = static_cast<float>(normal[int(a)]);
      ahead = ahead + larger((F8::load(&low_[a][c]) - at) * n, (F8::load(&high_[a][c]) - at) * n);
      alike = alike + F8::load(&normal_[a][c]) * n;
      height = height + F8::load(&normal_[a][c]) * at;
    }
    return greater_mask(ahead, 0.0f) & greater_mask(rounding, height * alike);
  };
  return nearest(x, reach_, may_face, [&](const ClosestPoint& p, std::uint32_t t) {
    return p.offset.dot(normal) < -0.45 * p.distance &&
           std::abs(p.offset.dot(obstacles_->normal(t))) > 0.92 * p.distance;
  });
}

bool NearestTriangle::is_enclosed(const Vec3& x, const Vec3& normal, double reach) const {
  constexpr int lines = 4;
  std::vector<std::uint32_t> near;
  for_within(x, reach, [&](std::uint32_t t) { near.push_back(t); });
  const auto is_blocked = [&](const Vec3& to) {
    return std::any_of(near.begin(), near.end(), [&](std::uint32_t t) {
      return hides_segment(x, to, obstacles_->corners(t), obstacles_->indices(t));
    });
  };
  const Vec3 u = normal.unitOrthogonal(), v = normal.cross(u);
  for (int k = 0; k < lines; ++k) {
    const double angle = k * 3.14159265358979323846 / lines;
    const Vec3 way = reach * (std::cos(angle) * u + std::sin(angle) * v);
    if (is_blocked(x + way) && is_blocked(x - way)) return true;
  }
  return false;
}

}  // namespace oilskin::reconstruction
