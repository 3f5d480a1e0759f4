/// Runs of cases as files, so that what is there is not computed again.
#pragma once

#include <optional>

#include "study/run/case_run.h"

namespace oilskin::demo {

/// Processor cores, threads, compiler, instruction set and commit.
Json machine_of_study(int threads);

/// DIR/runs/CASE_SPACING[_VARIATION].json
std::string case_file(const std::string& directory, const std::string& name, double spacing,
                      const Variation& variation);
/// Throws OutputError.
void write_case_run(const std::string& path, const CaseRun& run, int threads);
/// The run that `path` holds, if it is that of these settings and not older than the program.
std::optional<CaseRun> read_case_run(const std::string& path, const std::string& name, double spacing,
                                     const Variation& variation, int threads);

}  // namespace oilskin::demo
