/// Finds the blocks that the surface may pass: those that a particle reaches, without those in deep water.
#pragma once

#include "reconstruction/field.h"
#include "reconstruction/grid.h"
#include "reconstruction/obstacle_memory.h"

namespace oilskin::reconstruction {

/// Working memory: planned bytes and their limit.
class MemoryPlan {
 public:
  explicit MemoryPlan(double limit) : limit_(limit) {}
  void add(double bytes) { bytes_ += bytes; }
  double bytes() const { return bytes_; }
  bool fits() const { return bytes_ <= limit_; }
  Status refusal(const std::string& what) const;

 private:
  double limit_, bytes_ = 0;
};

/// Fills `grid` with the blocks that a particle reaches and their neighbours towards −x, −y, −z, which own
/// some of their edges and cells, and links them. Omits blocks beyond `clip`.
Status find_blocks(const ParticleBlocks& particles, const FieldParameters& field,
                   const std::optional<Box>& clip, Grid& grid, MemoryPlan& memory);

/// Fills Grid::nears: the triangles within `reach` [cells] of each block. What is in `memory` moves from
/// there.
void find_near_triangles(const Obstacles& obstacles, double reach, ObstacleMemory& memory, Grid& grid);

/// Numbers the blocks that need values; the others are solid or outside. A block is solid if its nodes and
/// one ring of nodes around it are in deep water, no obstacle is near, and the clip box does not cut it.
Status choose_fields(const ParticleBlocks& particles, const FieldParameters& field,
                     const std::optional<Box>& clip, Grid& grid, MemoryPlan& memory, const Workers& workers);

}  // namespace oilskin::reconstruction
