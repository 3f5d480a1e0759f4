#include "hard_cases/hard_case.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>

namespace oilskin::test {

namespace {

const ::testing::TestInfo& current_test() {
  return *::testing::UnitTest::GetInstance()->current_test_info();
}

/// So that files in alphabetical order are rows in numerical order.
std::string padded(const std::string& number) {
  const std::size_t digits = std::min(number.size(), number.find_first_not_of("0123456789"));
  return std::string(3 - std::min<std::size_t>(3, digits), '0') + number;
}

}  // namespace

HardCase::HardCase(std::string number, std::string what)
    : number_(std::move(number)), what_(std::move(what)) {}

HardCase::~HardCase() {
  const char* folder = std::getenv("OILSKIN_HARD_CASES");
  if (folder == nullptr) return;
  std::ofstream(std::string(folder) + "/" + padded(number_) + "." + current_test().name() + ".row") << row();
}

void HardCase::at_most(const std::string& quantity, double value, double limit) {
  EXPECT_LE(value, limit) << quantity;
  add(quantity, shown(value), "≤ " + shown(limit));
}

void HardCase::below(const std::string& quantity, double value, double limit) {
  EXPECT_LT(value, limit) << quantity;
  add(quantity, shown(value), "< " + shown(limit));
}

void HardCase::at_least(const std::string& quantity, double value, double limit) {
  EXPECT_GE(value, limit) << quantity;
  add(quantity, shown(value), "≥ " + shown(limit));
}

void HardCase::above(const std::string& quantity, double value, double limit) {
  EXPECT_GT(value, limit) << quantity;
  add(quantity, shown(value), "> " + shown(limit));
}

void HardCase::equal(const std::string& quantity, std::uint64_t value, std::uint64_t expected) {
  EXPECT_EQ(value, expected) << quantity;
  add(quantity, std::to_string(value), "= " + std::to_string(expected));
}

void HardCase::holds(const std::string& statement, bool value) {
  EXPECT_TRUE(value) << statement;
  add(statement, value ? "yes" : "no", "yes");
}

void HardCase::note(const std::string& quantity, double value) {
  add(quantity, shown(value), "–");
}

void HardCase::note(const std::string& quantity, std::uint64_t value) {
  add(quantity, std::to_string(value), "–");
}

void HardCase::below_on_any_machine(const std::string& quantity, double value, double limit) {
  EXPECT_LT(value, limit) << quantity;
  add(quantity, value < limit ? "below the limit" : "above the limit", "< " + shown(limit));
}

void HardCase::no_crossings(const Found& found) {
  equal("crossings", found.audit.crossings + found.audit.touchings, 0);
}

void HardCase::add(const std::string& quantity, const std::string& value, const std::string& limit) {
  lines_.push_back({quantity + ": " + value, limit});
}

std::string HardCase::row() const {
  std::string measured, limits;
  for (const Line& line : lines_) {
    const char* const separator = measured.empty() ? "" : "<br>";
    measured += separator + line.measured;
    limits += separator + line.limit;
  }
  const bool failed = current_test().result()->Failed();
  return "| " + number_ + " | " + what_ + " | " + measured + " | " + limits + " | " +
         (failed ? "**failed**" : "holds") + " | `" + current_test().name() + "` |\n";
}

std::string shown(double value) {
  const bool whole = std::abs(value) < 1e7 && value == std::floor(value);
  char text[32];
  std::snprintf(text, sizeof text, whole ? "%.0f" : "%.3g", value);
  return text;
}

}  // namespace oilskin::test
