#include "fluid/boundary/wall_geometry.h"

#include "core/assert.h"
#include "fluid/boundary/wall_visibility.h"

namespace oilskin::fluid {

namespace {

constexpr std::size_t point_chunk = 256;

/// How much a sheet may bend within H and still count as the plane through its closest point: cosine between
/// normals, and distance of its points from the plane [H].
constexpr double plane_cosine = 0.996, plane_distance = 0.06;

/// λ_i above this multiple of the nearest plane's means that walls may be hidden behind others.
constexpr float max_plane_ratio = 1.05f;

/// Finds the walls of one point.
class PointWalls {
 public:
  PointWalls(const BoundaryInput& input, const MirrorImage& image, Span<const NearTriangle> near,
             WallPoint& point, std::vector<Wall>& walls);

  /// Appends the walls and writes their sums to the point.
  void find();

 private:
  bool is_plane() const;
  void add_plane();
  void add_triangles();
  void drop_hidden();
  void limit_density();
  void add(const NearTriangle& near, const WallView& view);
  bool has_free_node(const NearTriangle& near) const;
  float nearest_distance() const {
    return static_cast<float>(nearest_.closest.distance / input_.support_radius);
  }

  const BoundaryInput& input_;
  const MirrorImage& image_;
  const Span<const NearTriangle> near_;
  const NearTriangle& nearest_;
  const Vec3 x_;
  WallPoint& point_;
  std::vector<Wall>& walls_;
};

const NearTriangle& nearest_of(Span<const NearTriangle> near) {
  OILSKIN_ASSERT(!near.empty());
  return *std::min_element(near.begin(), near.end(), [](const NearTriangle& a, const NearTriangle& b) {
    return a.closest.distance < b.closest.distance;
  });
}

PointWalls::PointWalls(const BoundaryInput& input, const MirrorImage& image, Span<const NearTriangle> near,
                       WallPoint& point, std::vector<Wall>& walls)
    : input_(input),
      image_(image),
      near_(near),
      nearest_(nearest_of(near)),
      x_(input.x[point.particle]),
      point_(point),
      walls_(walls) {
  point_.begin = static_cast<std::uint32_t>(walls_.size());
}

void PointWalls::find() {
  if (nearest_.closest.distance > 0 && is_plane()) {
    add_plane();
  } else {
    add_triangles();
    if (point_.lambda > max_plane_ratio * image_.lambda(nearest_distance(), 1)) drop_hidden();
    limit_density();
  }
  point_.end = static_cast<std::uint32_t>(walls_.size());
}

/// Are the triangles near the particle one plane sheet without a border?
bool PointWalls::is_plane() const {
  const ClosestPoint& c = nearest_.closest;
  const Vec3 normal = c.offset / c.distance;
  const double tolerance = plane_distance * input_.support_radius;
  for (const NearTriangle& n : near_) {
    if (n.surface != nearest_.surface || input_.topologies[n.surface]->is_at_border(n.triangle)) return false;
    const SurfaceMotion& s = *input_.surfaces[n.surface];
    const Triangle& t = s.triangles[n.triangle];
    const Vec3 cross = (s.x_t0[t[1]] - s.x_t0[t[0]]).cross(s.x_t0[t[2]] - s.x_t0[t[0]]);
    if (!(std::abs(cross.dot(normal)) >= plane_cosine * cross.norm())) return false;
    // Another layer has the same normal, but lies off the plane.
    if (std::abs(n.closest.offset.dot(normal) - c.distance) > tolerance) return false;
  }
  return true;
}

void PointWalls::add_plane() {
  WallView plane;
  plane.distance = nearest_distance();
  plane.share = 1;
  plane.normal = (nearest_.closest.offset / nearest_.closest.distance).cast<float>();
  add(nearest_, plane);
}

void PointWalls::add_triangles() {
  for (const NearTriangle& n : near_) {
    const SurfaceMotion& s = *input_.surfaces[n.surface];
    std::array<Eigen::Vector3f, 3> corners;
    for (std::size_t k = 0; k < 3; ++k)
      corners[k] = ((s.x_t0[s.triangles[n.triangle][k]] - x_) / input_.support_radius).cast<float>();
    add(n, view_of_wall(corners));
  }
}

void PointWalls::drop_hidden() {
  const WallVisibility visibility(input_, x_, near_);
  point_.reset_sums();
  std::size_t kept = point_.begin, k = 0;  // walls are in the order of near_, which may have more triangles
  for (std::size_t w = point_.begin; w < walls_.size(); ++w, ++k) {
    while (near_[k].surface != walls_[w].surface || near_[k].triangle != walls_[w].triangle) ++k;
    if (visibility.is_hidden(k)) continue;
    walls_[kept] = walls_[w];
    point_.add(walls_[kept].lambda, walls_[kept].gamma, walls_[kept].depth);
    ++kept;
  }
  walls_.resize(kept);
}

/// In a narrow corner λ_i can exceed 1. Density and force are scaled together (B.10).
void PointWalls::limit_density() {
  if (point_.lambda <= 1) return;
  const float share = 1 / point_.lambda;
  point_.lambda = 1;
  point_.gamma *= share;
  point_.depth_gamma *= share;
  for (std::size_t w = point_.begin; w < walls_.size(); ++w) walls_[w].gamma *= share;
}

void PointWalls::add(const NearTriangle& near, const WallView& view) {
  if (!image_.reaches(view.distance) || !(view.share > 0)) return;
  Wall wall;
  wall.surface = near.surface;
  wall.triangle = near.triangle;
  wall.weight = {static_cast<float>(near.closest.weights[0]), static_cast<float>(near.closest.weights[1])};
  wall.gamma = image_.gamma(view.distance, view.share) * view.normal;
  wall.lambda = image_.lambda(view.distance, view.share);
  wall.distance = view.distance;
  // At cloth that follows the fluid the hydrostatic correction would feed oscillations
  // (docs/theory/boundary.md 6).
  wall.depth = has_free_node(near) ? 0 : -view.distance * view.normal.dot(input_.down.cast<float>());
  OILSKIN_ASSERT(wall.lambda >= 0 && wall.gamma.allFinite());
  walls_.push_back(wall);
  point_.add(wall.lambda, wall.gamma, wall.depth);
}

bool PointWalls::has_free_node(const NearTriangle& near) const {
  const SurfaceMotion& s = *input_.surfaces[near.surface];
  const Triangle& t = s.triangles[near.triangle];
  return std::any_of(t.begin(), t.end(), [&](std::uint32_t node) { return s.inverse_mass[node] > 0; });
}

}  // namespace

void WallGeometry::clear() {
  points_.clear();
  walls_.clear();
}

void WallGeometry::find(const BoundaryInput& input, const Workers& workers) {
  clear();
  const NearTriangles near = find_near_triangles(input, image_.reach(input.support_radius), workers);
  number_points(near, input.x.size());
  std::vector<std::vector<Wall>> walls((points_.size() + point_chunk - 1) / point_chunk);
  workers.for_chunks(points_.size(), point_chunk, [&](std::size_t b, std::size_t e, std::size_t c) {
    for (std::size_t k = b; k < e; ++k)
      PointWalls(input, image_, near.of(points_[k].particle), points_[k], walls[c]).find();
  });
  join(walls);
}

void WallGeometry::number_points(const NearTriangles& near, std::size_t particles) {
  point_of_.assign(particles, none);
  for (std::uint32_t i = 0; i < particles; ++i) {
    if (near.of(i).empty()) continue;
    point_of_[i] = static_cast<std::uint32_t>(points_.size());
    points_.emplace_back();
    points_.back().particle = i;
  }
}

/// Makes the points' ranges of walls, which count from the start of a chunk, refer to the list of all.
void WallGeometry::join(const std::vector<std::vector<Wall>>& walls_of_chunk) {
  for (std::size_t c = 0; c < walls_of_chunk.size(); ++c) {
    const auto base = static_cast<std::uint32_t>(walls_.size());
    walls_.insert(walls_.end(), walls_of_chunk[c].begin(), walls_of_chunk[c].end());
    for (std::size_t k = c * point_chunk; k < std::min(points_.size(), (c + 1) * point_chunk); ++k) {
      WallPoint& point = points_[k];
      point.begin += base;
      point.end += base;
      for (std::uint32_t w = point.begin; w < point.end; ++w) walls_[w].point = static_cast<std::uint32_t>(k);
    }
  }
}

}  // namespace oilskin::fluid
