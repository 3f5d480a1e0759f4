/// The motion of certified intervals, for independent auditors (docs/manual/commands_and_formats.md:
/// "Motion trace").
#pragma once

#include <iosfwd>

#include "oilskin/surface_motion.h"
#include "oilskin/types.h"

namespace oilskin {

/// What happened in one certified interval. The spans live until the observer returns.
struct Interval {
  std::uint64_t number = 0;
  double length = 0;  ///< [s]
  /// Particles that live at the start or are emitted in the interval, without those given up or quarantined.
  Span<const std::uint64_t> id;
  Span<const Vec3> x_t0, x_t1;
  Span<SurfaceMotion* const> surfaces;
};

/// Told after the certificate of every interval, before anything else moves.
class IntervalObserver {
 public:
  virtual ~IntervalObserver() = default;
  virtual void on_interval(const Interval& interval) = 0;
};

/// Writes records of the motion trace (format OILSTEP1) to a stream.
class TraceWriter : public IntervalObserver {
 public:
  explicit TraceWriter(std::ostream& out) : out_(out) {}
  void on_interval(const Interval& interval) override;

 private:
  std::ostream& out_;
};

}  // namespace oilskin
