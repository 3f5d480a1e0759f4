#include "fluid/boundary/near_triangles.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/assert.h"

namespace oilskin::fluid {

namespace {

/// Bounds in float are widened by this much, relative to the numbers in them.
constexpr double rounding = 1e-5;

/// Triangles that share the closest point have distances that differ by less, relative to them.
constexpr double same_distance = 1 + 1e-9;

}  // namespace

void CellTriangles::resize(std::size_t count) {
  count_ = count;
  number_.resize(count + 16);
  for (std::vector<float>& column : column_) column.resize(count + 8);
  for (std::size_t k = count; k < count + 8; ++k) column_[3][k] = -1;  // no place is in the sphere
}

void CellTriangles::read(const TriangleCells& cells, const TriangleCells::Cell& cell, double support_radius) {
  cells_ = &cells;
  support_radius_ = support_radius;
  origin_ = 0.5 * (cell.box.min + cell.box.max);
  slack_ = rounding * (1 + (cell.box.max - cell.box.min).norm() / support_radius_);
  const Span<const std::uint32_t> near = cells.triangles_of(cell);
  resize(near.size());
  std::size_t count = 0;
  for (const std::uint32_t t : near) {
    if (cells.triangles()[t].is_duplicate) continue;
    number_[count] = t;
    write(count++, cells.triangles()[t], Eigen::Map<const Vec3>(cells.corners()[t].x));
  }
  resize(count);
}

void CellTriangles::write(std::size_t k, const NearbyTriangle& triangle, const Vec3& corner) {
  const Vec3 middle = (triangle.middle - origin_) / support_radius_;
  const Vec3 normal = triangle.cross_norm > 0 ? Vec3(triangle.cross / triangle.cross_norm) : Vec3::Zero();
  const double radius = (triangle_reach + triangle.size / support_radius_) * (1 + rounding) + slack_;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    column_[axis][k] = static_cast<float>(middle[static_cast<int>(axis)]);
    column_[4 + axis][k] = static_cast<float>(normal[static_cast<int>(axis)]);
  }
  column_[3][k] = static_cast<float>(radius * radius);
  column_[7][k] = static_cast<float>(normal.dot(corner - origin_) / support_radius_);
}

std::size_t CellTriangles::find(const Vec3& x, double plane_reach, std::vector<std::uint32_t>& found) const {
  const Eigen::Vector3f place = ((x - origin_) / support_radius_).cast<float>();
  const auto& c = column_;
  const TriangleColumns columns = {c[0].data(), c[1].data(), c[2].data(), c[3].data(),    c[4].data(),
                                   c[5].data(), c[6].data(), c[7].data(), number_.data(), count_};
  if (found.size() < count_ + 8) found.resize(count_ + 8);
  const auto reach = static_cast<float>(plane_reach / support_radius_ * (1 + rounding) + slack_);
  return pair_kernels().touching(columns, place.data(), reach, found.data());
}

void NearTriangles::find(const CellTriangles& cell, const Vec3& x, double plane_reach) {
  at_.clear();
  triangles_ = cell.cells().triangles().data();
  corners_ = cell.cells().corners();
  const std::size_t count = cell.find(x, plane_reach, index_), blocks = (count + 3) / 4;
  if (count == 0) return;
  for (std::size_t k = count; k < 4 * blocks; ++k) index_[k] = index_[0];
  if (blocks_.size() < blocks) blocks_.resize(blocks);
  pair_kernels().closest(corners_, index_.data(), count, x.data(), blocks_.data());
  const double radius = triangle_reach * cell.support_radius(), reach2 = plane_reach * plane_reach;
  for (std::uint32_t k = 0; k < count; ++k)
    if (blocks_[k / 4].distance[k % 4] < radius && blocks_[k / 4].height2[k % 4] < reach2) at_.push_back(k);
}

double NearTriangles::side(std::size_t k, const Vec3& x) const {
  return triangle(k).cross.dot(x - Eigen::Map<const Vec3>(corners(k).x));
}

/// Null for a triangle without a closed part.
NearTriangles::ClosedPart* NearTriangles::closed_part(std::size_t k) {
  const NearbyTriangle& t = triangle(k);
  if (t.closed_part == MeshTopology::none) return nullptr;
  const auto found = std::find_if(closed_.begin(), closed_.end(), [&](const ClosedPart& c) {
    return c.surface == t.surface && c.part == t.closed_part;
  });
  if (found != closed_.end()) return &*found;
  closed_.push_back({t.surface, t.closed_part, std::numeric_limits<double>::infinity(), false, false});
  return &closed_.back();
}

/// At an edge or a corner all triangles there are nearest. A particle outside a convex edge, and
/// one inside a concave one, is on the same side of all; where it is not, its side stays unknown.
void NearTriangles::find_closed_parts(const Vec3& x) {
  closed_.clear();
  for (std::size_t k = 0; k < size(); ++k)
    if (ClosedPart* const part = closed_part(k)) part->distance = std::min(part->distance, distance(k));
  for (std::size_t k = 0; k < size() && !closed_.empty(); ++k) {
    ClosedPart* const part = closed_part(k);
    if (part == nullptr || distance(k) > same_distance * part->distance) continue;
    part->front |= side(k, x) >= 0;
    part->back |= side(k, x) <= 0;
  }
}

void NearTriangles::drop_turned_away(const Vec3& x) {
  find_closed_parts(x);
  if (closed_.empty()) return;
  std::size_t kept = 0;
  for (std::size_t k = 0; k < size(); ++k) {
    const ClosedPart* const part = closed_part(k);
    const bool is_known = part != nullptr && part->front != part->back;
    if (is_known && (part->front ? side(k, x) < 0 : side(k, x) > 0)) continue;
    at_[kept++] = at_[k];
  }
  at_.resize(kept);
}

}  // namespace oilskin::fluid
