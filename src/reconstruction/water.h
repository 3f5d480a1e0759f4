/// How much water each particle is, for meshes that keep the volume.
#pragma once

#include <cmath>

#include "oilskin/reconstruction.h"
#include "reconstruction/particle_blocks.h"

namespace oilskin::reconstruction {

/// Modes that change the volume at obstacles do not keep it.
inline bool keeps_volume(const ReconstructionOptions& o) {
  return o.keep_volume && o.contact != ObstacleMode::reset && o.contact != ObstacleMode::overlap;
}

class Water {
 public:
  /// Of a mesh that does not keep the volume.
  Water() = default;
  /// The input must outlive it.
  Water(const ReconstructionInput& input, const ReconstructionOptions& options,
        const ParticleBlocks& particles)
      : given_(input.volumes),
        source_(&particles.source),
        per_cell_(std::pow(options.cell * options.spacing, -3)),
        each_(std::pow(options.cell, -3)),
        is_drop_(particles.size(), 0) {}

  bool is_kept() const { return source_ != nullptr; }
  std::size_t size() const { return is_drop_.size(); }
  /// The volume of particle p of ParticleBlocks [cells³].
  double of(std::size_t p) const { return given_.empty() ? each_ : given_[(*source_)[p]] * per_cell_; }
  /// Is the particle drawn apart from the grid's surface?
  bool is_drop(std::size_t p) const { return is_drop_[p] != 0; }
  void make_drop(std::size_t p) { is_drop_[p] = 1; }

 private:
  Span<const double> given_;
  const std::vector<std::uint32_t>* source_ = nullptr;
  double per_cell_ = 0, each_ = 0;
  std::vector<std::uint8_t> is_drop_;
};

}  // namespace oilskin::reconstruction
