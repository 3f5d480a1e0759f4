/// What an emitter is made of, and its state.
#pragma once

#include "core/archive.h"
#include "oilskin/emitter.h"

namespace oilskin::fluid {

/// Shortest time between layers or drops [s], so that their times are distinct numbers.
constexpr double min_period = 1e-9;

/// Particles that start together, or layer by layer at times that are a function of a counter: times do not
/// drift, and emission does not depend on dt (F.38), (F.40).
struct Source {
  enum class Kind { nozzle, volume, rain } kind = Kind::volume;
  std::vector<Vec3> sites;  // nozzle: of a layer; volume: all points; rain: of a drop, relative to its centre
  std::vector<Vec3> velocities;  // volume: one per point where they differ
  Vec3 velocity = Vec3::Zero();  // of all others
  double fastest = 0;            // of all of them [m/s]
  double start = 0, stop = 0;
  double period = 0;  // between layers or drops [s]
  double shake = 0;   // nozzle: largest displacement of a start along each axis [m]
  std::uint64_t seed = 1;
  RainEmitter rain;

  // State
  bool begun = false;
  std::uint64_t next = 0;             // layer or drop
  std::vector<std::uint8_t> waiting;  // nozzle: per site

  /// When layer or drop k starts [s].
  double time_of(std::uint64_t k) const;
  /// Where the particle of a site starts, in the layer or drop `next` [m].
  Vec3 place_of(std::size_t site) const;
  Vec3 velocity_of(std::size_t site) const { return velocities.empty() ? velocity : velocities[site]; }
  /// The same for all particles.
  void set_velocity(const Vec3& v);
};

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
