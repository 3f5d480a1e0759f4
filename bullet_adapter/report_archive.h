/// Reports in saved states.
#pragma once

#include "core/archive.h"
#include "oilskin/report.h"

namespace oilskin::bullet {

/// Writes or reads a report.
void visit(Archive& archive, StepReport& report);

}  // namespace oilskin::bullet
