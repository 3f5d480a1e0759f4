/// What a hard case came to, for the table in docs/validation/hard_cases.md.
#pragma once

#include <string>

namespace oilskin::test {

/// Records the row of the running test: `number` as in the table ("9", "9b"), what was done and what was
/// measured, each in a few words without '|'. Written only when the environment names a folder
/// (OILSKIN_HARD_CASES), which the target `print_hard_cases` does. Call it last; a row says "failed" when the
/// test failed before.
void record_outcome(const std::string& number, const std::string& what, const std::string& measured);

/// A number as the table shows it: three digits.
std::string shown(double value);

}  // namespace oilskin::test
