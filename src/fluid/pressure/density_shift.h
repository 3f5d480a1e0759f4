/// The second half of an incompressible step: displacements that bring the density back to ρ0, of positions
/// alone (docs/theory/fluid.md, (F.60) to (F.63)).
///
/// The velocities of a step compress nothing, see the solvers; what density error exists comes from their
/// tolerance, from the curvature of paths and from starts out of order. A velocity that corrects it within a
/// step is kept: a block that is compressed by 5 % over N layers rebounds with 0.05 N dx/dt. So the
/// correction moves particles and adds no velocity (split impulses; [Cornelis2019]).
#pragma once

#include "fluid/pressure/pair_gradients.h"
#include "fluid/pressure/pressure_loop.h"

namespace oilskin::fluid {

class DensityShift {
 public:
  explicit DensityShift(const IncompressibleFluid& fluid) : fluid_(fluid) {}

  /// After the forces: state.dv is final. Sets state.shift and what the report says of the density.
  void find(StepState& state, FluidReport& report);

 private:
  void begin(const StepState& state);
  void displace(const StepState& state);
  Errors correct(const StepState& state);
  float density(const StepState& state, std::size_t i) const;
  float step(const StepState& state, std::size_t i) const;
  Vec3 shift(const StepState& state, std::size_t i) const;
  void limit(StepState& state) const;

  const IncompressibleFluid& fluid_;
  int corrections_ = 0;
  std::vector<Vec3> drift_;                // displacement by the velocities [H]
  std::vector<float> target_, min_phi_;    // relative error that remains; bound of φ
  std::vector<float> phi_, previous_phi_;  // with one more for the padding
  std::vector<Record> displacement_;       // with the shift [H]
  double remaining_ = 0;
};

}  // namespace oilskin::fluid
