// `oilskin validate`: exit codes, files, resume, refusals.
#include <gtest/gtest.h>

#include <filesystem>

#include "app/program.h"

namespace oilskin::test {
namespace {

class Validate : public testing::Test {
 protected:
  Outcome validate(const std::vector<std::string>& more) const {
    std::vector<std::string> arguments = {"validate", "--threads", "1", "--out", folder.path("out")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return oilskin(arguments);
  }
  /// A short run of a small case.
  Outcome short_run(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments = {"slope", "--levels", "1"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return validate(arguments);
  }
  std::string only_run() const {
    std::string name;
    for (const auto& entry : std::filesystem::directory_iterator(folder.path("out/runs"))) {
      EXPECT_EQ(name, "") << "one run expected";
      name = "out/runs/" + entry.path().filename().string();
    }
    return name;
  }
  void expect_refused(const Outcome& outcome, const std::vector<std::string>& parts) const {
    EXPECT_EQ(outcome.exit_code, 2) << outcome.out;
    for (const std::string& part : parts)
      EXPECT_NE(outcome.err.find(part), std::string::npos) << "no \"" << part << "\" in: " << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(folder.path("out/validation.csv")));
  }

  Folder folder;
};

TEST_F(Validate, a_good_case_gives_exit_code_0_and_tables) {
  const Outcome outcome = short_run();
  EXPECT_EQ(outcome.exit_code, 0) << outcome.out << outcome.err;
  EXPECT_NE(folder.read("out/validation.csv").find("slope,0.008,"), std::string::npos);
  EXPECT_NE(folder.read("out/validation.md").find("## slope"), std::string::npos);
}

TEST_F(Validate, a_missed_tolerance_gives_exit_code_1) {
  // Water that falls for 20 ms does not press on the floor with its weight yet: no force is measured.
  const Outcome outcome = validate({"weight", "--levels", "1", "--set", "duration=0.02"});
  EXPECT_EQ(outcome.exit_code, 1) << outcome.out << outcome.err;
  EXPECT_NE(outcome.out.find("MISSED"), std::string::npos) << outcome.out;
  EXPECT_NE(folder.read("out/validation.csv").find("MISSED"), std::string::npos);
}

TEST_F(Validate, resumes_with_the_same_files) {
  ASSERT_EQ(short_run().exit_code, 0);
  const std::string run = folder.read(only_run()), csv = folder.read("out/validation.csv");
  const auto made = std::filesystem::last_write_time(folder.path(only_run()));
  const Outcome again = short_run();
  EXPECT_NE(again.out.find("there already"), std::string::npos) << again.out;
  EXPECT_EQ(folder.read(only_run()), run);
  EXPECT_EQ(folder.read("out/validation.csv"), csv);
  EXPECT_EQ(std::filesystem::last_write_time(folder.path(only_run())), made);
}

TEST_F(Validate, repeats_what_is_damaged_or_asked_for) {
  ASSERT_EQ(short_run().exit_code, 0);
  const auto quantities = [&] { return nlohmann::json::parse(folder.read(only_run())).at("quantities"); };
  const nlohmann::json first = quantities();
  for (const char* text : {"", "{", R"({"case": "slope"})"}) {
    folder.write(only_run(), text);
    EXPECT_EQ(short_run().out.find("there already"), std::string::npos) << text;
    EXPECT_EQ(quantities(), first) << "the same numbers again";
  }
  EXPECT_EQ(short_run({"--again"}).out.find("there already"), std::string::npos);
}

TEST_F(Validate, a_variation_has_a_file_of_its_own) {
  // With corrected gradients a step of a half misses the tolerance of the energy.
  const std::vector<std::string> base = {"--set", "fluid.gradient_correction=0"};
  ASSERT_EQ(short_run(base).exit_code, 0);
  ASSERT_EQ(short_run({base[0], base[1], "--step", "0.5"}).exit_code, 0);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path("out/runs")), {}), 2);
}

TEST_F(Validate, refuses_bad_input_before_it_computes) {
  expect_refused(validate({"wieght"}), {"wieght", "no such validation case", "\"weight\""});
  expect_refused(short_run({"--set", "bodies=[]"}), {"--set bodies=[]", "keeps its bodies"});
  expect_refused(short_run({"--set", "cloth.0.iterations=1"}), {"keeps its cloth"});
  expect_refused(short_run({"--set", "emitters.0.start=1"}), {"keeps its emitters"});
  expect_refused(short_run({"--set", "fluid.spacig=0.01"}), {"fluid.spacig", "\"spacing\""});
  expect_refused(short_run({"--host", "x"}), {"--host", "\"x\"", "mock, bullet, bullet64"});
  expect_refused(short_run({"--preset", "x"}), {"--preset", "\"x\"", "measurement"});
  expect_refused(validate({"drift", "--spacing", "-1"}), {"--spacing"});
  expect_refused(validate({"drift", "--levels", "0"}), {"--levels"});
}

TEST_F(Validate, lists_every_case_with_its_spacings) {
  const Outcome outcome = oilskin({"validate", "--list"});
  EXPECT_EQ(outcome.exit_code, 0);
  for (const char* name : {"weight", "sheet_levels", "hammock", "drift"})
    EXPECT_NE(outcome.out.find(std::string(name) + " "), std::string::npos) << name;
  EXPECT_NE(outcome.out.find("10, 5, 2.5 mm"), std::string::npos) << outcome.out;
}

}  // namespace
}  // namespace oilskin::test
