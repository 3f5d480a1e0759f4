#include "fluid/boundary/wall_geometry.h"

#include "core/assert.h"
#include "fluid/boundary/point_walls.h"

namespace oilskin::fluid {

namespace {

constexpr std::size_t point_chunk = 256;

/// Walls whose normals are within this angle are one plane for images (cosine).
constexpr float same_direction = 0.9f;

std::size_t chunks_of(std::size_t points) {
  return (points + point_chunk - 1) / point_chunk;
}

}  // namespace

void WallGeometry::clear() {
  points_.clear();
  walls_.clear();
  point_of_.clear();
}

/// Most points see the whole of each triangle near them, which a test of the neighbours in the mesh shows.
/// For the others all triangles within H are searched, as those whose plane is out of reach hide, too.
void WallGeometry::find(const BoundaryInput& input, const Workers& workers) {
  clear();
  const auto unhidden = find_unhidden(input, workers);
  join(unhidden, find_partly_hidden(input, workers));
  collect_images();
}

std::vector<std::vector<Wall>> WallGeometry::find_unhidden(const BoundaryInput& input,
                                                           const Workers& workers) {
  near_.find(input, image_.reach(input.support_radius), {}, workers);
  number_points(input.x.size());
  std::vector<std::vector<Wall>> walls(chunks_of(points_.size()));
  std::vector<std::uint8_t> is_partly(points_.size());
  workers.for_chunks(points_.size(), point_chunk, [&](std::size_t b, std::size_t e, std::size_t c) {
    VisibleParts parts;
    for (std::size_t k = b; k < e; ++k) {
      PointWalls point(input, image_, near_.of(points_[k].particle), points_[k], walls[c]);
      is_partly[k] = !point.find_unhidden(parts);
    }
  });
  partly_.clear();
  for (std::uint32_t k = 0; k < points_.size(); ++k)
    if (is_partly[k]) partly_.push_back(k);
  return walls;
}

std::vector<std::vector<Wall>> WallGeometry::find_partly_hidden(const BoundaryInput& input,
                                                                const Workers& workers) {
  std::vector<std::vector<Wall>> walls(chunks_of(partly_.size()));
  if (partly_.empty()) return walls;
  std::vector<std::uint8_t> marks(input.x.size());
  for (std::uint32_t k : partly_) marks[points_[k].particle] = 1;
  near_.find(input, input.support_radius, marks, workers);
  workers.for_chunks(partly_.size(), point_chunk, [&](std::size_t b, std::size_t e, std::size_t c) {
    VisibleParts parts;
    for (std::size_t k = b; k < e; ++k) {
      WallPoint& point = points_[partly_[k]];
      PointWalls(input, image_, near_.of(point.particle), point, walls[c]).find_visible(parts);
    }
  });
  return walls;
}

void WallGeometry::number_points(std::size_t particles) {
  point_of_.assign(particles, none);
  for (std::uint32_t i = 0; i < particles; ++i) {
    if (near_.of(i).empty()) continue;
    point_of_[i] = static_cast<std::uint32_t>(points_.size());
    points_.emplace_back();
    points_.back().particle = i;
  }
}

/// Makes the points' ranges of walls, which count from the start of a chunk, refer to the list of all.
void WallGeometry::join(const std::vector<std::vector<Wall>>& unhidden,
                        const std::vector<std::vector<Wall>>& hidden) {
  std::size_t next = 0;  // in partly_
  for (std::uint32_t k = 0; k < points_.size(); ++k) {
    WallPoint& point = points_[k];
    const bool is_partly = next < partly_.size() && partly_[next] == k;
    const std::vector<Wall>& from = is_partly ? hidden[next / point_chunk] : unhidden[k / point_chunk];
    if (is_partly) ++next;
    const auto begin = static_cast<std::uint32_t>(walls_.size());
    walls_.insert(walls_.end(), from.begin() + point.begin, from.begin() + point.end);
    point.begin = begin;
    point.end = static_cast<std::uint32_t>(walls_.size());
    for (std::uint32_t w = point.begin; w < point.end; ++w) walls_[w].point = k;
  }
  OILSKIN_ASSERT(next == partly_.size());
}

/// The walls of each point, those of about one direction together: means by share.
void WallGeometry::collect_images() {
  images_.clear();
  images_begin_.assign(1, 0);
  for (const WallPoint& point : points_) {
    const std::size_t first = images_.size();
    for (std::uint32_t w = point.begin; w < point.end; ++w) {
      const Wall& wall = walls_[w];
      const auto same = std::find_if(
          images_.begin() + static_cast<std::ptrdiff_t>(first), images_.end(),
          [&](const ImagePlane& p) { return p.normal.dot(wall.normal) > same_direction * p.normal.norm(); });
      ImagePlane& plane = same != images_.end() ? *same : images_.emplace_back();
      plane.normal += wall.covered * wall.normal;
      plane.distance += wall.covered * wall.distance;
      plane.share += wall.covered;
    }
    for (std::size_t k = first; k < images_.size(); ++k) {
      ImagePlane& plane = images_[k];
      plane.normal.normalize();
      plane.distance /= plane.share;
      plane.share = std::min(plane.share, 1.0f);
    }
    images_begin_.push_back(static_cast<std::uint32_t>(images_.size()));
  }
}

}  // namespace oilskin::fluid
