#include "reconstruction/narrow_band.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace oilskin::reconstruction {

namespace {

/// Working memory of a block, of its values (with bits and numbers of vertices), and of its part of the mesh.
constexpr double block_bytes = sizeof(Block) + 64, field_bytes = nodes * sizeof(float) + 600,
                 mesh_bytes = 5000;

constexpr std::size_t chunk = 8;

/// A box of blocks.
struct Blocks {
  Int3 first, last;

  double count() const {
    return (double(last.x) - first.x + 1) * (double(last.y) - first.y + 1) * (double(last.z) - first.z + 1);
  }
};

template <class F>
void for_blocks(const Blocks& b, const F& f) {
  for (int z = b.first.z; z <= b.last.z; ++z)
    for (int y = b.first.y; y <= b.last.y; ++y)
      for (int x = b.first.x; x <= b.last.x; ++x) f(Int3{x, y, z});
}

/// Blocks that the particles of block b reach.
Blocks reached(const ParticleBlocks& p, std::size_t b, float reach) {
  float low[3] = {1e30f, 1e30f, 1e30f}, high[3] = {-1e30f, -1e30f, -1e30f};
  const std::vector<float>* const coordinates[3] = {&p.x, &p.y, &p.z};
  for (std::size_t s = p.begin[b]; s < p.begin[b + 1]; ++s)
    for (int a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], (*coordinates[a])[s]);
      high[a] = std::max(high[a], (*coordinates[a])[s]);
    }
  const auto block_of = [](float x) { return static_cast<int>(std::floor(x / side)); };
  const Int3 at = p.blocks[b];
  return {at + Int3{block_of(low[0] - reach), block_of(low[1] - reach), block_of(low[2] - reach)},
          at + Int3{block_of(high[0] + reach), block_of(high[1] + reach), block_of(high[2] + reach)}};
}

/// The box of the block's nodes 0 … 8.
Box box_of(const Grid& grid, const Block& b) {
  const Vec3 low = grid.origin(b);
  return {low, low + Vec3::Constant(side * grid.cell)};
}

/// A range that contains all blocks whose nodes 0 … 8 may be in the box.
Blocks blocks_of(const Grid& grid, const Box& box) {
  static constexpr double beyond_all = 1 << 21, rounding = 1e-3;  // [blocks]
  const auto at = [&](const Vec3& x, double margin) {
    const Vec3 b = (x / (side * grid.cell)).array() + margin;
    const auto part = [](double v) {
      return static_cast<int>(std::floor(std::clamp(v, -beyond_all, beyond_all)));
    };
    return Int3{part(b.x()), part(b.y()), part(b.z())};
  };
  return {at(box.min, -1 - rounding), at(box.max, rounding)};
}

/// The coarse nodes of a neighbour in direction d (−1, 0, 1 along each axis) that adjoin the block.
std::uint64_t adjoining_nodes(const Int3& d) {
  std::uint64_t mask = 0;
  const auto adjoins = [](int direction, int i) { return direction == 0 || i == (direction > 0 ? 0 : 3); };
  for (int k = 0; k < 4; ++k)
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 4; ++i)
        if (adjoins(d.x, i) && adjoins(d.y, j) && adjoins(d.z, k)) mask |= 1ull << (i + 4 * (j + 4 * k));
  return mask;
}

bool cut_by(const std::optional<Box>& clip, const Box& box, double margin) {
  return clip && !clip->contains(box.inflated(margin));
}

}  // namespace

Status MemoryPlan::refusal(const std::string& what) const {
  char text[200];
  std::snprintf(text, sizeof text,
                " would need %.0f MB or more; memory_limit is %.6g MB. Take a larger cell, or clip",
                std::ceil(bytes_ / 1e6), limit_ / 1e6);
  return Status::refused(what + text);
}

Status find_blocks(const ParticleBlocks& particles, const FieldParameters& field,
                   const std::optional<Box>& clip, Grid& grid, MemoryPlan& memory) {
  // Particles reach nodes within R; one cell more covers rounding.
  const float reach = field.kernel_radius + 1;
  std::vector<std::uint64_t> keys;
  grid.index.reset(particles.blocks.size());
  grid.blocks.clear();
  const auto add = [&](const Int3& at) {
    const std::uint64_t key = key_of(at);
    const auto next = static_cast<std::uint32_t>(keys.size());
    if (grid.index.insert(key, next) != next) return;
    keys.push_back(key);
    memory.add(block_bytes);
  };
  for (std::size_t b = 0; b < particles.blocks.size(); ++b) {
    for_blocks(reached(particles, b, reach), [&](const Int3& at) {
      Block block;
      block.at = at;
      if (!clip || clip->overlaps(box_of(grid, block))) add(at);
    });
    if (!memory.fits()) return memory.refusal("the blocks of the grid");
  }
  const std::size_t reached_blocks = keys.size();
  for (std::size_t b = 0; b < reached_blocks; ++b)
    for (int o = 1; o < 8; ++o) add(block_of_key(keys[b]) - Int3{o & 1, o >> 1 & 1, o >> 2 & 1});
  if (!memory.fits()) return memory.refusal("the blocks of the grid");

  std::sort(keys.begin(), keys.end());
  grid.index.reset(keys.size());
  grid.blocks.resize(keys.size());
  for (std::uint32_t b = 0; b < keys.size(); ++b) {
    grid.blocks[b].at = block_of_key(keys[b]);
    grid.index.insert(keys[b], b);
  }
  for (Block& b : grid.blocks)
    for (int o = 0; o < 8; ++o)
      b.plus[std::size_t(o)] = grid.index.find(key_of(b.at + Int3{o & 1, o >> 1 & 1, o >> 2 & 1}));
  return {};
}

namespace {

/// The triangles near the blocks that `memory` does not know.
std::vector<std::vector<std::uint32_t>> triangles_near_new_blocks(const Obstacles& obstacles, double margin,
                                                                  const ObstacleMemory& memory,
                                                                  const Grid& grid) {
  std::vector<std::vector<std::uint32_t>> found(grid.blocks.size());
  std::vector<std::uint8_t> is_new(grid.blocks.size());
  for (std::size_t b = 0; b < is_new.size(); ++b) is_new[b] = !memory.knows(grid.blocks[b].at);
  if (std::find(is_new.begin(), is_new.end(), 1) == is_new.end()) return found;
  for (std::uint32_t t = 0; t < obstacles.size(); ++t) {
    const Box triangle = obstacles.box(t);
    const auto add = [&](std::uint32_t b) {
      if (is_new[b] && triangle.overlaps(box_of(grid, grid.blocks[b]).inflated(margin)))
        found[b].push_back(t);
    };
    const Blocks range = blocks_of(grid, triangle.inflated(margin));
    if (range.count() > double(grid.blocks.size()))
      for (std::uint32_t b = 0; b < grid.blocks.size(); ++b) add(b);
    else
      for_blocks(range, [&](const Int3& at) {
        if (const std::uint32_t b = grid.index.find(key_of(at)); b != none) add(b);
      });
  }
  return found;
}

}  // namespace

void find_near_triangles(const Obstacles& obstacles, double reach, ObstacleMemory& memory, Grid& grid) {
  auto found = triangles_near_new_blocks(obstacles, reach * grid.cell, memory, grid);
  grid.nears.clear();
  for (std::size_t b = 0; b < found.size(); ++b) {
    NearBlock* const known = memory.find(grid.blocks[b].at);
    if (!known && found[b].empty()) continue;
    grid.blocks[b].near = static_cast<std::uint32_t>(grid.nears.size());
    grid.nears.emplace_back();
    if (known)
      grid.nears.back() = std::move(*known);
    else
      grid.nears.back().triangles = std::move(found[b]);
  }
}

Status choose_fields(const ParticleBlocks& particles, const FieldParameters& field,
                     const std::optional<Box>& clip, Grid& grid, MemoryPlan& memory, const Workers& workers) {
  std::vector<std::uint64_t> deep(grid.blocks.size(), 0);  // bit per coarse node
  std::vector<std::uint8_t> is_reached(grid.blocks.size(), 0);
  const std::vector<float> no_volumes;
  workers.for_chunks(grid.blocks.size(), chunk, [&](std::size_t from, std::size_t to, std::size_t) {
    FieldBlock evaluator(field);
    NearParticles near;
    for (std::size_t b = from; b < to; ++b) {
      near.gather(particles, no_volumes, grid.blocks[b].at, 0, side - 1, field.kernel_radius);
      is_reached[b] = near.count > 0;
      // With less than half of the particles of a full block it cannot be solid.
      if (static_cast<float>(near.count) < 0.5f * field.rest_count) continue;
      if (grid.blocks[b].near != none || cut_by(clip, box_of(grid, grid.blocks[b]), grid.cell)) continue;
      deep[b] = evaluator.coarse_inside(near);
    }
  });
  std::uint32_t fields = 0;
  for (std::size_t b = 0; b < grid.blocks.size(); ++b) {
    bool solid = deep[b] == ~0ull;
    for (int dz = -1; dz <= 1 && solid; ++dz)
      for (int dy = -1; dy <= 1 && solid; ++dy)
        for (int dx = -1; dx <= 1 && solid; ++dx) {
          const std::uint32_t o = grid.index.find(key_of(grid.blocks[b].at + Int3{dx, dy, dz}));
          const std::uint64_t mask = adjoining_nodes({dx, dy, dz});
          // A neighbour near an obstacle has values.
          solid = o != none && (grid.blocks[o].near != none || (deep[o] & mask) == mask);
        }
    grid.blocks[b].solid = solid;
    if (!solid && is_reached[b]) grid.blocks[b].field = fields++;
  }
  memory.add(fields * (field_bytes + mesh_bytes));
  if (!memory.fits()) return memory.refusal(std::to_string(fields) + " blocks of 8x8x8 nodes");
  grid.values.resize(std::size_t(fields) * nodes);
  grid.inside_bits.resize(fields);
  return {};
}

}  // namespace oilskin::reconstruction
