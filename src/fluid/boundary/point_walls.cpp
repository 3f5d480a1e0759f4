#include "fluid/boundary/point_walls.h"

#include "core/assert.h"

namespace oilskin::fluid {

namespace {

/// How much a sheet may bend within H and still count as the plane through its closest point: cosine between
/// normals, and distance of its points from the plane [H].
constexpr double plane_cosine = 0.996, plane_distance = 0.06;

/// λ_i above this multiple of the nearest plane's means that walls may be hidden behind others.
constexpr float max_plane_ratio = 1.05f;

/// Walls whose λ and |γ| are less than this part of the largest ones are left out, and the others are scaled.
/// In folds they are half of all walls, and have 3·10⁻³ of λ together.
constexpr float faint = 3e-3f;

}  // namespace

/// Most points see the whole of each triangle near them, which a test of the neighbours in the mesh shows.
/// For the others all triangles within triangle_reach are searched, as those whose plane is out of reach
/// hide, too.
bool PointWalls::find() {
  point_.begin = static_cast<std::uint32_t>(walls_.size());
  near_.find(cell_, x_, image_.reach(input_.support_radius));
  if (near_.empty()) return false;
  point_.reset_sums();
  nearest_ = nearest();
  if (!find_unhidden()) {
    walls_.resize(point_.begin);
    point_.reset_sums();
    near_.find(cell_, x_, input_.support_radius);
    near_.drop_turned_away(x_);
    find_visible();
  }
  leave_out_faint_walls();
  take_off_what_both_count();
  limit_density();
  point_.end = static_cast<std::uint32_t>(walls_.size());
  return true;
}

void PointWalls::leave_out_faint_walls() {
  const auto begin = walls_.begin() + point_.begin;
  float lambda = 0, push = 0, kept = 0;  // the largest, the largest, the sum of λ
  for (auto wall = begin; wall != walls_.end(); ++wall) {
    lambda = std::max(lambda, wall->lambda);
    push = std::max(push, wall->gamma.norm());
  }
  const auto is_faint = [&](const Wall& w) {
    return w.lambda < faint * lambda && w.gamma.norm() < faint * push;
  };
  walls_.erase(std::remove_if(begin, walls_.end(), is_faint), walls_.end());
  for (auto wall = begin; wall != walls_.end(); ++wall) kept += wall->lambda;
  if (!(kept > 0)) return;
  const float scale = point_.lambda / kept;
  point_.reset_sums();
  for (auto wall = begin; wall != walls_.end(); ++wall) {
    wall->gamma *= scale;
    wall->lambda *= scale;
    point_.add(wall->lambda, wall->gamma, wall->depth);
  }
}

/// Walls that face each other both count what a slot between them does not hold (B.42). The sum over pairs of
/// λ_a λ_b (n² − n)/2, n = n_a·n_b, by its moments.
void PointWalls::take_off_what_both_count() {
  if (walls_.size() - point_.begin < 2) return;
  Eigen::Matrix3f second = Eigen::Matrix3f::Zero();
  Eigen::Vector3f first = Eigen::Vector3f::Zero();
  for (auto wall = walls_.begin() + point_.begin; wall != walls_.end(); ++wall) {
    second += wall->lambda * wall->normal * wall->normal.transpose();
    first += wall->lambda * wall->normal;
  }
  const float facing = 0.25f * (second.squaredNorm() - first.squaredNorm());
  point_.lambda = std::max(0.0f, point_.lambda - image_.both() * std::max(0.0f, facing));
}

std::size_t PointWalls::nearest() const {
  std::size_t best = 0;
  for (std::size_t k = 1; k < near_.size(); ++k)
    if (near_.distance(k) < near_.distance(best)) best = k;
  return best;
}

/// Of the triangles whose plane is within reach. False if the particle may see one of them in part only; then
/// it may leave walls.
bool PointWalls::find_unhidden() {
  if (near_.distance(nearest_) > 0 && is_plane()) {
    add_plane();
    return true;
  }
  if (may_be_hidden()) return false;
  add_triangles();
  if (point_.lambda > max_plane_ratio * image_.lambda(nearest_distance(), 1)) {
    add_to_parts();  // a roll of cloth hides its outer layers
    if (parts_.any_may_hide()) return false;
  }
  return true;
}

/// Of all triangles within triangle_reach.
void PointWalls::find_visible() {
  add_to_parts();
  const std::vector<WallView>& views =
      parts_.views([&](std::size_t k) { return image_.reaches(parts_.distance(k)); });
  for (std::size_t k = 0; k < near_.size(); ++k) add(k, views[k]);
}

void PointWalls::add_to_parts() {
  parts_.clear();
  for (std::size_t k = 0; k < near_.size(); ++k) parts_.add(corners(k));
}

/// Are the triangles near the particle one plane sheet without a border?
bool PointWalls::is_plane() const {
  const double distance = near_.distance(nearest_), tolerance = plane_distance * input_.support_radius;
  const Vec3 normal = near_.offset(nearest_) / distance;
  const std::uint32_t surface = near_.triangle(nearest_).surface;
  for (std::size_t k = 0; k < near_.size(); ++k) {
    const NearbyTriangle& t = near_.triangle(k);
    if (t.surface != surface || t.is_at_border) return false;
    if (!(std::abs(t.cross.dot(normal)) >= plane_cosine * t.cross_norm)) return false;
    // Another layer has the same normal, but lies off the plane.
    if (std::abs(near_.offset(k).dot(normal) - distance) > tolerance) return false;
  }
  return true;
}

/// Sheets apart from each other may hide each other; a connected sheet hides itself behind an edge at which
/// it turns its other side to the particle.
bool PointWalls::may_be_hidden() const {
  const NearbyTriangle& nearest = near_.triangle(nearest_);
  const std::uint32_t part = input_.topologies[nearest.surface]->part(nearest.triangle);
  for (std::size_t k = 0; k < near_.size(); ++k) {
    const NearbyTriangle& t = near_.triangle(k);
    if (t.surface != nearest.surface || input_.topologies[t.surface]->part(t.triangle) != part ||
        may_be_hidden(k))
      return true;
  }
  return false;
}

bool PointWalls::may_be_hidden(std::size_t k) const {
  const NearbyTriangle& t = near_.triangle(k);
  const MeshTopology& topology = *input_.topologies[t.surface];
  const SurfaceMotion& surface = *input_.surfaces[t.surface];
  const double own = near_.side(k, x_);
  for (std::size_t edge = 0; edge < 3; ++edge) {
    const std::uint32_t other = topology.neighbour(t.triangle, edge);
    if (other == MeshTopology::none) {
      if (!near_.is_on_face(k)) return true;
      continue;
    }
    const double turned = topology.is_oriented_like(t.triangle, edge) ? 1 : -1;
    if (!(own * turned * side(surface, other) > 0)) return true;
  }
  return false;
}

/// NearTriangles::side() of a triangle that may not be near.
double PointWalls::side(const SurfaceMotion& surface, std::uint32_t triangle) const {
  const Triangle& t = surface.triangles[triangle];
  const Vec3& a = surface.x_t0[t[0]];
  return (surface.x_t0[t[1]] - a).cross(surface.x_t0[t[2]] - a).dot(x_ - a);
}

void PointWalls::add_plane() {
  WallView plane;
  plane.distance = nearest_distance();
  plane.share = 1;
  plane.normal = (near_.offset(nearest_) / near_.distance(nearest_)).cast<float>();
  add(nearest_, plane);
}

void PointWalls::add_triangles() {
  planes_.clear();
  shadows_.clear();
  for (std::size_t k = 0; k < near_.size(); ++k) {
    const std::array<Eigen::Vector3f, 3> x = corners(k);
    planes_.emplace_back(x);
    if (planes_.back().acts()) shadows_.add(planes_.back(), {x.data(), 3});
  }
  shadows_.integrate();
  for (std::size_t k = 0, shadow = 0; k < near_.size(); ++k)
    if (planes_[k].acts()) add(k, view_with_shadow(planes_[k], shadows_[shadow++]));
}

std::array<Eigen::Vector3f, 3> PointWalls::corners(std::size_t k) const {
  const double(&corner)[9] = near_.corners(k).x;
  std::array<Eigen::Vector3f, 3> x;
  for (std::size_t c = 0; c < 3; ++c)
    x[c] = ((Vec3(corner[3 * c], corner[3 * c + 1], corner[3 * c + 2]) - x_) / input_.support_radius)
               .cast<float>();
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

void PointWalls::add(std::size_t k, const WallView& view) {
  if (!image_.reaches(view.distance) || !(view.share > 0)) return;
  const NearbyTriangle& triangle = near_.triangle(k);
  Wall wall;
  wall.surface = triangle.surface;
  wall.triangle = triangle.triangle;
  wall.weight = {static_cast<float>(near_.weight(k, 0)), static_cast<float>(near_.weight(k, 1))};
  wall.gamma = image_.gamma(view.distance, view.share) * view.normal;
  wall.lambda = image_.lambda(view.distance, view.share);
  wall.distance = view.distance;
  wall.covered = view.share;
  wall.normal = view.normal;
  // At cloth that follows the fluid the hydrostatic correction would feed oscillations
  // (docs/theory/boundary.md 6).
  wall.depth = triangle.has_free_node ? 0 : -view.distance * view.normal.dot(input_.down.cast<float>());
  OILSKIN_ASSERT(wall.lambda >= 0 && wall.gamma.allFinite());
  walls_.push_back(wall);
  point_.add(wall.lambda, wall.gamma, wall.depth);
}

}  // namespace oilskin::fluid
