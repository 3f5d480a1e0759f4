/// The scalar field of the particles at the nodes of a block. Lengths in cells.
#pragma once

#include "core/simd.h"
#include "oilskin/reconstruction.h"
#include "reconstruction/film.h"
#include "reconstruction/particle_blocks.h"
#include "reconstruction/visibility.h"

namespace oilskin::reconstruction {

using simd::F8;

struct FieldParameters {
  ReconstructionField kind = ReconstructionField::density_decay;
  float kernel_radius = 0;    ///< R
  float particle_radius = 0;  ///< r
  float kernel_norm = 0;      ///< 315 / 64π (R/dx)⁻³
  float rest_count = 0;       ///< particles of a full block
  /// Added to r where particles have few neighbours, so that coarse cells see them.
  float sparse_radius = 0;

  bool needs_volumes() const {
    return kind == ReconstructionField::density_decay || kind == ReconstructionField::density;
  }
  /// Value of nodes that no particle reaches.
  float outside() const { return kernel_radius; }
};

/// W/k for a particle of volume dx³, with the kernel radius R/dx.
float kernel_norm(double radius);

FieldParameters field_parameters(const ReconstructionOptions& options);

/// Evaluates one block at a time. Each thread has its own.
class FieldBlock {
 public:
  explicit FieldBlock(const FieldParameters& parameters) : p_(parameters) {}

  /// Bit mask of the 4³ nodes with even coordinates that are in deep water: w and |x − x̄| pass thresholds.
  std::uint64_t coarse_inside(const NearParticles& near);

  /// 512 values. With `visibility`, a node counts only particles that it sees.
  void evaluate(const NearParticles& near, const BlockVisibility* visibility, float* values);

  /// Where the discs of films are, as high as films on the grid: from the clearance on, or around their
  /// particles.
  enum class FilmPlace { on_obstacle, at_particles };
  /// 512 values, negative in discs of particles that the node sees. False if no disc reaches the block.
  /// `distances` of the nodes from obstacles.
  bool evaluate_films(const NearParticles& near, const BlockVisibility& visibility, const Film& film,
                      const float* distances, FilmPlace place, float* values);

 private:
  struct Row {  // sums at 8 nodes: Σ V k and Σ V k x
    float weight[side], x[side], y[side], z[side];
  };
  static void add(const F8& weight, const std::array<float, 3>& q, Row& row);
  float sparse_share(float volume) const;
  void add_sparse(const F8& weight, float share, int row);
  template <class F>
  void for_rows(const std::array<float, 3>& q, const F& f) const;
  template <class F>
  void for_weights(const std::array<float, 3>& q, float volume, const F& f) const;
  void scatter(const NearParticles& near);
  void scatter_coarse(const NearParticles& near);
  void prepare_rows(const BlockVisibility& visibility);
  bool may_be_hidden(const BlockVisibility& visibility, const std::array<float, 3>& q);
  std::uint32_t hidden(int j, int k, std::uint32_t queried);
  void scatter_visible(const NearParticles& near, const BlockVisibility& visibility);
  void scatter_moments(const NearParticles& near, const BlockVisibility* visibility);
  float value_of(int node) const;
  float eigenvalue_decay(int node, const Vec3& mean_offset) const;

  struct Moments {  // Σ m y yᵀ and Σ m y with m = −k′/|y|, y = x_i − x
    float xx[side], xy[side], xz[side], yy[side], yz[side], zz[side], x[side], y[side], z[side];
  };
  FieldParameters p_;
  Row rows_[side * side];
  std::vector<Moments> moments_;
  std::array<float, nodes> sparse_;  // Σ V k of particles with few neighbours, if sparse_radius > 0
  // The planes in front of which, and behind which, a row, the block and a particle are.
  Words row_front_, row_back_, block_front_, block_back_, front_, back_;
  Words
      between_;  // triangles between a particle and the block along x, and between it and rows along y and z
  Words open_;
  Shadows shadows_;
};

/// V_i of (R.3) in dx³: 1 / W(0) for a particle alone, about 1 inside the water. 1 for particles of blocks
/// that are not in `needed`.
void particle_volumes(const ParticleBlocks& particles, const FieldParameters& parameters,
                      const std::vector<std::uint8_t>& needed, const Workers& workers,
                      std::vector<float>& volumes);

/// The largest real eigenvalue of a 3×3 matrix.
double max_real_eigenvalue(const Eigen::Matrix3d& a);

}  // namespace oilskin::reconstruction
