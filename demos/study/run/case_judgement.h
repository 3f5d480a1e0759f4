/// What passes, and how errors fall with the spacing.
#pragma once

#include <optional>

#include "study/run/case_run.h"

namespace oilskin::demo {

/// A case with its runs, one per spacing.
struct CaseLevels {
  const ValidationCase& of;
  std::vector<CaseRun> runs;
};

/// Of a quantity in a run: its tolerance times (spacing / finest spacing of the case)^order.
double tolerance_at(const ValidationCase& of, const CaseRun& run, const Quantity& quantity);
/// "ok", "MISSED", or "" where there is no tolerance.
const char* verdict(const ValidationCase& of, const CaseRun& run, const Quantity& quantity);
/// It reached its end, nothing crossed, and no tolerance is missed.
bool passes(const ValidationCase& of, const CaseRun& run);
/// The slope of log(error) over log(spacing) through all runs by least squares. Absent with fewer than two
/// runs, and where an error is below the reference's uncertainty, zero, or not finite: it says nothing then.
std::optional<double> observed_order(const CaseLevels& levels, const std::string& quantity);

}  // namespace oilskin::demo
