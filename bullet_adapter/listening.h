/// Calls of listeners, and what is summed for the owner of a coupling.
#pragma once

#include "oilskin/bullet.h"
#include "oilskin/bullet_listener.h"
#include "oilskin/bullet_sensor.h"

namespace oilskin::bullet {

struct Attachment;

/// What a coupling remembers of the water on one object.
struct Touched {
  SurfaceLoad total;  ///< since the owner took it
  bool is_touched = false;
  double since_touch = 0;  ///< [s]
};

/// A call that is due.
struct FluidEvent {
  enum class Kind { touch_began, splash, touch_ended, water_entered, water_left, stepped };
  Kind kind = Kind::stepped;
  std::uint64_t attachment = 0;  ///< its number; 0 = of no object
  btFluidTouch touch;
  btFluidFlow flow;
};

/// The listeners of a coupling and the calls that are due.
struct Listening {
  std::vector<btFluidListener*> listeners;
  std::vector<FluidEvent> due;
  StepReport report;        ///< of the step that the calls are about
  StepReport sum;           ///< since the owner took it
  double touch_hold = 0.1;  ///< [s]
  bool is_telling = false;  ///< a listener is being called
  StepReport refused;       ///< what a step within a call returns

  /// Whether a listener is still there: it may have been removed by a call.
  bool has(const btFluidListener* listener) const;
  /// Puts the load of one surface into `touched` and, with listeners, the calls that follow into `due`.
  void add_load(const SurfaceMotion& surface, double area, double dt, std::uint64_t attachment,
                Touched& touched);
  /// The same for an object that took no part in the step.
  void add_no_load(double dt, std::uint64_t attachment, Touched& touched);
  /// Puts the calls of a sensor into `due`.
  void add_flow(const btFluidFlow& flow, std::uint64_t attachment);
};

}  // namespace oilskin::bullet
