/// Interface of the fluid models: kernels, viscosity and pressure solver.
#pragma once

#include <memory>

#include "core/archive.h"
#include "fluid/pressure/pressure_loop.h"
#include "fluid/pressure/step_state.h"
#include "oilskin/report.h"

namespace oilskin::fluid {

class PressureModel {
 public:
  virtual ~PressureModel() = default;

  /// m/ρ0 [m³]: volume of a particle in water at rest.
  virtual double particle_volume() const = 0;

  /// Reads the velocities; writes densities and slopes, adds viscosity and XSPH to dv.
  virtual void explicit_terms(StepState& state) = 0;

  /// Reads densities, slopes, dv and the pressures of the last step; adds the pressure forces to dv and
  /// writes the pressures [Pa].
  virtual void pressure_terms(StepState& state, std::vector<double>& pressure, FluidReport& report) = 0;

  /// From now on at most so many iterations in a step. The default is for models without.
  virtual void limit_iterations(int) {}

  /// State that is kept from step to step: ω of the pressure loop, and the controller of its iterations. The
  /// default is for models without.
  struct Memory {
    double relaxation = 0;
    IterationController controller;
  };
  virtual Memory memory() const { return {}; }
  virtual void set_memory(const Memory&) noexcept {}
  virtual void visit(Archive&) {}
};

std::unique_ptr<PressureModel> make_mcg03(const FluidSettings& settings);
std::unique_ptr<PressureModel> make_pcisph(const FluidSettings& settings);
std::unique_ptr<PressureModel> make_dfsph(const FluidSettings& settings);

}  // namespace oilskin::fluid
