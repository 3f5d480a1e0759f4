#include "fluid/boundary/visible_part.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/assert.h"

namespace oilskin::fluid {

namespace {

/// Points nearer than this to a plane count as in it [H].
constexpr float tolerance = 1e-5f;

/// A plane nearer to the particle than this is seen edge-on and hides nothing [H].
constexpr float edge_on = 1e-5f;

/// Cones of which the cosines say that they are apart by less than this count as touching.
constexpr float rounding_of_cosines = 1e-4f;

}  // namespace

void VisibleParts::add(const std::array<Eigen::Vector3f, 3>& x) {
  Occluder o{WallPlane(x), x, {}, Eigen::Vector3f::Zero(), -1, 0};
  const float inwards = o.plane.offset < 0 ? -1.0f : 1.0f;
  for (std::size_t k = 0; k < 3; ++k) o.side[k] = inwards * x[k].cross(x[(k + 1) % 3]).normalized();
  o.axis = (x[0] + x[1] + x[2]).stableNormalized();
  o.cosine = 1;
  for (const Eigen::Vector3f& corner : x) {
    const float length = corner.norm();
    o.cosine = length > 0 ? std::min(o.cosine, o.axis.dot(corner) / length) : -1;
  }
  o.sine = std::sqrt(std::max(0.0f, 1 - o.cosine * o.cosine));
  triangles_.push_back(o);
}

/// A quick test: false only if no ray from the particle lies in both.
bool VisibleParts::cones_touch(const Occluder& a, const Occluder& b) {
  if (!(a.cosine > 0) || !(b.cosine > 0)) return true;
  return a.axis.dot(b.axis) > a.cosine * b.cosine - a.sine * b.sine - rounding_of_cosines;
}

/// A quick test, true for all pairs of which one hides a part of the other.
bool VisibleParts::may_hide(const Occluder& occluder, const Occluder& other, bool is_earlier) {
  const WallPlane& plane = occluder.plane;
  if (plane.distance() < edge_on || !cones_touch(occluder, other)) return false;
  const float toward = plane.offset > 0 ? -1.0f : 1.0f;
  std::array<float, 3> height;  // above the occluder's plane, on whose upper side the particle is
  for (std::size_t k = 0; k < 3; ++k)
    height[k] = toward * (plane.normal.dot(other.corners[k]) - plane.offset);
  const auto [lowest, highest] = std::minmax({height[0], height[1], height[2]});
  const bool lies_on_it = lowest > -tolerance && highest < tolerance;
  if (lies_on_it ? !is_earlier : lowest > -tolerance) return false;
  return std::all_of(occluder.side.begin(), occluder.side.end(), [&](const Eigen::Vector3f& side) {
    return std::max({side.dot(other.corners[0]), side.dot(other.corners[1]), side.dot(other.corners[2])}) >
           tolerance;
  });
}

bool VisibleParts::any_may_hide() const {
  for (std::size_t a = 0; a < triangles_.size(); ++a)
    for (std::size_t b = 0; b < triangles_.size(); ++b)
      if (a != b && may_hide(triangles_[a], triangles_[b], a < b)) return true;
  return false;
}

/// Cuts a convex piece by the plane normal · x = offset. What lies below goes to remaining_; returns the
/// rest.
VisibleParts::Piece VisibleParts::split(Piece piece, const Eigen::Vector3f& normal, float offset) {
  below_.clear();
  const std::size_t begin = points_.size();
  for (std::size_t k = piece.begin; k < piece.end; ++k) {
    const Eigen::Vector3f u = points_[k], v = points_[k + 1 < piece.end ? k + 1 : piece.begin];
    const float a = normal.dot(u) - offset, b = normal.dot(v) - offset;
    if (a > 0)
      points_.push_back(u);
    else
      below_.push_back(u);
    if ((a > 0) == (b > 0)) continue;
    const Eigen::Vector3f cut = u + (a / (a - b)) * (v - u);
    points_.push_back(cut);
    below_.push_back(cut);
  }
  const Piece above{begin, points_.size()};
  if (below_.size() > 2) {
    remaining_.push_back({points_.size(), points_.size() + below_.size()});
    points_.insert(points_.end(), below_.begin(), below_.end());
  }
  return above;
}

/// Is all of a piece on one side of the occluder's plane, or of a face of its pyramid, where it is seen? To
/// cut such pieces by the other faces would leave thousands of pieces in crumpled cloth.
bool VisibleParts::misses(const Occluder& occluder, const Piece& piece) const {
  const float away = occluder.plane.offset > 0 ? 1.0f : -1.0f;
  const auto all = [&](const Eigen::Vector3f& normal, float offset) {
    for (std::size_t k = piece.begin; k < piece.end; ++k)
      if (normal.dot(points_[k]) > offset) return false;
    return true;
  };
  return all(away * occluder.plane.normal, away * occluder.plane.offset - tolerance) ||
         std::any_of(occluder.side.begin(), occluder.side.end(),
                     [&](const Eigen::Vector3f& side) { return all(side, tolerance); });
}

void VisibleParts::subtract(const Occluder& occluder) {
  const float away = occluder.plane.offset > 0 ? 1.0f : -1.0f;
  remaining_.clear();
  for (const Piece& piece : pieces_) {
    if (misses(occluder, piece)) {
      remaining_.push_back(piece);
      continue;
    }
    Piece hidden = split(piece, away * occluder.plane.normal, away * occluder.plane.offset - tolerance);
    for (const Eigen::Vector3f& side : occluder.side)
      if (hidden.end - hidden.begin > 2) hidden = split(hidden, side, 0);
  }
  pieces_.swap(remaining_);
}

/// Near triangles hide most: after them little is left to cut.
void VisibleParts::sort_by_distance() {
  if (order_.size() == triangles_.size()) return;
  order_.resize(triangles_.size());
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  std::stable_sort(order_.begin(), order_.end(),
                   [&](std::size_t a, std::size_t b) { return distance(a) < distance(b); });
}

WallView VisibleParts::view(std::size_t k) {
  OILSKIN_ASSERT(k < triangles_.size());
  const Occluder& own = triangles_[k];
  if (!own.plane.acts()) return WallView();
  points_.assign(own.corners.begin(), own.corners.end());
  pieces_.assign(1, {0, 3});
  sort_by_distance();
  for (const std::size_t other : order_)
    if (!pieces_.empty() && other != k && may_hide(triangles_[other], own, other < k))
      subtract(triangles_[other]);
  float shadow = 0;
  for (const Piece& p : pieces_) shadow += shadow_of(own.plane, {points_.data() + p.begin, p.end - p.begin});
  return view_with_shadow(own.plane, shadow);
}

}  // namespace oilskin::fluid
