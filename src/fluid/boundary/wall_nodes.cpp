#include "fluid/boundary/wall_nodes.h"

#include <algorithm>

#include "core/assert.h"
#include "core/chunks.h"

namespace oilskin::fluid {

namespace {

constexpr std::size_t smallest_chunk = 1024;  // of walls

constexpr std::uint32_t none = UINT32_MAX, found = none - 1;

}  // namespace

void WallNodes::clear() {
  nodes_.clear();
}

void WallNodes::Numbers::resize(std::size_t nodes) {
  if (nodes == size_) return;
  number_ = std::make_unique<std::atomic<std::uint32_t>[]>(nodes);
  for (std::size_t i = 0; i < nodes; ++i) number_[i].store(none, std::memory_order_relaxed);
  size_ = nodes;
}

void WallNodes::number(const std::vector<Wall>& walls, Span<SurfaceMotion* const> surfaces,
                       const Workers& workers) {
  if (has_numbers_) number_.clear();
  has_numbers_ = true;
  number_.resize(surfaces.size());
  for (std::size_t s = 0; s < surfaces.size(); ++s) number_[s].resize(surfaces[s]->x_t0.size());
  find_nodes(walls, surfaces, workers);
  const auto number_of = [&](const Node& n) -> std::atomic<std::uint32_t>& {
    return number_[n.surface][n.node];
  };
  for (std::size_t n = 0; n < nodes_.size(); ++n)
    number_of(nodes_[n]).store(static_cast<std::uint32_t>(n), std::memory_order_relaxed);
  of_wall_.resize(walls.size());
  for_each_evenly(workers, walls.size(), smallest_chunk, [&](std::size_t w) {
    const Triangle& triangle = surfaces[walls[w].surface]->triangles[walls[w].triangle];
    for (std::size_t k = 0; k < 3; ++k)
      of_wall_[w][k] = number_of({walls[w].surface, triangle[k]}).load(std::memory_order_relaxed);
  });
  for (const Node& n : nodes_) number_of(n).store(none, std::memory_order_relaxed);
  has_numbers_ = false;
  const auto for_corners = [&](std::size_t begin, std::size_t end, const auto& f) {
    for (std::size_t w = begin; w < end; ++w)
      for (std::uint8_t k = 0; k < 3; ++k) f(of_wall_[w][k], Corner{static_cast<std::uint32_t>(w), k});
  };
  sort_by_key(walls.size(), smallest_chunk, nodes_.size(), for_corners, workers, corners_);
}

/// The thread that comes first to a node lists it.
void WallNodes::find_nodes(const std::vector<Wall>& walls, Span<SurfaceMotion* const> surfaces,
                           const Workers& workers) {
  const std::size_t wall_chunk = even_chunk(walls.size(), smallest_chunk);
  std::vector<std::vector<Node>> parts((walls.size() + wall_chunk - 1) / wall_chunk);
  workers.for_chunks(walls.size(), wall_chunk, [&](std::size_t begin, std::size_t end, std::size_t c) {
    for (std::size_t w = begin; w < end; ++w)
      for (const std::uint32_t node : surfaces[walls[w].surface]->triangles[walls[w].triangle]) {
        std::atomic<std::uint32_t>& number = number_[walls[w].surface][node];
        if (number.load(std::memory_order_relaxed) == none &&
            number.exchange(found, std::memory_order_relaxed) == none)
          parts[c].push_back({walls[w].surface, node});
      }
  });
  nodes_.clear();
  for (const std::vector<Node>& part : parts) nodes_.insert(nodes_.end(), part.begin(), part.end());
  std::sort(nodes_.begin(), nodes_.end());
}

}  // namespace oilskin::fluid
