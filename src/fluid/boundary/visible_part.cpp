#include "fluid/boundary/visible_part.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/assert.h"

namespace oilskin::fluid {

namespace {

/// The order of numbers ≥ 0.
std::uint64_t order_of_bits(float number) {
  OILSKIN_ASSERT(number >= 0);
  number += 0.0f;  // no −0
  std::uint32_t bits = 0;
  std::memcpy(&bits, &number, sizeof bits);
  return bits;
}

/// One of 64 cells of directions: an octant and eight parts of it.
std::uint64_t direction_cell(const Eigen::Vector3f& direction) {
  std::uint64_t cell = 0;
  for (int axis = 0; axis < 3; ++axis) cell = 2 * cell + (direction[axis] > 0 ? 1 : 0);
  const Eigen::Array3f size = direction.array().abs();
  cell = 2 * cell + (size.x() > size.y() ? 1 : 0);
  cell = 2 * cell + (size.y() > size.z() ? 1 : 0);
  return 2 * cell + (size.z() > size.x() ? 1 : 0);
}

}  // namespace

void VisibleParts::add(const std::array<Eigen::Vector3f, 3>& x) {
  Occluder o{WallPlane(x), x, {}, {}, Eigen::Vector3f::Zero(), -1, 0};
  const float inwards = o.plane.offset < 0 ? -1.0f : 1.0f;
  for (std::size_t k = 0; k < 3; ++k) o.side[k] = inwards * x[k].cross(x[(k + 1) % 3]).normalized();
  const float away = o.plane.offset > 0 ? 1.0f : -1.0f;
  const Eigen::Vector3f up = away * o.plane.normal, &a = o.side[0], &b = o.side[1], &c = o.side[2];
  o.faces = {{up.x(), a.x(), b.x(), c.x()}, {up.y(), a.y(), b.y(), c.y()}, {up.z(), a.z(), b.z(), c.z()}};
  o.axis = (x[0] + x[1] + x[2]).stableNormalized();
  o.cosine = 1;
  for (const Eigen::Vector3f& corner : x) {
    const float length = corner.norm();
    o.cosine = length > 0 ? std::min(o.cosine, o.axis.dot(corner) / length) : -1;
  }
  o.sine = std::sqrt(std::max(0.0f, 1 - o.cosine * o.cosine));
  triangles_.push_back(o);
}

/// Sorts keys_, and writes which triangles they belong to.
void VisibleParts::sort_by_key(std::vector<std::size_t>& sorted) {
  for (std::size_t k = 0; k < keys_.size(); ++k) keys_[k] = keys_[k] << 32 | k;
  std::sort(keys_.begin(), keys_.end());
  sorted.resize(keys_.size());
  for (std::size_t n = 0; n < keys_.size(); ++n) sorted[n] = static_cast<std::uint32_t>(keys_[n]);
}

/// Near triangles hide most: after them little is left to cut.
void VisibleParts::sort_by_distance() {
  keys_.resize(triangles_.size());
  for (std::size_t k = 0; k < triangles_.size(); ++k) keys_[k] = order_of_bits(distance(k));
  sort_by_key(order_);
  rank_.resize(order_.size());
  for (std::size_t n = 0; n < order_.size(); ++n) rank_[order_[n]] = n;
}

/// Triangles side by side in the view share blocks, so that a quick test skips most blocks.
void VisibleParts::fill_blocks() {
  for (std::size_t k = 0; k < triangles_.size(); ++k) keys_[k] = direction_cell(triangles_[k].axis);
  sort_by_key(in_blocks_);
  blocks_.resize((in_blocks_.size() + 7) / 8);
  may_hide_.resize(blocks_.size());
  for (std::size_t n = 0; n < 8 * blocks_.size(); ++n) {
    OccluderBlock& block = blocks_[n / 8];
    const std::size_t lane = n % 8;
    block.offset[lane] = 0;  // edge-on
    if (n >= in_blocks_.size()) continue;
    const Occluder& o = triangles_[in_blocks_[n]];
    for (int axis = 0; axis < 3; ++axis) {
      block.normal[axis][lane] = o.plane.normal[axis];
      block.axis[axis][lane] = o.axis[axis];
      for (std::size_t k = 0; k < 3; ++k) {
        block.corner[k][axis][lane] = o.corners[k][axis];
        block.side[k][axis][lane] = o.side[k][axis];
      }
    }
    block.offset[lane] = o.plane.offset;
    block.cosine[lane] = o.cosine;
    block.sine[lane] = o.sine;
    block.number[lane] = static_cast<float>(in_blocks_[n]);
  }
}

void VisibleParts::arrange() {
  if (order_.size() == triangles_.size()) return;
  sort_by_distance();
  fill_blocks();
}

Occluded VisibleParts::occluded(std::size_t k) const {
  const Occluder& o = triangles_[k];
  Occluded own{};
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t c = 0; c < 3; ++c) {
      own.corner[c][axis] = o.corners[c][axis];
      own.side[c][axis] = o.side[c][axis];
    }
    own.axis[axis] = o.axis[axis];
  }
  own.cosine = o.cosine;
  own.sine = o.sine;
  own.number = static_cast<float>(k);
  return own;
}

/// Fills occluders_, near ones first. A triangle is not among its own occluders.
void VisibleParts::find_occluders(std::size_t k) {
  occluders_.clear();
  pair_kernels().hide(blocks_.data(), blocks_.size(), occluded(k), may_hide_.data());
  for (std::size_t block = 0; block < blocks_.size(); ++block)
    for (std::uint32_t bits = may_hide_[block]; bits != 0; bits &= bits - 1) {
      const std::size_t other = in_blocks_[8 * block + static_cast<std::size_t>(__builtin_ctz(bits))];
      if (other != k) occluders_.push_back(rank_[other]);
    }
  std::sort(occluders_.begin(), occluders_.end());
}

bool VisibleParts::any_may_hide() {
  arrange();
  for (std::size_t k = 0; k < triangles_.size(); ++k) {
    find_occluders(k);
    if (!occluders_.empty()) return true;
  }
  return false;
}

/// Cuts a convex piece by the plane normal · x = offset. What lies below goes to remaining_; returns the
/// rest.
VisibleParts::Piece VisibleParts::split(Piece piece, const Eigen::Vector3f& normal, float offset) {
  const std::size_t n = piece.end - piece.begin, begin = points_.size();
  if (height_.size() < n) height_.resize(n);
  for (std::size_t k = 0; k < n; ++k) height_[k] = normal.dot(points_[piece.begin + k]) - offset;
  if (below_.size() < 2 * n) below_.resize(2 * n);
  points_.resize(begin + 2 * n);
  std::size_t above = begin, below = 0;
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t next = k + 1 < n ? k + 1 : 0;
    const Eigen::Vector3f u = points_[piece.begin + k], v = points_[piece.begin + next];
    const float a = height_[k], b = height_[next];
    (a > 0 ? points_[above++] : below_[below++]) = u;
    if ((a > 0) != (b > 0)) points_[above++] = below_[below++] = u + (a / (a - b)) * (v - u);
  }
  points_.resize(above);
  if (below > 2) {
    remaining_.push_back({above, above + below});
    points_.insert(points_.end(), below_.begin(), below_.begin() + static_cast<std::ptrdiff_t>(below));
  }
  return {begin, above};
}

/// A piece with all points on one side of the occluder's plane, or of a face of its pyramid, where it is
/// seen, is left as it is: to cut such pieces by the other faces would leave thousands of pieces in crumpled
/// cloth. Faces that have all of the piece on the other side cut nothing.
void VisibleParts::subtract(const Occluder& occluder) {
  const float beyond = std::abs(occluder.plane.offset) - in_plane;
  const Eigen::Array4f seen(beyond, in_plane, in_plane, in_plane), cut(beyond, 0, 0, 0);
  remaining_.clear();
  tests_ += pieces_.size();
  for (const Piece& piece : pieces_) {
    Eigen::Array4f low = occluder.faces.heights(points_[piece.begin]), high = low;
    for (std::size_t k = piece.begin + 1; k < piece.end; ++k) {
      const Eigen::Array4f height = occluder.faces.heights(points_[k]);
      low = low.min(height);
      high = high.max(height);
    }
    if ((high <= seen).any()) {
      remaining_.push_back(piece);
      continue;
    }
    const std::size_t kept = remaining_.size();
    Piece hidden = piece;
    for (Eigen::Index face = 0; face < 4 && hidden.end - hidden.begin > 2; ++face)
      if (low[face] <= cut[face]) hidden = split(hidden, occluder.faces.normal(face), cut[face]);
    if (hidden.end - hidden.begin > 2) continue;
    // Nothing is hidden: one piece costs less than its parts.
    remaining_.resize(kept);
    remaining_.push_back(piece);
  }
  pieces_.swap(remaining_);
}

/// Leaves the pieces of the k-th triangle that are seen. False if it takes too many tests.
bool VisibleParts::cut_triangle(std::size_t k, std::size_t most_tests) {
  points_.assign(triangles_[k].corners.begin(), triangles_[k].corners.end());
  pieces_.assign(1, {0, 3});
  find_occluders(k);
  for (const std::size_t n : occluders_) {
    if (pieces_.empty()) return true;
    if (tests_ >= most_tests) return false;
    subtract(triangles_[order_[n]]);
  }
  return true;
}

bool VisibleParts::cast_shadows(std::size_t k, std::size_t most_tests) {
  if (!cut_triangle(k, most_tests)) return false;
  for (const Piece& p : pieces_)
    shadows_.add(triangles_[k].plane, {points_.data() + p.begin, p.end - p.begin});
  return true;
}

void VisibleParts::find_views() {
  shadows_.integrate();
  for (std::size_t k = 0, piece = 0; k < triangles_.size(); ++k) {
    if (piece == pieces_end_[k]) continue;
    float shadow = 0;
    for (; piece < pieces_end_[k]; ++piece) shadow += shadows_[piece];
    views_[k] = view_with_shadow(triangles_[k].plane, shadow);
  }
}

}  // namespace oilskin::fluid
