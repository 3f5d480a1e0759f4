/// The effects of a world, and the views through which they act.
#pragma once

#include "core/archive.h"
#include "core/parallel.h"
#include "fluid/fluid_solver.h"
#include "oilskin/effect.h"
#include "world/attachments.h"
#include "world/step_context.h"

namespace oilskin::world {

/// The walls of all particles.
struct VisibleWalls {
  std::vector<VisibleWall> list;     ///< in the order of particles
  std::vector<std::uint32_t> begin;  ///< per particle, and one more

  VisibleWalls(const fluid::WallGeometry& geometry, Span<SurfaceMotion* const> surfaces,
               double support_radius);
};

/// What the effects of an interval see.
struct EffectInput {
  IntervalContext& interval;
  fluid::Particles& particles;
  const fluid::FluidSolver& fluid;
  const FluidSettings& settings;
  const Vec3 gravity;
  const Workers& workers;
  const VisibleWalls* walls = nullptr;  ///< null: no effect needs them
};

class Effects {
 public:
  /// An effect, and which of Particles::values and Attachment::values are its own.
  struct Slot {
    Effect* effect = nullptr;
    std::string name;
    std::vector<double> particle_start, node_start;
    std::size_t first_particle_value = 0, first_node_value = 0;
  };

  bool empty() const { return slots_.empty(); }
  /// The largest of the effects [dx].
  double wall_reach() const;
  /// The shortest of the effects' longest intervals, and whose it is.
  struct Limit {
    double interval = std::numeric_limits<double>::infinity();  ///< [s]
    std::string name;
  };
  Limit longest_interval(const FluidSettings& fluid) const;
  std::size_t node_value_count() const {
    return slots_.empty() ? 0 : slots_.back().first_node_value + slots_.back().node_start.size();
  }
  /// Null for an effect that is not here.
  const Slot* find(const Effect& effect) const;
  /// Refuses an effect that is there, one whose name is, and start values that are not finite.
  Status add(Effect& effect, fluid::Particles& particles, Attachments& attachments);
  /// An effect that is not there is ignored.
  void remove(const Effect& effect, fluid::Particles& particles, Attachments& attachments);
  /// Gives the nodes of meshes that are new their start values.
  void fill(Attachment& attachment) const;

  /// The sum of all accelerations is interval.acceleration then, one per particle.
  void act(const EffectInput& input) const;
  void exchange(const EffectInput& input, Span<const Contact> contacts) const;

  void checkpoint() const {
    for (const Slot& slot : slots_) slot.effect->checkpoint();
  }
  void roll_back() const noexcept {
    for (const Slot& slot : slots_) slot.effect->roll_back();
  }
  void translate(const Vec3& offset) const {
    for (const Slot& slot : slots_) slot.effect->translate(offset);
  }
  /// Takes over the effects of `from`. visit() then accepts a world that was saved with the same ones.
  void take_effects(const Effects& from) { slots_ = from.slots_; }
  void visit(Archive& archive);
  /// Gives each effect what visit() read. A refusal changes nothing.
  Status restore() const;

 private:
  std::vector<Slot> slots_;
  std::vector<std::vector<std::uint8_t>> read_;  // by visit()
};

}  // namespace oilskin::world
