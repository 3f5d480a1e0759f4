#include "reconstruction/obstacle_memory.h"

namespace oilskin::reconstruction {

bool ObstacleMemory::Basis::operator==(const Basis& o) const {
  return cell == o.cell && band == o.band && reach == o.reach && cut_edges == o.cut_edges && mode == o.mode &&
         wet.dry_to == o.wet.dry_to && wet.wet_from == o.wet.wet_from && wet.range == o.wet.range &&
         wet.fade == o.wet.fade;
}

void ObstacleMemory::keep(const Basis& basis, Grid& grid) {
  near_.clear();
  nears_.clear();
  if (is_valid_ && basis == basis_) {
    std::swap(index_, grid.index);
    std::swap(nears_, grid.nears);
    for (const Block& b : grid.blocks) near_.push_back(b.near);
  } else {
    index_.reset(0);
  }
  is_valid_ = false;
  basis_ = basis;
}

NearBlock* ObstacleMemory::find(const Int3& block) {
  const std::uint32_t n = index_.find(key_of(block));
  return n == none || near_[n] == none ? nullptr : &nears_[near_[n]];
}

}  // namespace oilskin::reconstruction
