#include "fluid/boundary/point_walls.h"

#include "core/assert.h"

namespace oilskin::fluid {

namespace {

/// How much a sheet may bend within H and still count as the plane through its closest point: cosine between
/// normals, and distance of its points from the plane [H].
constexpr double plane_cosine = 0.996, plane_distance = 0.06;

/// λ_i above this multiple of the nearest plane's means that walls may be hidden behind others.
constexpr float max_plane_ratio = 1.05f;

const NearTriangle& nearest_of(Span<const NearTriangle> near) {
  OILSKIN_ASSERT(!near.empty());
  return *std::min_element(near.begin(), near.end(), [](const NearTriangle& a, const NearTriangle& b) {
    return a.closest.distance < b.closest.distance;
  });
}

}  // namespace

PointWalls::PointWalls(const BoundaryInput& input, const MirrorImage& image, Span<const NearTriangle> near,
                       WallPoint& point, std::vector<Wall>& walls)
    : input_(input),
      image_(image),
      near_(near),
      nearest_(nearest_of(near)),
      x_(input.x[point.particle]),
      point_(point),
      walls_(walls) {
  point_.begin = point_.end = static_cast<std::uint32_t>(walls_.size());
  point_.reset_sums();
}

bool PointWalls::find_unhidden(VisibleParts& parts) {
  if (nearest_.closest.distance > 0 && is_plane()) {
    add_plane();
  } else {
    if (may_be_hidden()) return false;
    add_triangles();
    if (point_.lambda > max_plane_ratio * image_.lambda(nearest_distance(), 1) && any_hides(parts)) {
      walls_.resize(point_.begin);
      return false;
    }
    limit_density();
  }
  point_.end = static_cast<std::uint32_t>(walls_.size());
  return true;
}

void PointWalls::find_visible(VisibleParts& parts) {
  parts.clear();
  for (const NearTriangle& n : near_) parts.add(corners(n));
  for (std::size_t k = 0; k < near_.size(); ++k)
    if (image_.reaches(parts.distance(k))) add(near_[k], parts.view(k));
  limit_density();
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

/// Of the triangles whose plane is within reach: a roll of cloth hides its outer layers.
bool PointWalls::any_hides(VisibleParts& parts) const {
  parts.clear();
  for (const NearTriangle& n : near_) parts.add(corners(n));
  return parts.any_may_hide();
}

/// Sheets apart from each other may hide each other; a connected sheet hides itself behind an edge at which
/// it turns its other side to the particle.
bool PointWalls::may_be_hidden() const {
  const std::uint32_t part = input_.topologies[nearest_.surface]->part(nearest_.triangle);
  return std::any_of(near_.begin(), near_.end(), [&](const NearTriangle& n) {
    return n.surface != nearest_.surface || input_.topologies[n.surface]->part(n.triangle) != part ||
           may_be_hidden(n);
  });
}

bool PointWalls::may_be_hidden(const NearTriangle& near) const {
  const MeshTopology& topology = *input_.topologies[near.surface];
  const double own = side(near, near.triangle);
  constexpr std::uint8_t face = 7;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t other = topology.neighbour(near.triangle, k);
    if (other == MeshTopology::none) {
      if (near.closest.feature != face) return true;
      continue;
    }
    const double turned = topology.is_oriented_like(near.triangle, k) ? 1 : -1;
    if (!(own * turned * side(near, other) > 0)) return true;
  }
  return false;
}

/// Its sign says on which side of a triangle of the surface of `near` the particle is.
double PointWalls::side(const NearTriangle& near, std::uint32_t triangle) const {
  const SurfaceMotion& s = *input_.surfaces[near.surface];
  const Triangle& t = s.triangles[triangle];
  const Vec3& a = s.x_t0[t[0]];
  return (s.x_t0[t[1]] - a).cross(s.x_t0[t[2]] - a).dot(x_ - a);
}

void PointWalls::add_plane() {
  WallView plane;
  plane.distance = nearest_distance();
  plane.share = 1;
  plane.normal = (nearest_.closest.offset / nearest_.closest.distance).cast<float>();
  add(nearest_, plane);
}

void PointWalls::add_triangles() {
  for (const NearTriangle& n : near_) add(n, view_of_wall(corners(n)));
}

std::array<Eigen::Vector3f, 3> PointWalls::corners(const NearTriangle& near) const {
  const SurfaceMotion& s = *input_.surfaces[near.surface];
  std::array<Eigen::Vector3f, 3> x;
  for (std::size_t k = 0; k < 3; ++k)
    x[k] = ((s.x_t0[s.triangles[near.triangle][k]] - x_) / input_.support_radius).cast<float>();
  return x;
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
  wall.covered = view.share;
  wall.normal = view.normal;
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

}  // namespace oilskin::fluid
