/// What an emitter is made of, and its state.
#pragma once

#include "core/archive.h"
#include "oilskin/emitter.h"

namespace oilskin::fluid {

/// Shortest time between layers or drops [s], so that their times are distinct numbers.
constexpr double min_period = 1e-9;
/// Longest motion of an emitter [s].
constexpr double max_move = 1e6;

/// When an emitter starts its layers or drops. Its phase, their number so far, grows by 1 in each period
/// while it runs. A change of the period, and a pause, keep the phase (F.74).
struct Schedule {
  double start = 0, stop = 0;  // [s]
  double period = 0;           // [s]; 0: a volume, which has no phase
  bool runs = true;            // false: the phase rests
  double origin = 0;           // when the phase was `phase`, from `start` on [s]
  double phase = 0;

  /// Begins at `from` with the phase 0.
  void begin_at(double from, double to);
  double phase_at(double time) const;
  /// What is changed after this call holds from `time` on.
  void rebase(double time);
  /// When the phase is x [s]; infinite while it rests.
  double time_of(double x) const;
};

/// Particles that start together, or layer by layer at times that are a function of a counter: times do not
/// drift, and emission does not depend on dt (F.38), (F.40).
struct Source {
  enum class Kind { nozzle, volume, rain } kind = Kind::volume;
  std::vector<Vec3> sites;  // nozzle: of a layer; volume: all points; rain: of a drop, relative to its centre
  std::vector<Vec3> velocities;   // volume: one per point where they differ
  Vec3 velocity = Vec3::Zero();   // of all others
  double fastest = 0;             // of all of them [m/s]
  Vec3 direction = Vec3::Zero();  // of the velocity, unit; zero: it has none
  double layer = 0;               // nozzle: distance of the layers [m]
  double shake = 0;               // nozzle: largest displacement of a start along each axis [m]
  std::uint64_t seed = 1;
  RainEmitter rain;

  // State
  Schedule schedule;
  bool enabled = true;
  bool begun = false;
  std::uint64_t next = 0;             // layer or drop
  std::vector<std::uint8_t> waiting;  // nozzle: per site

  // Where it is. All above is as it was given to add().
  bool placed = false;                                       // false: as given
  Vec3 center = Vec3::Zero();                                // as given [m]
  EmitterPose from, to;                                      // of its motion; equal: it rests
  double move_begin = 0, move_length = 0;                    // [s]; length 0: the motion takes the next step
  Vec3 inherited_velocity = Vec3::Zero();                    // [m/s]
  double max_age = std::numeric_limits<double>::infinity();  // of its particles [s]

  std::uint64_t id = 0;
  bool is_held = false;  // the user has its handle
  std::uint64_t emitted = 0;

  /// Skips what would have started before `time`, the first that it is asked for.
  void begin(double time);
  /// The phase in which layer or drop k starts.
  double phase_of(std::uint64_t k) const;
  /// When layer or drop k starts [s].
  double time_of(std::uint64_t k) const;
  /// Where the particle of a site starts, in the layer or drop `next`, before the emitter is put at its pose.
  Vec3 place_of(std::size_t site) const;
  Vec3 velocity_of(std::size_t site) const { return velocities.empty() ? velocity : velocities[site]; }
  /// The same for all particles.
  void set_velocity(const Vec3& v);
  /// Changes the part that all particles have in common.
  void set_speed(double speed, double time);
  /// Whether its phase grows.
  void update_running();
  /// No start comes after `time`, and none waits.
  bool is_over(double time) const;
};

/// The pose of a source when `part` of its motion is over, 0 … 1.
EmitterPose pose_of(const Source& source, double part);

/// A source when `part` of its motion of `length` [s] is over, 0 … 1.
class PlacedSource {
 public:
  PlacedSource(const Source& source, double part, double length);
  Vec3 place_of(std::size_t site) const;
  Vec3 velocity_of(std::size_t site) const;

 private:
  const Source& source_;
  Vec3 position_ = Vec3::Zero();
  Eigen::Matrix3d turn_ = Eigen::Matrix3d::Identity();
  Vec3 added_velocity_ = Vec3::Zero();
};

/// Largest speed that what carries the emitter, and a nozzle's motion, may add in a step of dt [m/s].
double speed_by_motion(const Source& source, double dt);

/// Whether an amplitude in spacings is in range.
Status check_shake(const char* field, double shake);

/// Gives the points of a volume their initial state. Refuses values that are not finite.
Status place(const char* emitter, const Vec3& velocity, const InitialState& initial, double spacing,
             Source& source);

void visit(Archive& archive, Source& source);

/// Checks what add() guarantees, and that the counter matches `time`: a source that is behind would emit all
/// missing layers at once.
bool is_in_range(const Source& source, double time);

}  // namespace oilskin::fluid
