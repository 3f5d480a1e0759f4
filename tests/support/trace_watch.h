/// An observer that has the trace of a world judged by the outside auditor.
#pragma once

#include <sstream>

#include "audit/trace_auditor.h"
#include "oilskin/trace.h"

namespace oilskin::test {

class TraceWatch : public IntervalObserver {
 public:
  void on_interval(const Interval& interval) override {
    last_ = static_cast<std::size_t>(text_.tellp());
    writer_.on_interval(interval);
    for (const SurfaceMotion* s : interval.surfaces) limits_.delta_of[s->id] = s->delta;
    ++waiting_;
  }

  /// What the auditor says of the intervals since the last call. The last one before them is read again, so
  /// that jumps between two calls are found too.
  audit::Summary judge() {
    audit::Summary summary;
    if (waiting_ == 0) return summary;
    std::istringstream in(text_.str());
    std::string error;
    if (!audit::audit_stream(in, limits_, &summary, &error)) {
      ++summary.invalid;
      summary.details.push_back(error);
    }
    const std::string kept = text_.str().substr(last_);
    text_.str(kept);
    text_.seekp(0, std::ios::end);
    last_ = 0;
    waiting_ = 0;
    return summary;
  }

 private:
  std::ostringstream text_;
  TraceWriter writer_{text_};
  audit::Limits limits_;
  std::size_t last_ = 0;  ///< where the last record begins
  std::size_t waiting_ = 0;
};

}  // namespace oilskin::test
