/// The data of the step under way. Every stage of src/world/step.cpp takes one of these.
#pragma once

#include "contact/host_support.h"
#include "fluid/fluid_solver.h"
#include "oilskin/effect.h"
#include "world/attachments.h"
#include "world/energy.h"
#include "world/ledger.h"
#include "world/substeps.h"

namespace oilskin::world {

struct StepContext {
  StepContext(double step_length, double particle_mass, EnergyState& state, const Vec3& gravity)
      : dt(step_length), ledger(report, particle_mass), energy(state, particle_mass, gravity) {}
  StepContext(const StepContext&) = delete;
  StepContext& operator=(const StepContext&) = delete;

  void count(const ActiveSurfaces& active) {
    counted = active.motion;
    for (const Attachment* a : active.attachment) counted_before.push_back(&Attachments::before(*a));
  }

  /// Before each interval; the last step had dt_before. `in_use` has the surfaces that count in front of
  /// others.
  void count_before(SurfacePaths& in_use, bool is_first, double dt_before) {
    for (std::size_t k = 0; k < counted.size(); ++k)
      counted_before[k] =
          is_first ? in_use.step_before(k, *counted_before[k], dt_before) : in_use.part_before(k);
  }

  // Input
  double dt;  // [s]

  // State
  ActiveSurfaces surfaces;
  std::vector<SurfaceMotion*> counted;               // of which the report has impulses and energies
  std::vector<const SurfaceMotion*> counted_before;  // as the last interval left them; null = as fast as now
  const ContactSettings* contact = nullptr;          // in force
  double mass_of_others = 0;  // of the water in other worlds that counts in `energy` [kg]
  SurfacePaths paths;
  std::vector<contact::HostSupport> hosts;  // one per surface

  // Output
  StepReport report;
  Ledger ledger;  // adds to the report
  EnergyBalance energy;
  std::vector<Contact> contacts;  // of the last interval
  std::vector<SurfaceId> contact_surfaces;
  std::vector<Release> releases;  // that effects asked for
};

/// One certified interval: a step, or one of its sub-steps. Arrays have one value per particle: those that
/// live at the start in storage order, then those emitted in the interval. Ids, x_t0 and the velocities at
/// the start are in WorldState::particles.
struct IntervalContext {
  /// Number k of the intervals of the step.
  IntervalContext(StepContext& s, double begin_time, double length, int k)
      : step(s), begin(begin_time), dt(length), is_first(k == 0), is_last(k + 1 == s.report.substeps) {}

  // Input
  StepContext& step;
  double begin, dt;        // [s]
  bool is_first, is_last;  // of the step

  // State
  std::size_t live = 0;              // particles that live at the start
  std::vector<double> of_starts;     // of those emitted: the part of the interval that each takes part in [s]
  std::vector<Vec3> x_t1, velocity;  // at the end: predicted, proposed, then certified [m], [m/s]
  std::vector<double> inverse_mass;  // [1/kg]
  std::vector<std::uint8_t> removed;
  std::uint64_t removed_by_contact = 0;
  Span<const std::vector<std::uint32_t>> near;  // per surface: triangles within H of the fluid, at least
  std::vector<fluid::PredictionContact> prediction;
  std::vector<Vec3> acceleration;       // by effects; empty = there are none [m/s²]
  std::vector<Vec3> friction;           // the part of it by effects that are friction; empty = there are none
  std::vector<std::uint32_t> taken_by;  // per particle: the sink, or Sinks::none; empty = no sink acts
  std::vector<float> mass_left;  // where surfaces absorbed: relative masses at the end; empty = nowhere

  // Output
  ContactReport report;

  /// The part of the interval that particle i takes part in [s].
  double remaining(std::size_t i) const { return i < live ? dt : of_starts[i - live]; }
  /// Of particle i by effects that do work [m/s²].
  Vec3 driving_acceleration(std::size_t i) const {
    return friction.empty() ? acceleration[i] : Vec3(acceleration[i] - friction[i]);
  }
};

}  // namespace oilskin::world
