#include "study/run/table_text.h"

#include <cmath>
#include <cstdio>

namespace oilskin::demo {

std::string format_number(const char* pattern, double value) {
  if (!std::isfinite(value)) return "–";
  char text[48];
  std::snprintf(text, sizeof text, pattern, value);
  return text;
}

std::string machine_line(const Json& machine) {
  std::string text = "Machine:";
  for (const auto& [key, value] : machine.items())
    text += " " + key + " " + (value.is_string() ? value.get<std::string>() : value.dump()) + ";";
  text.back() = '.';
  return text;
}

}  // namespace oilskin::demo
