/// The cases, each in a file of its own; case_table.cpp lists them.
#pragma once

#include "study/cases/case.h"

namespace oilskin::demo {

ValidationCase weight_case();

}  // namespace oilskin::demo
