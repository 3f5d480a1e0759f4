/// What is known of obstacles at the blocks of the last run. While they do not move, it is not computed
/// again.
#pragma once

#include "oilskin/reconstruction.h"
#include "reconstruction/obstacle_distance.h"

namespace oilskin::reconstruction {

class ObstacleMemory {
 public:
  /// On what NearBlock depends beside obstacles and block.
  struct Basis {
    double cell = 0, band = 0, reach = 0;
    bool cut_edges = false;
    ObstacleMode mode = ObstacleMode::none;
    WetRule wet;
    bool operator==(const Basis& o) const;
  };

  /// The obstacles changed.
  void forget() { is_valid_ = false; }
  /// Takes the blocks of the last run out of `grid`, if they were of the same obstacles and basis. They are
  /// lost if learn() does not follow.
  void keep(const Basis& basis, Grid& grid);
  /// The blocks of the grid are measured.
  void learn() { is_valid_ = true; }

  /// Was the block in the last run?
  bool knows(const Int3& block) const { return index_.find(key_of(block)) != none; }
  /// Gives back what was known of it; null if no obstacle was near. Once per block.
  NearBlock* find(const Int3& block);
  std::size_t bytes() const { return index_.bytes() + 4 * near_.capacity(); }

 private:
  bool is_valid_ = false;
  Basis basis_;
  KeyMap index_;
  std::vector<std::uint32_t> near_;  // per number of index_
  std::vector<NearBlock> nears_;
};

}  // namespace oilskin::reconstruction
