/// An outside auditor of motion traces: does any particle cross or touch a triangle along its path, come too
/// near at the end, or jump between records? It trusts nothing of the library: own reader, own search, exact
/// arithmetic.
#pragma once

#include <cstdint>
#include <iosfwd>
#include <map>
#include <string>
#include <vector>

#include "audit/motion_trace.h"

namespace oilskin::audit {

struct Limits {
  /// Least distance δ at the end of an interval [m], per surface id; 0 = not checked. Held to within 1e-12
  /// relative.
  std::map<std::uint64_t, double> delta_of;
  double delta = 0;  ///< of surfaces that `delta_of` does not name

  double of(std::uint64_t surface) const {
    const auto found = delta_of.find(surface);
    return found == delta_of.end() ? delta : found->second;
  }
};

struct Summary {
  std::uint64_t records = 0;
  std::uint64_t particles = 0;    ///< paths looked at, summed over the records
  std::uint64_t triangles = 0;    ///< likewise
  std::uint64_t pairs = 0;        ///< whose boxes over the interval overlap
  std::uint64_t exact_pairs = 0;  ///< that plain arithmetic could not decide
  std::uint64_t crossings = 0;    ///< pairs that touch and change sides
  std::uint64_t touchings = 0;    ///< pairs that touch otherwise (initial contact and rest included)
  std::uint64_t too_near = 0;     ///< pairs nearer than δ at the end
  std::uint64_t jumps = 0;        ///< starts that are not bit for bit the end in the record before
  std::uint64_t invalid = 0;  ///< numbers not finite, ids twice, indices out of range, records out of order
  std::vector<std::string> details;  ///< the first findings, in words

  std::uint64_t findings() const { return crossings + touchings + too_near + jumps + invalid; }
};

std::ostream& operator<<(std::ostream& out, const Summary& summary);

/// Audits one record after another.
class Auditor {
 public:
  explicit Auditor(Limits limits) : limits_(std::move(limits)) {}

  void audit(const Record& record);
  const Summary& summary() const { return summary_; }

 private:
  void check_form(const Record& record);
  void check_jumps(const Record& record);
  void check_surface_jump(const Surface& before, const Surface& now, std::uint64_t number);
  void check_pairs(const Record& record);
  void report(std::uint64_t* counter, const std::string& what);

  Limits limits_;
  Summary summary_;
  Record previous_;
};

/// Audits a whole stream. False and `error` where the trace is malformed; the summary covers what was read so
/// far.
bool audit_stream(std::istream& in, const Limits& limits, Summary* summary, std::string* error);

}  // namespace oilskin::audit
