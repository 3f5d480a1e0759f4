/// Which blocks the surface may pass: those that a particle reaches, less those deep inside the water.
#pragma once

#include "reconstruction/field.h"
#include "reconstruction/grid.h"

namespace oilskin::reconstruction {

/// Bytes that the work will take, and what is allowed.
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

/// Fills `grid` with blocks: all that a particle reaches and their neighbours towards −x, −y, −z (which own
/// edges and cells of theirs), each linked to its neighbours. Blocks beyond `clip` are left out.
Status find_blocks(const ParticleBlocks& particles, const FieldParameters& field,
                   const std::optional<Box>& clip, Grid& grid, MemoryPlan& memory);

/// Fills `nears`: the triangles that come within `reach` [cells] of each block.
void find_near_triangles(const Obstacles& obstacles, double reach, Grid& grid);

/// Numbers the blocks that need values; the others are `solid` or outside. A block is solid if its nodes and
/// the next around it lie well inside the water, no obstacle is near, and the clip box does not cut it.
Status choose_fields(const ParticleBlocks& particles, const FieldParameters& field,
                     const std::optional<Box>& clip, Grid& grid, MemoryPlan& memory, const Workers& workers);

}  // namespace oilskin::reconstruction
