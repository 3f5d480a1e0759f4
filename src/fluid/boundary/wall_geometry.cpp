#include "fluid/boundary/wall_geometry.h"

#include "core/assert.h"
#include "fluid/boundary/point_walls.h"

namespace oilskin::fluid {

namespace {

constexpr std::size_t cell_chunk = 4;

/// Walls whose normals are within this angle are one plane for images (cosine).
constexpr float same_direction = 0.9f;

/// The walls of a point, those of about one direction together: means by share.
void add_images(Span<const Wall> walls, std::vector<ImagePlane>& images) {
  const auto first = static_cast<std::ptrdiff_t>(images.size());
  for (const Wall& wall : walls) {
    const auto same = std::find_if(images.begin() + first, images.end(), [&](const ImagePlane& p) {
      return p.normal.dot(wall.normal) > same_direction * p.normal.norm();
    });
    ImagePlane& plane = same != images.end() ? *same : images.emplace_back();
    plane.normal += wall.covered * wall.normal;
    plane.distance += wall.covered * wall.distance;
    plane.share += wall.covered;
  }
  for (auto plane = images.begin() + first; plane != images.end(); ++plane) {
    plane->normal.normalize();
    plane->distance /= plane->share;
    plane->share = std::min(plane->share, 1.0f);
  }
}

/// What the walls hide over what lies beyond their planes: less than 1 where fluid goes around an edge
/// (B.43).
float covered_part(Span<const ImagePlane> planes) {
  float hidden = 0, beyond = 0;
  for (std::size_t a = 0; a < planes.size(); ++a) {
    const float mass = half_space_mass(planes[a].distance);
    hidden += planes[a].share * mass;
    beyond += mass;
    for (std::size_t b = 0; b < a; ++b)
      beyond -= mass * half_space_mass(planes[b].distance) * (1 + planes[a].normal.dot(planes[b].normal));
  }
  return hidden < beyond ? hidden / beyond : 1;
}

}  // namespace

void WallGeometry::clear() {
  points_.clear();  // the walls are those of no point; clearing them would make join() initialise them
  point_of_.clear();
}

void WallGeometry::find(const BoundaryInput& input, const Workers& workers) {
  OILSKIN_ASSERT(input.cells.is_found());
  const std::size_t cells = input.cells.cells().size(), parts = (cells + cell_chunk - 1) / cell_chunk;
  if (parts_.size() < parts) parts_.resize(parts);
  workers.for_chunks(cells, cell_chunk, [&](std::size_t begin, std::size_t end, std::size_t c) {
    find_part(input, begin, end, parts_[c]);
  });
  join(parts, input.x.size(), workers);
}

/// The points and walls of some cells. Indices count from the start of the part.
void WallGeometry::find_part(const BoundaryInput& input, std::size_t begin, std::size_t end,
                             Part& part) const {
  part.points.clear();
  part.walls.clear();
  part.images.clear();
  part.images_end.clear();
  if (!part.buffers) part.buffers = std::make_shared<WallBuffers>();
  WallBuffers& buffers = *part.buffers;
  CellTriangles& triangles = buffers.cell;
  for (std::size_t c = begin; c < end; ++c) {
    const TriangleCells::Cell& cell = input.cells.cells()[c];
    triangles.read(input.cells, cell, input.support_radius);
    for (std::uint32_t i = cell.begin; i < cell.end; ++i) {
      WallPoint point;
      point.particle = i;
      if (!PointWalls(input, image_, buffers, point, part.walls).find()) continue;
      const std::size_t first = part.images.size();
      add_images({part.walls.data() + point.begin, point.end - point.begin}, part.images);
      point.covered = covered_part({part.images.data() + first, part.images.size() - first});
      part.points.push_back(point);
      part.images_end.push_back(static_cast<std::uint32_t>(part.images.size()));
    }
  }
}

/// All parts in their order.
void WallGeometry::join(std::size_t parts, std::size_t particles, const Workers& workers) {
  struct Start {
    std::size_t point = 0, wall = 0, image = 0;
  };
  std::vector<Start> start(parts + 1);
  for (std::size_t c = 0; c < parts; ++c)
    start[c + 1] = {start[c].point + parts_[c].points.size(), start[c].wall + parts_[c].walls.size(),
                    start[c].image + parts_[c].images.size()};
  points_.resize(start[parts].point);
  walls_.resize(start[parts].wall);
  images_.resize(start[parts].image);
  images_begin_.resize(points_.size() + 1);
  images_begin_[0] = 0;
  point_of_.assign(particles, none);
  workers.for_each(parts, 1, [&](std::size_t c) {
    const Part& part = parts_[c];
    const auto wall = static_cast<std::uint32_t>(start[c].wall),
               image = static_cast<std::uint32_t>(start[c].image);
    std::copy(part.walls.begin(), part.walls.end(), walls_.begin() + wall);
    std::copy(part.images.begin(), part.images.end(), images_.begin() + image);
    for (std::size_t k = 0; k < part.points.size(); ++k) {
      const auto number = static_cast<std::uint32_t>(start[c].point + k);
      WallPoint& point = points_[number] = part.points[k];
      point.begin += wall;
      point.end += wall;
      for (std::uint32_t w = point.begin; w < point.end; ++w) walls_[w].point = number;
      point_of_[point.particle] = number;
      images_begin_[number + 1] = image + part.images_end[k];
    }
  });
}

}  // namespace oilskin::fluid
