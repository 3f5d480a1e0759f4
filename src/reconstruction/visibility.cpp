#include "reconstruction/visibility.h"

#include <algorithm>
#include <cmath>

#include "core/assert.h"
#include "core/segment_triangle.h"
#include "core/simd.h"

namespace oilskin::reconstruction {

using simd::F8;

bool hides_segment(const Vec3& p, const Vec3& q, const Corners& c, const Triangle& indices) {
  const Vec3 normal = (c[1] - c[0]).cross(c[2] - c[0]);
  if (!(normal.squaredNorm() > 0)) return false;
  return segment_touches(p, q, c, indices, normal, normal.dot(p - c[0]), normal.dot(q - c[0]));
}

void BlockVisibility::set(const Obstacles& obstacles, const std::vector<std::uint32_t>& triangles,
                          const Vec3& origin, double cell, double margin) {
  OILSKIN_ASSERT(margin >= 0 && cell > 0);
  for (std::vector<float>* v : {&normal_x_, &normal_y_, &normal_z_, &offset_}) v->clear();
  boxes_.clear();
  corners_.clear();
  indices_.clear();
  margin_ = static_cast<float>(std::ceil(margin) + 1);
  slabs_ = side + 2 * static_cast<int>(margin_);
  // Exceeds the rounding error of a distance from a plane in floats. Points closer to a plane are tested in
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

void BlockVisibility::fill_slabs() {
  starts_.assign(3 * std::size_t(slabs_) * words_, 0);
  ends_.assign(starts_.size(), 0);
  for (std::size_t k = 0; k < boxes_.size(); ++k)
    for (std::size_t a = 0; a < 3; ++a) {
      const std::size_t first = slab(boxes_[k].low[a]), last = slab(boxes_[k].high[a]);
      const std::size_t base = a * std::size_t(slabs_) * words_ + k / 64;
      const std::uint64_t bit = 1ull << (k % 64);
      starts_[base + first * words_] |= bit;
      ends_[base + last * words_] |= bit;
    }
  // What begins in a slab has begun in those after it; what ends in one has not ended in those before it.
  const std::size_t of_axis = std::size_t(slabs_) * words_;
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t w = words_; w < of_axis; ++w) {
      starts_[a * of_axis + w] |= starts_[a * of_axis + w - words_];
      const std::size_t back = (a + 1) * of_axis - 1 - w;
      ends_[back] |= ends_[back + words_];
    }
}

void BlockVisibility::sides(const std::array<float, 3>& point, Words& front, Words& back) const {
  front.assign(words_, 0);
  back.assign(words_, 0);
  for (std::size_t at = 0; at < 64 * words_; at += 8) {
    const F8 s = F8::load(&normal_x_[at]) * point[0] + F8::load(&normal_y_[at]) * point[1] +
                 F8::load(&normal_z_[at]) * point[2] - F8::load(&offset_[at]);
    front[at / 64] |= std::uint64_t(greater_mask(s, tolerance_)) << at % 64;
    back[at / 64] |= std::uint64_t(greater_mask(-tolerance_, s)) << at % 64;
  }
}

void BlockVisibility::row_sides(Words& front, Words& back) const {
  front.assign(side * side * words_, 0);
  back.assign(side * side * words_, 0);
  for (std::size_t at = 0; at < 64 * words_; at += 8) {
    const F8 x = F8::load(&normal_x_[at]) * (side - 1.0f), y = F8::load(&normal_y_[at]),
             z = F8::load(&normal_z_[at]), offset = F8::load(&offset_[at]);
    // A row is straight, so its ends decide for all of it.
    const F8 low = smaller(x, 0.0f) - offset, high = larger(x, 0.0f) - offset;
    for (int k = 0; k < side; ++k)
      for (int j = 0; j < side; ++j) {
        const F8 s = y * static_cast<float>(j) + z * static_cast<float>(k);
        const std::size_t word = std::size_t(j + side * k) * words_ + at / 64;
        front[word] |= std::uint64_t(greater_mask(s + low, tolerance_)) << at % 64;
        back[word] |= std::uint64_t(greater_mask(-tolerance_, s + high)) << at % 64;
      }
  }
}

bool BlockVisibility::may_overlap(const std::array<float, 3>& low, const std::array<float, 3>& high) const {
  const std::uint64_t *x0 = starts(0, high[0]), *x1 = ends(0, low[0]), *y0 = starts(1, high[1]),
                      *y1 = ends(1, low[1]), *z0 = starts(2, high[2]), *z1 = ends(2, low[2]);
  std::uint64_t any = 0;
  for (std::size_t w = 0; w < words_; ++w) any |= x0[w] & x1[w] & y0[w] & y1[w] & z0[w] & z1[w];
  return any != 0;
}

bool BlockVisibility::touches(std::size_t k, const std::array<float, 3>& p,
                              const std::array<float, 3>& q) const {
  const float x = normal_x_[k], y = normal_y_[k], z = normal_z_[k];
  const float at_p = x * p[0] + y * p[1] + z * p[2] - offset_[k],
              at_q = x * q[0] + y * q[1] + z * q[2] - offset_[k];
  if (std::min(at_p, at_q) > tolerance_ || std::max(at_p, at_q) < -tolerance_) return false;
  const FloatBox& box = boxes_[k];
  for (std::size_t a = 0; a < 3; ++a)
    if (std::max(p[a], q[a]) < box.low[a] || std::min(p[a], q[a]) > box.high[a]) return false;
  return hides_segment(Vec3(p[0], p[1], p[2]), Vec3(q[0], q[1], q[2]), corners_[k], indices_[k]);
}

bool BlockVisibility::hides(const std::array<float, 3>& p, const std::array<float, 3>& q,
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

void Shadows::set(const BlockVisibility& visibility, const std::array<float, 3>& particle) {
  visibility_ = &visibility;
  particle_ = particle;
  if (++particle_number_ == 0) shadows_.clear();
  if (shadows_.size() < visibility.size()) shadows_.resize(visibility.size(), Shadow{{}, 0, 0, 0});
}

const Shadows::Shadow& Shadows::shadow(std::size_t triangle) {
  Shadow& s = shadows_[triangle];
  if (s.particle_number == particle_number_) return s;
  s.particle_number = particle_number_;
  using Vec3f = Eigen::Vector3f;
  const Vec3f p(particle_[0], particle_[1], particle_[2]);
  const Corners& at = visibility_->corners(triangle);
  const Vec3f a = at[0].cast<float>() - p, b = at[1].cast<float>() - p, c = at[2].cast<float>() - p;
  const Vec3f normal[3] = {a.cross(b), b.cross(c), c.cross(a)};
  const float size = std::max({a.cwiseAbs().maxCoeff(), b.cwiseAbs().maxCoeff(), c.cwiseAbs().maxCoeff()});
  const float volume = a.dot(normal[1]), sign = volume < 0 ? -1.0f : 1.0f;
  for (std::size_t e = 0; e < 3; ++e)
    for (int k = 0; k < 3; ++k) s.normal[e][k] = sign * normal[e][k];
  s.volume = std::abs(volume);
  // Corners are within `size` of the particle, nodes within a few blocks.
  s.tolerance = 1e-5f * size * (size + 4 * side) * side;
  // A particle in the plane, or a triangle too large for floats: nothing is certain.
  if (!(s.volume > s.tolerance) || !(size < 1e6f)) s.tolerance = std::numeric_limits<float>::infinity();
  return s;
}

std::uint32_t Shadows::hidden(int j, int k, std::uint32_t queried, const std::uint64_t* open) {
  const float dy = static_cast<float>(j) - particle_[1], dz = static_cast<float>(k) - particle_[2];
  const F8 dx = F8::load(row_nodes) - particle_[0];
  std::uint32_t hidden = 0;
  for (std::size_t w = 0; w < visibility_->words(); ++w)
    for (std::uint64_t bits = open[w]; bits != 0; bits &= bits - 1) {
      const std::size_t triangle = 64 * w + std::size_t(__builtin_ctzll(bits));
      if (triangle >= visibility_->size()) break;
      const Shadow& s = shadow(triangle);
      const auto form = [&](int e) {
        return dx * s.normal[e][0] + (s.normal[e][1] * dy + s.normal[e][2] * dz);
      };
      const F8 f0 = form(0), f1 = form(1), f2 = form(2);
      const F8 smallest = smaller(smaller(f0, f1), smaller(f2, f0 + f1 + f2 - s.volume));
      const std::uint32_t in = greater_mask(smallest, s.tolerance),
                          out = greater_mask(-s.tolerance, smallest);
      hidden |= in;
      for (std::uint32_t undecided = queried & ~(hidden | out); undecided != 0; undecided &= undecided - 1) {
        const int i = __builtin_ctz(undecided);
        if (visibility_->touches(triangle, {float(i), float(j), float(k)}, particle_)) hidden |= 1u << i;
      }
      if ((queried & ~hidden) == 0) return queried;
    }
  return queried & hidden;
}

}  // namespace oilskin::reconstruction
