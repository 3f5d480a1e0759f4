/// What a test measured, for the test report (--gtest_output=xml).
#pragma once

#include <gtest/gtest.h>

#include <sstream>

namespace oilskin::test {

/// One property of the running test; a second value with the same name replaces the first.
template <class Value>
void record(const std::string& name, const Value& value) {
  std::ostringstream text;
  text << value;
  ::testing::Test::RecordProperty(name, text.str());
}

}  // namespace oilskin::test
