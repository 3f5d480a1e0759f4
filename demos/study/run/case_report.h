/// Tables of a validation.
#pragma once

#include "study/run/case_judgement.h"

namespace oilskin::demo {

/// One row per quantity and run.
std::string validation_csv(const std::vector<CaseLevels>& results);
std::string validation_markdown(const std::vector<CaseLevels>& results, const Json& machine);

}  // namespace oilskin::demo
