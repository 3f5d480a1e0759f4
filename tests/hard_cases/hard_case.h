/// The row of a hard case in docs/validation/hard_cases.md.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hard_cases/invariants.h"

namespace oilskin::test {

/// One case: what is done, and each measured quantity beside its limit. A quantity beyond its limit fails the
/// test. The destructor writes the row, with the verdict of the whole test, into the folder that
/// OILSKIN_HARD_CASES names; without that variable nothing is written. Texts hold no '|'.
///
///   HardCase c("12", "particles on free nodes, mass ratios 1e-12 to 1e12");
///   c.at_most("momentum error", found.momentum_error, max_momentum_error);
class HardCase {
 public:
  /// `number` as in the table: "9", "9b".
  HardCase(std::string number, std::string what);
  ~HardCase();
  HardCase(const HardCase&) = delete;
  HardCase& operator=(const HardCase&) = delete;

  void at_most(const std::string& quantity, double value, double limit);
  void below(const std::string& quantity, double value, double limit);
  void at_least(const std::string& quantity, double value, double limit);
  void above(const std::string& quantity, double value, double limit);
  void equal(const std::string& quantity, std::uint64_t value, std::uint64_t expected);
  /// Whatever else must hold, in words.
  void holds(const std::string& statement, bool value);
  /// Measured, without a limit.
  void note(const std::string& quantity, double value);
  void note(const std::string& quantity, std::uint64_t value);
  /// Differs between runs or machines: the row holds the limit, not the value.
  void below_on_any_machine(const std::string& quantity, double value, double limit);

  /// Crossings that the auditor found; none is allowed.
  void no_crossings(const Found& found);

 private:
  struct Line {
    std::string measured, limit;
  };
  void add(const std::string& quantity, const std::string& value, const std::string& limit);
  std::string row() const;

  std::string number_, what_;
  std::vector<Line> lines_;
};

/// A number as the table shows it: whole, or with three digits.
std::string shown(double value);

}  // namespace oilskin::test
