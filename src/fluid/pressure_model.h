/// What a fluid model decides: its kernels, its viscosity, and how pressure is found.
#pragma once

#include <memory>

#include "core/archive.h"
#include "fluid/step_state.h"
#include "oilskin/report.h"

namespace oilskin::fluid {

class PressureModel {
 public:
  virtual ~PressureModel() = default;

  /// m/ρ0 [m³]: the room that a particle takes in water at rest.
  virtual double particle_volume() const = 0;

  /// Reads the velocities; writes densities and slopes, adds viscosity and XSPH to dv.
  virtual void explicit_terms(StepState& state) = 0;

  /// Reads densities, slopes, dv and the pressures of the last step; adds pressure to dv, writes the
  /// pressures [Pa].
  virtual void pressure_terms(StepState& state, std::vector<double>& pressure, FluidReport& report) = 0;

  /// What a model keeps from step to step; here, nothing.
  struct Memory {
    double relaxation = 0;  // ω
    int iterations = 0, settled_steps = 0;
  };
  virtual Memory memory() const { return {}; }
  virtual void set_memory(const Memory&) noexcept {}
  virtual void visit(Archive&) {}
};

std::unique_ptr<PressureModel> make_mcg03(const FluidSettings& settings);
std::unique_ptr<PressureModel> make_pcisph(const FluidSettings& settings);
std::unique_ptr<PressureModel> make_dfsph(const FluidSettings& settings);

}  // namespace oilskin::fluid
