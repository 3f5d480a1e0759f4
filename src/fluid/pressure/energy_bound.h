/// What a loop that has not converged may do to the energy of the fluid.
#pragma once

#include <algorithm>
#include <cmath>

#include "fluid/pressure/incompressible.h"
#include "fluid/pressure/pair_sums.h"
#include "fluid/pressure/pressure_loop.h"

namespace oilskin::fluid {

/// Σ m |d₀|², Σ m d₀·d, Σ m |d|² of the displacements d₀ without pressures and d with them, and what
/// corrections may add to the last.
struct EnergySums {
  double without = 0, mixed = 0, with = 0, correction = 0;

  void operator+=(const EnergySums& o) {
    without += o.without;
    mixed += o.mixed;
    with += o.with;
    correction += o.correction;
  }
  /// s of (F.83), from 0 to 1: the largest part of the pressures with which Σ m |d|² exceeds Σ m |d₀|² by no
  /// more than `allowed`.
  double part_within(double allowed) const {
    if (with <= without + allowed) return 1;
    const double removed = without - mixed, change = without - 2 * mixed + with;
    if (!std::isfinite(change)) return 0;
    return std::clamp((removed + std::sqrt(removed * removed + change * allowed)) / change, 0.0, 1.0);
  }
};

/// What a loop that has neither converged nor diverged may add to the kinetic energy, over that without
/// pressures. Water that is compressed expands too slowly with 0.
constexpr double tolerated_rise = 0.25;

/// Pressures that a loop leaves before it has converged may accelerate the fluid without end, first of all
/// where it diverges. So φ is multiplied by the largest part with which the kinetic energy of the step
/// exceeds that without pressures by no more than this and what a slow correction of compression takes
/// (F.83). predict() finds the displacements under the pressures in `x_phi`; displacement(i) returns that of
/// particle i.
template <class Predict, class Displacement>
void bound_energy(const IncompressibleFluid& fluid, const PressureLoop& loop, StepState& state,
                  std::vector<Record>& x_phi, const Predict& predict, const Displacement& displacement) {
  if (loop.converged()) return;
  std::vector<Vec3> without(state.size());
  std::vector<float> phi(state.size());
  state.for_each([&](std::size_t i) {
    phi[i] = x_phi[i].w;
    x_phi[i].w = 0;
  });
  predict();
  state.for_each([&](std::size_t i) {
    without[i] = displacement(i);
    x_phi[i].w = phi[i];
  });
  predict();
  const CorrectionEnergy correction = fluid.energy_of_correction(state);
  const EnergySums sums = state.ordered_sum(EnergySums{}, [&](std::size_t begin, std::size_t end) {
    EnergySums part;
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3 with = displacement(i);
      const double m = state.relative_mass(i);
      part += {m * without[i].squaredNorm(), m * without[i].dot(with), m * with.squaredNorm(),
               m * correction.of(state.relative_density[i])};
    }
    return part;
  });
  const double tolerated = loop.diverged() ? 0 : tolerated_rise * sums.without;
  const double part = sums.part_within(tolerated + sums.correction);
  if (part == 1) return;
  state.for_each([&](std::size_t i) { x_phi[i].w *= static_cast<float>(part); });
  predict();  // the walls, too, move under these pressures
}

}  // namespace oilskin::fluid
