/// Rows of the study, and which of them are on the Pareto front.
#pragma once

#include "study/run/case_run.h"
#include "study/run/sweeps.h"

namespace oilskin::demo {

/// One point of a sweep, run on one case.
struct StudyRow {
  std::string sweep, label, quantity;
  CaseRun run;
  bool on_front = false;

  /// Of the quantity; infinite where the run has none.
  double error() const;
};

/// Marks, case by case, the rows without crossings for which no other row has both a smaller error and a
/// smaller cost.
void mark_pareto_front(std::vector<StudyRow>& rows);

std::string study_csv(const std::vector<StudyRow>& rows);
/// A table per case: error, cost and front.
std::string study_markdown(const std::vector<StudyRow>& rows, const Json& machine);

}  // namespace oilskin::demo
