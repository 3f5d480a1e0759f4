/// When and where particles start. Contact decides whether a start is free; a blocked one waits.
#pragma once

#include <memory>

#include "core/archive.h"
#include "oilskin/emitter.h"

namespace oilskin::fluid {

/// A particle that starts within the coming interval.
struct Start {
  Vec3 position = Vec3::Zero();  ///< the nozzle point [m]: where its certified path begins
  Vec3 velocity = Vec3::Zero();  ///< [m/s]
  double remaining = 0;          ///< part of the interval left after the emission [s], 0 … dt
};

class Emission {
 public:
  Emission(double spacing, double rest_density, double particle_mass);
  ~Emission();

  Status add(const DiscEmitter& emitter);
  Status add(const BoxEmitter& emitter);
  Status add(const MeshEmitter& emitter);
  Status add(const RainEmitter& emitter);

  /// Starts that fall due in [time, time + dt), those that waited first. Deterministic: depends on the calls
  /// alone.
  const std::vector<Start>& due(double time, double dt);

  /// Speed of the fastest start that may fall due in [time, time + dt) [m/s]; 0 = none. Changes nothing.
  double fastest_due(double time, double dt) const;

  /// Says which of the starts of the last due() were blocked (1). Starts of nozzles wait, one per lattice
  /// site, and are due again at the next call (with remaining = dt); further starts of a site that has one
  /// waiting are lost, and so are blocked points of volumes that are filled once. Returns how many were
  /// blocked.
  std::uint64_t settle(Span<const std::uint8_t> blocked);

  /// For a step that may fail: checkpoint() remembers how far the emitters are, roll_back() returns to there,
  /// commit() frees the points of volumes that were filled since.
  void checkpoint();
  void roll_back() noexcept;
  void commit() noexcept;

  /// Emitters with their phases and waiting starts, as they are between two steps at `time` [s].
  void visit(Archive& archive, double time);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Points of the cubic lattice of `spacing` inside a closed mesh by winding number, lattice aligned to the
/// centre of the bounding box. Refuses indices out of range and non-finite vertices.
Status lattice_inside(const MeshEmitter& mesh, double spacing, std::vector<Vec3>* points);

}  // namespace oilskin::fluid
