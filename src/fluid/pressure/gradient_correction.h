/// Corrected kernel gradients of DFSPH (docs/theory/fluid.md, section 10.1).
///
/// The sum Σ m w'/q Δ·(y_i − y_j) takes shear of a disordered arrangement as compression, and water under
/// pressure resists shear like a solid. With w'/q K_i Δ in place of w'/q Δ it is 0 for shear and rotation of
/// a linear field [Bonet1999], and the force is the transpose, which conserves momentum and angular momentum.
#pragma once

#include "fluid/pressure/pair_sums.h"
#include "fluid/pressure/tensor_array.h"

namespace oilskin::fluid {

class GradientCorrection {
 public:
  /// `share` s of (F.77), 0 … 1; 0 = none, and nothing but is_on() is called.
  explicit GradientCorrection(double share) : share_(share) {}

  bool is_on() const { return share_ > 0; }

  /// Σ_j m_j w'/q Δ ⊗ Δ of the particles, images included, for begin_step(), which puts K in their place.
  TensorArray& moments() { return tensors_; }

  /// Computes K_i of an interval. `sums`: Σ_j m_j w'/q Δ of the particles → K_i times them; Record::w stays.
  /// `density_scale` D.
  void begin_step(StepState& state, std::vector<Record>& sums, float density_scale);

  /// Σ_j m_j w'/q (φ_i K_i + φ_j K_j) Δ_ij for a chunk. `own`: the sums of begin_step().
  void push(StepState& state, const std::vector<Record>& x_phi, const std::vector<Record>& own,
            PairRange range, Record* out) const;
  /// Σ_j m_j w'/q (K_i Δ_ij)·(y_i − y_j) for a chunk.
  void compression(StepState& state, const std::vector<Record>& y, PairRange range, float* out) const;
  /// dv −= scale Σ_j m_j w'/q (φ_i K_i + φ_j K_j) Δ_ij (F.79) for all particles.
  void apply_pressure(StepState& state, const std::vector<Record>& x_phi, double scale) const;

 private:
  void set_tensor(const StepState& state, std::size_t i, Record& sum, float density_scale);

  const double share_;
  TensorArray tensors_;  // moments, then K
};

}  // namespace oilskin::fluid
