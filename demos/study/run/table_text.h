/// Text of the tables of a study.
#pragma once

#include <string>

#include "scene/fields.h"

namespace oilskin::demo {

/// By printf's pattern, of at most 47 characters; a dash where the value is not finite.
std::string format_number(const char* pattern, double value);
/// "Machine: key value; … key value."
std::string machine_line(const Json& machine);

}  // namespace oilskin::demo
