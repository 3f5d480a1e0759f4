#include "surface/obstacles.h"

#include <algorithm>
#include <numeric>

#include "core/assert.h"
#include "surface/disjoint_sets.h"

namespace oilskin::surface {

Status validate_obstacles(const std::vector<ObstacleMesh>& obstacles) {
  for (std::size_t m = 0; m < obstacles.size(); ++m) {
    const ObstacleMesh& mesh = obstacles[m];
    const std::string name = "obstacle " + std::to_string(m);
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
      if (!mesh.vertices[v].allFinite())
        return Status::refused(name + ": vertex " + std::to_string(v) + " is not finite");
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      for (std::uint32_t i : mesh.triangles[t])
        if (i >= mesh.vertices.size())
          return Status::refused(name + ": triangle " + std::to_string(t) + " names vertex " +
                                 std::to_string(i) + "; there are " + std::to_string(mesh.vertices.size()));
  }
  return {};
}

Obstacles::Obstacles(Span<const ObstacleMesh> meshes) {
  for (const ObstacleMesh& mesh : meshes) {
    const auto first = static_cast<std::uint32_t>(vertices_.size());
    vertices_.insert(vertices_.end(), mesh.vertices.begin(), mesh.vertices.end());
    for (const Triangle& t : mesh.triangles) {
      OILSKIN_ASSERT(t[0] < mesh.vertices.size() && t[1] < mesh.vertices.size() &&
                     t[2] < mesh.vertices.size());
      triangles_.push_back({first + t[0], first + t[1], first + t[2]});
    }
  }
  for (const Triangle& t : triangles_)
    for (std::uint32_t v : t) largest_ = std::max(largest_, vertices_[v].cwiseAbs().maxCoeff());
  tree_.update(triangles_, vertices_, vertices_);
}

std::vector<std::vector<std::uint32_t>> Obstacles::pieces() const {
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

}  // namespace oilskin::surface
