#include "reconstruction/obstacles.h"

#include <algorithm>
#include <cmath>

#include "core/assert.h"
#include "core/disjoint_sets.h"
#include "core/refuse.h"
#include "oilskin/surface_motion.h"
#include "reconstruction/grid.h"

namespace oilskin::reconstruction {

namespace {

Corners corners_of(const ObstacleMesh& mesh, std::size_t triangle) {
  const Triangle& i = mesh.triangles[triangle];
  OILSKIN_ASSERT(std::max({i[0], i[1], i[2]}) < mesh.vertices.size());
  return {mesh.vertices[i[0]], mesh.vertices[i[1]], mesh.vertices[i[2]]};
}

Box box_of(const Corners& c) {
  Box box;
  for (const Vec3& x : c) box.add(x);
  return box;
}

Status validate_saturation(const ObstacleMesh& mesh, const std::string& name) {
  const std::size_t count = mesh.saturation.size();
  if (count != 0 && count != mesh.vertices.size())
    return refuse(name, ": saturation has ", count, " values; there are ", mesh.vertices.size(), " vertices");
  for (std::size_t v = 0; v < count; ++v)
    if (!std::isfinite(mesh.saturation[v])) return refuse(name, ": saturation ", v, " is not finite");
  return {};
}

}  // namespace

Status validate_obstacles(const std::vector<ObstacleMesh>& obstacles) {
  for (std::size_t m = 0; m < obstacles.size(); ++m) {
    const ObstacleMesh& mesh = obstacles[m];
    const std::string name = "obstacle " + std::to_string(m);
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
      if (!mesh.vertices[v].allFinite()) return refuse(name, ": vertex ", v, " is not finite");
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      for (std::uint32_t i : mesh.triangles[t])
        if (i >= mesh.vertices.size())
          return refuse(name, ": triangle ", t, " names vertex ", i, "; there are ", mesh.vertices.size());
    if (Status s = validate_saturation(mesh, name); !s.ok()) return s;
  }
  return {};
}

double rounding_of(const Corners& c) {
  double max_error = 0;
  for (const Vec3& x : c) max_error = std::max(max_error, (stored(x, Storage::float32) - x).norm());
  return max_error * (1 + 1e-9);
}

Status validate_resolution(const std::vector<ObstacleMesh>& obstacles, const Box& region, double cell) {
  for (std::size_t m = 0; m < obstacles.size(); ++m)
    for (std::size_t t = 0; t < obstacles[m].triangles.size(); ++t) {
      const Corners c = corners_of(obstacles[m], t);
      if (!box_of(c).overlaps(region)) continue;
      double max_coordinate = 0;
      for (const Vec3& x : c) max_coordinate = std::max(max_coordinate, x.cwiseAbs().maxCoeff());
      // Twice the rounding term of (R.19).
      if (std::max(rounding_of(c), 64 * 0x1p-53 * max_coordinate) <= 0.5 * cell) continue;
      return refuse("obstacle ", m, ": triangle ", t, " has a corner at ", max_coordinate,
                    " m, where numbers are too coarse for a cell of ", cell,
                    " m. Leave it out, or bring it nearer");
    }
  return {};
}

void Obstacles::clear() {
  vertices_.clear();
  saturation_.clear();
  triangles_.clear();
  rounding_.clear();
  normals_.clear();
  counts_.clear();
  given_.clear();
  region_ = Box();
  pieces_.clear();
  has_pieces_ = is_prepared_ = false;
}

/// The same numbers, bit by bit?
bool Obstacles::has(Span<const ObstacleMesh> meshes, const Box& region) const {
  if (meshes.size() != counts_.size() || !region_.contains(region)) return false;
  std::size_t vertex = 0, triangle = 0;
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    const ObstacleMesh& mesh = meshes[m];
    const std::size_t v = mesh.vertices.size(), t = mesh.triangles.size(), s = mesh.saturation.size();
    if (counts_[m] != std::array<std::size_t, 3>{v, t, s}) return false;
    if (!std::equal(mesh.vertices.begin(), mesh.vertices.end(), vertices_.begin() + std::ptrdiff_t(vertex)) ||
        !std::equal(mesh.triangles.begin(), mesh.triangles.end(), given_.begin() + std::ptrdiff_t(triangle)))
      return false;
    if (s > 0 && !std::equal(mesh.saturation.begin(), mesh.saturation.end(),
                             saturation_.begin() + std::ptrdiff_t(vertex)))
      return false;
    vertex += v;
    triangle += t;
  }
  return true;
}

bool Obstacles::set(Span<const ObstacleMesh> meshes, const Box& region, const Box& larger) {
  if (has(meshes, region)) return false;
  clear();
  region_ = larger;
  for (const ObstacleMesh& mesh : meshes) add(mesh);
  rounding_.reserve(triangles_.size());
  for (std::uint32_t t = 0; t < triangles_.size(); ++t) rounding_.push_back(rounding_of(corners(t)));
  return true;
}

void Obstacles::add(const ObstacleMesh& mesh) {
  const auto first = static_cast<std::uint32_t>(vertices_.size());
  counts_.push_back({mesh.vertices.size(), mesh.triangles.size(), mesh.saturation.size()});
  vertices_.insert(vertices_.end(), mesh.vertices.begin(), mesh.vertices.end());
  given_.insert(given_.end(), mesh.triangles.begin(), mesh.triangles.end());
  add_saturation(mesh);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!box_of(corners_of(mesh, t)).overlaps(region_)) continue;
    const Triangle& i = mesh.triangles[t];
    triangles_.push_back({first + i[0], first + i[1], first + i[2]});
  }
}

/// Of the mesh whose vertices were added last.
void Obstacles::add_saturation(const ObstacleMesh& mesh) {
  if (saturation_.empty() && mesh.saturation.empty()) return;
  saturation_.resize(vertices_.size() - mesh.saturation.size(), -1.0f);
  saturation_.insert(saturation_.end(), mesh.saturation.begin(), mesh.saturation.end());
}

void Obstacles::prepare_normals(const Workers& workers) {
  if (normals_.size() == triangles_.size()) return;
  normals_.resize(triangles_.size());
  workers.for_each(triangles_.size(), 512, [&](std::size_t t) {
    const Corners c = corners(static_cast<std::uint32_t>(t));
    const Vec3 across = (c[1] - c[0]).cross(c[2] - c[0]);
    const double length = across.norm();
    normals_[t] = length > 0 ? Vec3(across / length) : Vec3::Zero();
  });
}

const std::vector<std::vector<std::uint32_t>>& Obstacles::pieces() const {
  if (!has_pieces_) pieces_ = find_pieces();
  has_pieces_ = true;
  return pieces_;
}

std::size_t Obstacles::bytes() const {
  std::size_t bytes = vertices_.capacity() * sizeof(Vec3) + 4 * saturation_.capacity() +
                      8 * rounding_.capacity() + normals_.capacity() * sizeof(Vec3) +
                      (triangles_.capacity() + given_.capacity()) * sizeof(Triangle);
  for (const auto& piece : pieces_) bytes += sizeof(std::vector<std::uint32_t>) + 4 * piece.capacity();
  return bytes;
}

std::vector<std::vector<std::uint32_t>> Obstacles::find_pieces() const {
  DisjointSets sets(vertices_.size());
  std::vector<std::uint8_t> used(vertices_.size(), 0);
  for (const Triangle& t : triangles_) {
    sets.unite(t[0], t[1]);
    sets.unite(t[0], t[2]);
    for (std::uint32_t v : t) used[v] = 1;
  }
  std::vector<std::vector<std::uint32_t>> pieces;
  std::vector<std::uint32_t> piece_of(vertices_.size(), none);
  for (std::uint32_t v = 0; v < vertices_.size(); ++v) {
    if (!used[v]) continue;
    std::uint32_t& piece = piece_of[sets.find(v)];
    if (piece == none) {
      piece = static_cast<std::uint32_t>(pieces.size());
      pieces.emplace_back();
    }
    pieces[piece].push_back(v);
  }
  return pieces;
}

}  // namespace oilskin::reconstruction
