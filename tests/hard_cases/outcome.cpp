#include "hard_cases/outcome.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>

namespace oilskin::test {

void record_outcome(const std::string& number, const std::string& what, const std::string& measured) {
  const char* folder = std::getenv("OILSKIN_HARD_CASES");
  if (folder == nullptr) return;
  const std::string digits = number.substr(0, number.find_first_not_of("0123456789"));
  const std::string padded = std::string(3 - std::min<std::size_t>(3, digits.size()), '0') + number;
  const ::testing::TestInfo* test = ::testing::UnitTest::GetInstance()->current_test_info();
  const bool failed = test != nullptr && test->result()->Failed();
  std::ofstream file(std::string(folder) + "/" + padded + "." + (test ? test->name() : "none") + ".row");
  file << "| " << number << " | " << what << " | " << measured << " | " << (failed ? "**failed**" : "holds")
       << " | `" << (test ? test->name() : "") << "` |\n";
}

std::string shown(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

}  // namespace oilskin::test
