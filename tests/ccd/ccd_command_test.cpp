// `oilskin ccd`: output, exit codes, malformed input.
#include "ccd_command.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <regex>
#include <sstream>

namespace oilskin::test {
namespace {

const std::string kData = std::string(OILSKIN_TEST_DATA) + "/";

struct Outcome {
  int code;
  std::string out, err;
};

Outcome run(const std::vector<std::string>& files) {
  std::ostringstream out, err;
  const int code = demo::ccd_command(files, out, err);
  return {code, out.str(), err.str()};
}

/// A file that goes away with the test.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& text)
      : name_(testing::TempDir() + "oilskin_ccd_" + std::to_string(++count_) + "_" +
              testing::UnitTest::GetInstance()->current_test_info()->name() + ".csv") {
    std::ofstream(name_) << text;
  }
  ~TemporaryFile() { std::remove(name_.c_str()); }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  const std::string& name() const { return name_; }

 private:
  static int count_;
  std::string name_;
};

int TemporaryFile::count_ = 0;

/// The unit triangle at rest, a point that falls through it.
std::string falling_point(char label, const std::string& x = "1,4") {
  const std::string end = std::string(",") + label + "\n";
  const std::string triangle = "0,1,0,1,0,1" + end + "1,1,0,1,0,1" + end + "0,1,1,1,0,1" + end;
  return x + ",1,4,1,1" + end + triangle + x + ",1,4,-1,1" + end + triangle;
}

TEST(CcdCommand, prints_a_line_per_file_and_a_total) {
  const Outcome outcome = run({kData + "unit-tests.csv", kData + "erleben-wedges.csv"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  std::istringstream lines(outcome.out);
  std::string first, second, total, none;
  std::getline(lines, first);
  std::getline(lines, second);
  std::getline(lines, total);
  EXPECT_FALSE(std::getline(lines, none));
  EXPECT_NE(first.find("unit-tests.csv"), std::string::npos);
  EXPECT_NE(second.find("erleben-wedges.csv"), std::string::npos);
  const std::regex pattern(
      "total: queries 500, hits 138, false negatives 0, false positives 0, ns/query [0-9]+\\.[0-9]");
  EXPECT_TRUE(std::regex_match(total, pattern)) << total;
}

TEST(CcdCommand, counts_wrong_labels) {
  const TemporaryFile right(falling_point('1')), positive(falling_point('0'));
  EXPECT_EQ(run({right.name()}).code, 0);
  const Outcome outcome = run({positive.name()});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_NE(outcome.out.find("total: queries 1, hits 0, false negatives 0, false positives 1"),
            std::string::npos);
}

TEST(CcdCommand, false_negative_is_exit_code_one) {
  const TemporaryFile file(falling_point('1') + falling_point('1', "4,1"));
  const Outcome outcome = run({file.name()});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(outcome.out.find("total: queries 2, hits 2, false negatives 1, false positives 0"),
            std::string::npos);
}

TEST(CcdCommand, reads_long_numbers_and_blank_lines) {
  const std::string quarter = "2500000000000000000000000000000000,10000000000000000000000000000000000";
  const TemporaryFile file(falling_point('1', quarter) + "\n\r\n");
  std::vector<demo::LabelledQuery> queries;
  std::string error;
  ASSERT_TRUE(demo::read_queries(file.name(), &queries, &error)) << error;
  ASSERT_EQ(queries.size(), 1u);
  EXPECT_EQ(queries[0].motion.p_t0[0], 0.25);
  EXPECT_EQ(queries[0].motion.p_t1[2], -1);
  EXPECT_EQ(queries[0].motion.c_t1[1], 1);
}

TEST(CcdCommand, refuses_what_it_cannot_read) {
  EXPECT_EQ(run({}).code, 2);
  const Outcome missing = run({kData + "unit-tests.csv", "no/such/file.csv"});
  EXPECT_EQ(missing.code, 2);
  EXPECT_TRUE(missing.out.empty());
  EXPECT_NE(missing.err.find("no/such/file.csv"), std::string::npos);
  EXPECT_EQ(run({OILSKIN_TEST_DATA}).code, 2);  // a folder
}

TEST(CcdCommand, names_file_and_line_of_malformed_input) {
  const std::string good = falling_point('1');
  const struct {
    std::string text;
    std::string where;
  } cases[] = {
      {"", ""},
      {"\n\n", ":2"},
      {good + "1,1\n", ":9"},
      {good + "1,1,1,1,1,1,1\n", ":9"},    // one row of a second query
      {"1,1,1,1,1,1\n" + good, ":1"},      // no label
      {"1,1,1,1,1,1,2\n" + good, ":1"},    // not a label
      {"1,1,1,1,1,1,1,1\n" + good, ":1"},  // too many fields
      {"1,0,1,1,1,1,1\n" + good, ":1"},    // zero denominator
      {"1.5,1,1,1,1,1,1\n" + good, ":1"},  // not whole
      {"a,1,1,1,1,1,1\n" + good, ":1"},
      {" 1,1,1,1,1,1,1\n" + good, ":1"},
      {good + "1,1,1,1,1,1,0\n1,1,1,1,1,1,1\n", ":10"},               // labels differ
      {"1" + std::string(400, '0') + ",1,1,1,1,1,1\n" + good, ":1"},  // beyond the range of doubles
  };
  for (const auto& c : cases) {
    const TemporaryFile file(c.text);
    const Outcome outcome = run({file.name()});
    EXPECT_EQ(outcome.code, 2) << c.text;
    EXPECT_TRUE(outcome.out.empty());
    EXPECT_NE(outcome.err.find(file.name() + c.where), std::string::npos) << outcome.err;
  }
}

}  // namespace
}  // namespace oilskin::test
