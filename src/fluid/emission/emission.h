/// Times and places at which particles start. Contact decides whether a start is free; a blocked one waits.
#pragma once

#include <memory>

#include "core/archive.h"
#include "oilskin/emitter.h"

namespace oilskin::fluid {

/// A particle that starts within the coming interval.
struct Start {
  Vec3 position = Vec3::Zero();  ///< [m], where the certified path of the particle begins
  Vec3 velocity = Vec3::Zero();  ///< [m/s]
  double remaining = 0;          ///< time from the emission to the end of the interval [s], 0 … dt
};

class Emission {
 public:
  Emission(double spacing, double rest_density, double particle_mass);
  ~Emission();

  Status add(const DiscEmitter& emitter);
  Status add(const BoxEmitter& emitter);
  Status add(const MeshEmitter& emitter);
  Status add(const RainEmitter& emitter);

  /// Starts that are due in [time, time + dt), those that waited first. A function of the sequence of calls.
  const std::vector<Start>& due(double time, double dt);

  /// Speed of the fastest start that may be due in [time, time + dt) [m/s]; 0 = none.
  double fastest_due(double time, double dt) const;

  /// Takes which of the starts of the last due() were blocked (1), and returns their number. A blocked start
  /// of a nozzle waits, at most one per lattice site, and is due again at the next call with remaining = dt.
  /// Further starts of a site at which one waits are lost, as are blocked points of volumes, which are filled
  /// once.
  std::uint64_t settle(Span<const std::uint8_t> blocked);

  /// For a step that may fail: checkpoint() copies the state of the emitters, roll_back() restores it,
  /// commit() frees the points of volumes that have been filled.
  void checkpoint();
  void roll_back() noexcept;
  void commit() noexcept;

  /// The emitters with their state between two steps, at `time` [s].
  void visit(Archive& archive, double time);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Points of the cubic lattice inside a closed mesh, by winding number. The lattice is centred in the
/// bounding box. Refuses indices out of range and non-finite vertices.
Status lattice_inside(const MeshEmitter& mesh, double spacing, std::vector<Vec3>* points);

}  // namespace oilskin::fluid
