/// @file
/// What a sensor measures: an attached collision object with btCollisionObject::CF_NO_CONTACT_RESPONSE.
#pragma once

#include <cstdint>

namespace oilskin::bullet {

/// Water that entered and left a sensor, relative to the sensor where it moves.
///
/// A particle is inside where its centre is in the shape, surface included. It enters where it is outside
/// before a coupled step and inside after it, and leaves in the opposite case. A particle that is outside
/// before and after enters and leaves where the straight line between, in the frame of the sensor, has a
/// point of the shape. Each counts once a step: a particle that goes in and out again on a curve within a
/// step is not seen.
///
/// Inside now = inside at first + entered − left + appeared − vanished, exactly.
struct btFluidFlow {
  /// Particles that entered.
  std::uint64_t m_entered = 0;
  /// Particles that left.
  std::uint64_t m_left = 0;
  /// Those of both that passed through within one step.
  std::uint64_t m_passed = 0;
  /// Particles that began inside: by emitters, or because the sensor was teleported.
  std::uint64_t m_appeared = 0;
  /// Particles that ended inside, or ended in the step after they were inside: by removal, or because the
  /// sensor was teleported.
  std::uint64_t m_vanished = 0;
  /// The volume at rest density that entered [m³].
  double m_enteredVolume = 0;
  /// The volume that left [m³].
  double m_leftVolume = 0;

  /// Adds counts and volumes.
  btFluidFlow& operator+=(const btFluidFlow& o);
};

/// What a sensor has measured.
struct btFluidReading {
  /// Particles inside after the last coupled step.
  std::uint64_t m_particles = 0;
  /// Their volume at rest density [m³].
  double m_volume = 0;
  /// Since it is a sensor.
  btFluidFlow m_flow;
};

}  // namespace oilskin::bullet
