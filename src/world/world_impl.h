/// The state of a world, and the stages of its step.
#pragma once

#include "contact/contact_pass.h"
#include "core/archive.h"
#include "fluid/emission/emission.h"
#include "fluid/fluid_solver.h"
#include "oilskin/world.h"
#include "world/attachments.h"
#include "world/effects.h"
#include "world/energy.h"
#include "world/sinks.h"
#include "world/step_budget.h"
#include "world/step_context.h"

namespace oilskin {

namespace world {

/// Particles that the caller removed since the last step: the next report counts them.
struct Withdrawn {
  std::uint64_t count = 0;
  double mass_ratio = 0;         // Σ of mass over that of a new particle
  Vec3 momentum = Vec3::Zero();  // Σ mass_ratio × velocity [m/s]
};

/// Of some of the particles at the end of an interval: threads add up their own.
struct EndSums {
  EnergyBalance::Sums energy;
  Ledger::Sums ledger;
  std::uint64_t removed = 0, removed_by_age = 0, removed_too_fast = 0, absorbed = 0;

  void operator+=(const EndSums& o) {
    energy += o.energy;
    ledger += o.ledger;
    removed += o.removed;
    removed_by_age += o.removed_by_age;
    removed_too_fast += o.removed_too_fast;
    absorbed += o.absorbed;
  }
};

/// What a world keeps from step to step, but for its surfaces, its emitters and the fluid solver's memory.
struct WorldState {
  fluid::Particles particles;
  std::uint64_t next_particle_id = 1;
  std::uint64_t step_count = 0;
  std::uint64_t interval_count = 0;
  double time = 0;              // [s]
  double last_dt = 0;           // of the last step [s]; 0 = there was none
  double max_acceleration = 0;  // by the fluid's own forces in the last interval [m/s²]
  EnergyState energy;
  Withdrawn withdrawn;
  Sinks sinks;
  double max_age = std::numeric_limits<double>::infinity();  // of particles that are added [s]

  void copy_to(WorldState& to, const Workers& copiers) const;
};

}  // namespace world

struct World::Impl {
  WorldSettings settings;
  FluidSettings fluid_settings;
  ContactSettings contact_settings;
  Status status;

  std::shared_ptr<Workers> workers;
  std::unique_ptr<fluid::FluidSolver> fluid;
  std::unique_ptr<fluid::Emission> emission;
  contact::ContactBuffers contact_buffers, joint_buffers;  // joint: of steps of several worlds
  world::Attachments attachments;
  world::Effects effects;
  world::StepBudget budget;
  IntervalObserver* observer = nullptr;

  world::WorldState state, saved_state;  // saved_state: by checkpoint()

  // Of the last step
  StepReport report;
  std::vector<Contact> contacts;
  std::vector<SurfaceId> contact_surfaces;

  template <class Emitter>
  Status add(const Emitter& emitter, EmitterId* id, const EmitterPose* pose);  // emitters.cpp

  /// `workers`: of another one; null = new ones.
  Impl(const WorldSettings& world, const FluidSettings& fluid, const ContactSettings& contact,
       std::shared_ptr<Workers> workers = nullptr);

  /// A report with nothing done yet.
  void start_report(StepReport& of_step, double dt) const;
  // The step, in order (step.cpp)
  void try_step(world::StepContext& step);
  void run_step(world::StepContext& step);
  void begin_step(world::StepContext& step);
  void gather(world::StepContext& step);
  void remove_invalid_particles(world::StepContext& step);
  void choose_substeps(world::StepContext& step);  // time_step.cpp
  int within_budget(world::StepContext& step, int least, int count);
  void run_interval(world::IntervalContext& interval);
  void find_hosts(world::IntervalContext& interval) const;
  void begin_interval(world::IntervalContext& interval);
  void emit(world::IntervalContext& interval);  // emit.cpp
  void predict_motion(world::IntervalContext& interval) const;
  void propose(world::IntervalContext& interval, contact::ContactPass& pass);
  double passed(const world::IntervalContext& interval) const;
  void apply_surfaces(world::IntervalContext& interval, contact::ContactPass& pass);
  void act(world::IntervalContext& interval);
  void predict_contacts(world::IntervalContext& interval, contact::ContactPass& pass) const;
  void propose_motion(world::IntervalContext& interval);
  void press_gaps(world::IntervalContext& interval);
  bool propose_end(world::IntervalContext& interval, std::size_t i) const;
  void end_interval(world::IntervalContext& interval, const ParticleMotion& motion);
  void verify(world::IntervalContext& interval, const ParticleMotion& motion) const;
  void exchange(world::IntervalContext& interval, Span<const Contact> near);
  void notify_observer(world::IntervalContext& interval);
  void commit(world::IntervalContext& interval);
  bool commit_particle(world::IntervalContext& interval, std::size_t i, world::EndSums& sums);
  bool keep_mass(world::IntervalContext& interval, std::size_t i, world::EndSums& sums);
  void release(world::StepContext& step);
  void scatter(world::StepContext& step);
  void finish(world::StepContext& step);
  void advise_on_energy(world::StepContext& step) const;

  // Between steps (removal.cpp)
  template <class Chosen>
  std::uint64_t remove_where(Chosen chosen);
  void withdraw(std::size_t particle);
  void book_withdrawn(world::StepContext& step);

  // Sinks (sinks.cpp)
  bool takes(world::IntervalContext& interval, std::size_t particle, world::EndSums& sums) const;
  void count_taken(world::IntervalContext& interval, Span<const std::uint8_t> keep);

  // Null for what there is not
  std::vector<double>* particle_values(const Effect& effect, std::size_t channel);
  std::vector<double>* node_values(const Effect& effect, SurfaceId id, std::size_t channel);

  ParticleMotion motion_of(world::IntervalContext& interval);

  // A step that fails leaves no trace: what it changes in place is copied before and put back
  // (world.cpp).
  void checkpoint();
  void roll_back() noexcept;

  // Between steps (save.cpp)
  void visit_state(Archive& archive);
  Status restore(Span<const std::uint8_t> saved);
  Status translate(const Vec3& offset);  // translate.cpp

  // How long it may be (time_step.cpp)
  world::Speeds speeds(Span<SurfaceMotion* const> moved, double moved_for, double dt) const;
  double stable_parts(const world::Speeds& found, double dt) const;
  void report_instability(world::StepContext& step, const world::Speeds& found) const;
  void report_load(world::StepContext& step, double loaded) const;
  double loaded_interval(const world::Speeds& found) const;  ///< in which the water carries itself [s]
  double longest_dt(double largest) const;
};

}  // namespace oilskin
