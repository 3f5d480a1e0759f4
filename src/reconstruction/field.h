/// The scalar field of the particles on the nodes of a block. Lengths in cells.
#pragma once

#include "oilskin/reconstruction.h"
#include "reconstruction/lanes.h"
#include "reconstruction/particle_blocks.h"
#include "reconstruction/visibility.h"

namespace oilskin::reconstruction {

struct FieldParameters {
  ReconstructionField kind = ReconstructionField::density_decay;
  float kernel_radius = 0;    ///< R
  float particle_radius = 0;  ///< r
  float share = 0;            ///< 315 / 64π (R/s)⁻³: what a particle of volume s³ adds to w for k = 1
  float rest_count = 0;       ///< particles in a block that is full

  bool needs_volumes() const {
    return kind == ReconstructionField::density_decay || kind == ReconstructionField::density;
  }
  /// Value of nodes without a particle in reach.
  float outside() const { return kernel_radius; }
};

FieldParameters field_parameters(const ReconstructionOptions& options);

/// Evaluates blocks, one at a time; a thread has its own.
class FieldBlock {
 public:
  explicit FieldBlock(const FieldParameters& parameters) : p_(parameters) {}

  /// Which of the 4³ nodes with even coordinates lie well inside the water: much of it, and on all sides.
  std::uint64_t coarse_inside(const NearParticles& near);

  /// 512 values. With a `sight`, only what a node can see counts.
  void evaluate(const NearParticles& near, const BlockSight* sight, float* values);

 private:
  struct Row {  // of 8 nodes: Σ V k and Σ V k x
    float weight[side], x[side], y[side], z[side];
  };
  static void add(const Lanes& weight, const std::array<float, 3>& q, Row& row);
  template <class F>
  void for_rows(const std::array<float, 3>& q, const F& f) const;
  template <class F>
  void for_weights(const std::array<float, 3>& q, float volume, const F& f) const;
  void scatter(const NearParticles& near);
  void scatter_coarse(const NearParticles& near);
  void look_from_rows(const BlockSight& sight);
  bool look_from(const BlockSight& sight, const std::array<float, 3>& q);
  std::uint32_t hidden(int j, int k, std::uint32_t wanted);
  void scatter_visible(const NearParticles& near, const BlockSight& sight);
  void scatter_moments(const NearParticles& near, const BlockSight* sight);
  float value_of(int node) const;
  float eigenvalue_decay(int node, const Vec3& mean_offset) const;

  struct Moments {  // Σ m y yᵀ and Σ m y, m = −k′/|y|, y = x_i − x
    float xx[side], xy[side], xz[side], yy[side], yz[side], zz[side], x[side], y[side], z[side];
  };
  FieldParameters p_;
  Row rows_[side * side];
  std::vector<Moments> moments_;
  /// Of each row, of the block and of a particle: the planes that it is in front of and behind.
  Words row_front_, row_back_, block_front_, block_back_, front_, back_;
  Words between_;  ///< triangles between a particle and the block along x, and rows along y and along z
  Words open_;
  Shadows shadows_;
};

/// V_i (R.3) in s³: of a particle that is alone 1 / W(0), in the middle of the water 1. One value for each
/// particle of the blocks of which `wanted` is set; 1 for the others.
std::vector<float> particle_volumes(const ParticleBlocks& particles, const FieldParameters& parameters,
                                    const std::vector<std::uint8_t>& wanted, const Workers& workers);

/// The largest real eigenvalue of a 3×3 matrix.
double max_real_eigenvalue(const Eigen::Matrix3d& a);

}  // namespace oilskin::reconstruction
