/// @file
/// The motion of certified intervals, for independent auditors (format: docs/manual/commands_and_formats.md,
/// "Motion trace").
#pragma once

#include <iosfwd>

#include "oilskin/surface_motion.h"
#include "oilskin/types.h"

namespace oilskin {

/// What happened in one certified interval. The spans are valid until the observer returns.
struct Interval {
  /// The number of the interval, counted from 0 on.
  std::uint64_t number = 0;
  /// The length of the interval [s].
  double length = 0;
  /// The particles that live at the start or are emitted in the interval, without those that were removed by
  /// contact or as invalid.
  Span<const std::uint64_t> id;
  /// The positions of the particles at the start [m].
  Span<const Vec3> x_t0;
  /// The positions of the particles at the end [m].
  Span<const Vec3> x_t1;
  /// The attached surfaces with their positions at the start and at the end.
  Span<SurfaceMotion* const> surfaces;
};

/// Is called after the certificate of every interval, before anything else moves.
class IntervalObserver {
 public:
  virtual ~IntervalObserver() = default;
  /// Reads one interval.
  virtual void on_interval(const Interval& interval) = 0;
};

/// Writes the motion trace (format OILSTEP1) to a stream.
class TraceWriter : public IntervalObserver {
 public:
  /// The stream must outlive the writer. Its state shows errors of writing.
  explicit TraceWriter(std::ostream& out) : out_(out) {}
  void on_interval(const Interval& interval) override;

 private:
  std::ostream& out_;
};

}  // namespace oilskin
