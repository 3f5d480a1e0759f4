#include "surface/visibility.h"

#include <algorithm>
#include <cmath>

#include "core/assert.h"
#include "surface/lanes.h"

namespace oilskin::surface {

namespace {

/// Of the product of three lengths: what a volume may be off by.
constexpr double grazes = 1e-14;

/// p and q both in the plane of the triangle: no line along an edge or along the segment parts them there.
bool touches_in_plane(const Vec3& p, const Vec3& q, const Corners& c, const Vec3& normal) {
  Eigen::Index drop = 0;
  normal.cwiseAbs().maxCoeff(&drop);
  const Eigen::Index a = (drop + 1) % 3, b = (drop + 2) % 3;
  const auto turn = [a, b](const Vec3& from, const Vec3& to, const Vec3& x) {
    return (to[a] - from[a]) * (x[b] - from[b]) - (to[b] - from[b]) * (x[a] - from[a]);
  };
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 &u = c[k], &v = c[(k + 1) % 3], &w = c[(k + 2) % 3];
    const double inner = turn(u, v, w), at_p = turn(u, v, p), at_q = turn(u, v, q);
    if (std::max(at_p, at_q) < std::min(inner, 0.0) || std::min(at_p, at_q) > std::max(inner, 0.0))
      return false;
  }
  const double s0 = turn(p, q, c[0]), s1 = turn(p, q, c[1]), s2 = turn(p, q, c[2]);
  return !(std::min({s0, s1, s2}) > 0 || std::max({s0, s1, s2}) < 0);
}

}  // namespace

bool segment_touches(const Vec3& p, const Vec3& q, const Corners& c, const Triangle& indices) {
  const Vec3 normal = (c[1] - c[0]).cross(c[2] - c[0]);
  if (!(normal.squaredNorm() > 0)) return false;
  const double at_p = normal.dot(p - c[0]), at_q = normal.dot(q - c[0]);
  if ((at_p > 0 && at_q > 0) || (at_p < 0 && at_q < 0)) return false;
  if (at_p == 0 && at_q == 0) return touches_in_plane(p, q, c, normal);
  const Vec3 along = q - p;
  const Corners r = {c[0] - p, c[1] - p, c[2] - p};
  const double length2 = along.squaredNorm(),
               l2[3] = {r[0].squaredNorm(), r[1].squaredNorm(), r[2].squaredNorm()};
  bool left = true, right = true;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3;
    const bool reversed = indices[k] > indices[next];
    const std::size_t from = reversed ? next : k, to = reversed ? k : next;
    const double volume = along.dot(r[from].cross(r[to]));
    // Within rounding of the edge: touched. Else a line through a vertex could slip between the rounding
    // errors of its edges.
    if (volume * volume <= grazes * grazes * length2 * l2[from] * l2[to]) continue;
    const double sign = reversed ? -volume : volume;
    left &= sign > 0;
    right &= sign < 0;
  }
  return left || right;
}

void BlockSight::set(const Obstacles& obstacles, const std::vector<std::uint32_t>& triangles,
                     const Vec3& origin, double cell, double margin) {
  OILSKIN_ASSERT(margin >= 0 && cell > 0);
  for (std::vector<float>* v : {&normal_x_, &normal_y_, &normal_z_, &offset_}) v->clear();
  boxes_.clear();
  corners_.clear();
  indices_.clear();
  margin_ = static_cast<float>(std::ceil(margin) + 1);
  slabs_ = side + 2 * static_cast<int>(margin_);
  // Of the sides, in floats: larger than all rounding, and whoever is nearer to a plane is looked at in
  // doubles.
  tolerance_ = 1e-5f * static_cast<float>(slabs_);
  for (std::uint32_t t : triangles) {
    Corners c = obstacles.corners(t);
    for (Vec3& v : c) v = (v - origin) / cell;
    const Vec3 normal = (c[1] - c[0]).cross(c[2] - c[0]);
    const double length = normal.norm();
    if (!(length > 0)) continue;
    const Vec3 n = normal / length;
    normal_x_.push_back(static_cast<float>(n.x()));
    normal_y_.push_back(static_cast<float>(n.y()));
    normal_z_.push_back(static_cast<float>(n.z()));
    offset_.push_back(static_cast<float>(n.dot(c[0])));
    const Vec3 low = c[0].cwiseMin(c[1]).cwiseMin(c[2]), high = c[0].cwiseMax(c[1]).cwiseMax(c[2]);
    FloatBox box;
    for (int k = 0; k < 3; ++k) {
      box.low[k] = static_cast<float>(low[k]) - tolerance_;
      box.high[k] = static_cast<float>(high[k]) + tolerance_;
    }
    boxes_.push_back(box);
    corners_.push_back(c);
    indices_.push_back(obstacles.indices(t));
  }
  words_ = (corners_.size() + 63) / 64;
  for (std::vector<float>* v : {&normal_x_, &normal_y_, &normal_z_, &offset_}) v->resize(64 * words_, 0.0f);
  fill_slabs();
}

void BlockSight::fill_slabs() {
  starts_.assign(3 * std::size_t(slabs_) * words_, 0);
  ends_.assign(starts_.size(), 0);
  for (std::size_t k = 0; k < boxes_.size(); ++k)
    for (std::size_t a = 0; a < 3; ++a) {
      const std::size_t first = slab(boxes_[k].low[a]), last = slab(boxes_[k].high[a]);
      const std::size_t base = a * std::size_t(slabs_) * words_ + k / 64;
      const std::uint64_t bit = 1ull << (k % 64);
      for (std::size_t i = first; i < std::size_t(slabs_); ++i) starts_[base + i * words_] |= bit;
      for (std::size_t i = 0; i <= last; ++i) ends_[base + i * words_] |= bit;
    }
}

void BlockSight::add_sides(const std::array<float, 3>* points, std::size_t count, Words& front,
                           Words& back) const {
  OILSKIN_ASSERT(count > 0);
  for (std::size_t w = 0; w < words_; ++w) {
    std::uint64_t all_front = ~0ull, all_back = ~0ull;
    for (std::size_t i = 0; i < count; ++i) {
      const float x = points[i][0], y = points[i][1], z = points[i][2];
      std::uint64_t in_front = 0, behind = 0;
      for (std::size_t b = 0; b < 64; b += 8) {
        const std::size_t at = 64 * w + b;
        const Lanes s = Lanes::load(&normal_x_[at]) * x + Lanes::load(&normal_y_[at]) * y +
                        Lanes::load(&normal_z_[at]) * z - Lanes::load(&offset_[at]);
        in_front |= std::uint64_t(larger(s, tolerance_)) << b;
        behind |= std::uint64_t(larger(-tolerance_, s)) << b;
      }
      all_front &= in_front;
      all_back &= behind;
    }
    front.push_back(all_front);
    back.push_back(all_back);
  }
}

bool BlockSight::may_meet(const std::array<float, 3>& low, const std::array<float, 3>& high) const {
  const std::uint64_t *x0 = starts(0, high[0]), *x1 = ends(0, low[0]), *y0 = starts(1, high[1]),
                      *y1 = ends(1, low[1]), *z0 = starts(2, high[2]), *z1 = ends(2, low[2]);
  std::uint64_t any = 0;
  for (std::size_t w = 0; w < words_; ++w) any |= x0[w] & x1[w] & y0[w] & y1[w] & z0[w] & z1[w];
  return any != 0;
}

bool BlockSight::touches(std::size_t k, const std::array<float, 3>& p, const std::array<float, 3>& q) const {
  const float x = normal_x_[k], y = normal_y_[k], z = normal_z_[k];
  const float at_p = x * p[0] + y * p[1] + z * p[2] - offset_[k],
              at_q = x * q[0] + y * q[1] + z * q[2] - offset_[k];
  if (std::min(at_p, at_q) > tolerance_ || std::max(at_p, at_q) < -tolerance_) return false;
  const FloatBox& box = boxes_[k];
  for (std::size_t a = 0; a < 3; ++a)
    if (std::max(p[a], q[a]) < box.low[a] || std::min(p[a], q[a]) > box.high[a]) return false;
  return segment_touches(Vec3(p[0], p[1], p[2]), Vec3(q[0], q[1], q[2]), corners_[k], indices_[k]);
}

bool BlockSight::hides(const std::array<float, 3>& p, const std::array<float, 3>& q,
                       const std::uint64_t* open, std::uint32_t& last) const {
  if (last < corners_.size() && (open[last / 64] >> (last % 64) & 1) && touches(last, p, q)) return true;
  for (std::size_t w = 0; w < words_; ++w)
    for (std::uint64_t bits = open[w]; bits != 0; bits &= bits - 1) {
      const std::size_t k = 64 * w + std::size_t(__builtin_ctzll(bits));
      if (k >= corners_.size() || k == last || !touches(k, p, q)) continue;
      last = static_cast<std::uint32_t>(k);
      return true;
    }
  return false;
}

}  // namespace oilskin::surface
