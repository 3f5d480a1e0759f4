/// Times and places at which particles start. Contact decides whether a start is free; a blocked one waits.
#pragma once

#include <memory>
#include <optional>

#include "core/archive.h"
#include "oilskin/emitter.h"

namespace oilskin::fluid {

/// A particle that starts within the coming interval.
struct Start {
  Vec3 position = Vec3::Zero();  ///< [m], where the certified path of the particle begins
  Vec3 velocity = Vec3::Zero();  ///< [m/s]
  double remaining = 0;          ///< time from the emission to the end of the interval [s], 0 … dt
  double max_age = std::numeric_limits<double>::infinity();  ///< after which it ends [s]
  std::uint32_t volume = 0;                                  ///< of a box or a mesh: its number; 0 = of none
};

/// What became of a start.
enum class Outcome : std::uint8_t { emitted, blocked, lost };

class Emission {
 public:
  Emission(double spacing, double rest_density, double particle_mass);
  ~Emission();

  /// Null `id`: the emitter is forgotten when it has ended. Otherwise its handle, from 1 on, and its number
  /// of particles is kept until remove(). Null `pose`: the emitter is where it was given.
  Status add(const DiscEmitter& emitter, const EmitterPose* pose = nullptr, std::uint64_t* id = nullptr);
  Status add(const BoxEmitter& emitter, const EmitterPose* pose = nullptr, std::uint64_t* id = nullptr);
  Status add(const MeshEmitter& emitter, const EmitterPose* pose = nullptr, std::uint64_t* id = nullptr);
  Status add(const RainEmitter& emitter, const EmitterPose* pose = nullptr, std::uint64_t* id = nullptr);

  // Changes from `time` [s] on, between steps. All refuse an unknown handle, and change nothing of an emitter
  // that has ended.
  struct Motion {
    double begin = 0;     ///< now [s]
    double duration = 0;  ///< [s], 0 … 1e6; 0: the next step
    bool jumps = false;   ///< the emitter is there at once
  };
  /// The emitter moves there from where it is.
  Status move(std::uint64_t id, const EmitterPose& pose, const Motion& motion);
  /// The same for a nozzle, by the shortest turn of its axis. Refuses other emitters.
  Status aim(std::uint64_t id, const Vec3& center, const Vec3& direction, const Motion& motion);
  Status set_speed(std::uint64_t id, double speed, double time);
  Status set_drops_per_second(std::uint64_t id, double rate, double time);
  Status set_enabled(std::uint64_t id, bool enabled, double time);
  Status set_inherited_velocity(std::uint64_t id, const Vec3& velocity);
  /// Of particles that start from now on [s].
  Status set_max_age(std::uint64_t id, double seconds);
  /// Whether there was such an emitter.
  bool remove(std::uint64_t id);
  /// None for an unknown handle.
  std::optional<EmitterState> state(std::uint64_t id) const;

  /// The next calls of due() are for parts of this step, in which emitters move.
  void begin_step(double time, double dt);
  /// Starts that are due in [time, time + dt), those that waited first. A function of the sequence of calls.
  const std::vector<Start>& due(double time, double dt);

  /// How many the last due() found.
  std::size_t due_count() const;

  /// Speed of the fastest start that may be due in the step [time, time + dt) [m/s]; 0 = none.
  double fastest_due(double time, double dt) const;

  /// Bounds of the boxes and meshes that are due in the step [time, time + dt); empty = there are none.
  Box due_volumes(double time, double dt) const;

  /// Takes what became of the starts of the last due(), and returns how many were blocked. A blocked start
  /// of a nozzle waits, at most one per lattice site, and is due again at the next call with remaining = dt.
  /// Further starts of a site at which one waits are lost, as are blocked points of volumes, which are filled
  /// once.
  std::uint64_t settle(Span<const Outcome> outcomes);

  /// For a step that may fail: checkpoint() copies the state of the emitters, roll_back() restores it,
  /// commit() ends the step at `time`: emitters have moved, and those that have ended are forgotten.
  void checkpoint();
  void roll_back() noexcept;
  void commit(double time) noexcept;

  /// All are elsewhere by `offset` [m], without a motion.
  void translate(const Vec3& offset);
  /// The emitters with their state between two steps, at `time` [s].
  void visit(Archive& archive, double time);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Largest number of particles of a volume: a run of as many needs about 60 GB.
constexpr double most_points = 5e7;

/// Points of the cubic lattice inside a closed mesh, by winding number. The lattice is centred in the
/// bounding box. Refuses indices out of range, non-finite vertices and more than most_points.
Status lattice_inside(const MeshEmitter& mesh, double spacing, std::vector<Vec3>* points);

}  // namespace oilskin::fluid
