/// The state of a world, and the stages of its step.
#pragma once

#include "contact/contact_loop.h"
#include "core/archive.h"
#include "fluid/emission/emission.h"
#include "fluid/fluid_solver.h"
#include "oilskin/world.h"
#include "world/attachments.h"
#include "world/substeps.h"

namespace oilskin {

/// Arrays of the interval under way: the live particles in storage order, then those emitted in it.
struct IntervalArrays {
  std::vector<std::uint64_t> id;
  std::vector<Vec3> x_t0, x_t1, velocity;
  std::vector<double> inverse_mass;
  std::vector<std::uint8_t> removed;
  std::vector<double> remaining;  ///< emitted ones: their part of the interval [s]

  void resize(std::size_t n);
};

struct World::Impl {
  WorldSettings settings;
  FluidSettings fluid_settings;
  ContactSettings contact_settings;
  Status status;

  std::shared_ptr<Workers> workers;
  std::unique_ptr<fluid::FluidSolver> fluid;
  std::unique_ptr<fluid::Emission> emission;
  std::unique_ptr<contact::ContactLoop> contact;
  world::Attachments attachments;
  IntervalObserver* observer = nullptr;

  fluid::Particles particles;
  std::uint64_t next_particle_id = 1;
  std::uint64_t step_count = 0;
  std::uint64_t interval_count = 0;
  double time = 0;              ///< where the interval under way begins
  double last_dt = 0;           ///< of the last step; 0 = there was none
  double max_acceleration = 0;  ///< by the fluid's own forces in the last interval [m/s²]
  StepReport report;

  // Context of the step under way
  world::SurfacePaths paths;
  int substep = 0;  ///< from 0

  // Context of the interval under way
  ContactReport contact_report;
  IntervalArrays now;
  ParticleMotion motion;
  std::vector<SurfaceMotion*> surfaces;
  std::vector<fluid::PredictionContact> prediction;

  template <class Emitter>
  Status add(const Emitter& emitter);

  Impl(const WorldSettings& world, const FluidSettings& fluid, const ContactSettings& contact);

  // The step, in order (step.cpp)
  void run_step(double dt);
  void gather(double dt);
  void remove_invalid_particles();
  void choose_substeps(double dt);
  void run_interval(double dt);
  void emit(double dt);
  void predict_motion();
  void predict_contacts(double dt);
  void propose_motion(double dt);
  void certify();
  void notify_observer(double dt);
  void commit();
  void scatter();

  // Between steps (save.cpp)
  void visit_state(Archive& archive);
  Status restore(Span<const std::uint8_t> saved);

  // How long it may be (time_step.cpp)
  world::Speeds speeds(Span<SurfaceMotion* const> moved, double moved_for, double dt) const;
  double longest_dt(double largest) const;
};

}  // namespace oilskin
