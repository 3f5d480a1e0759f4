// The shipped scenes: shortened in the default suite, whole in the slow one.
#include <gtest/gtest.h>

#include <iomanip>
#include <sstream>

#include "scenes/program.h"

namespace oilskin::test {
namespace {

struct Short {
  const char* scene;
  const char* duration;
};

const Short shortened[] = {{"jet", "0.1"},   {"slip", "0.22"},        {"vee", "0.14"},  {"rain", "0.3"},
                           {"bowl", "0.15"}, {"high_speed", "0.003"}, {"sweep", "0.02"}};

std::string name_of(const testing::TestParamInfo<Short>& info) {
  return info.param.scene;
}

class ShortRun : public testing::TestWithParam<Short> {};

TEST_P(ShortRun, keepsThePromiseAndTheLedgers) {
  const auto report = report_of(GetParam().scene, GetParam().duration, {});
  EXPECT_EQ(report["contact"]["crossings_found_by_verify"], 0);
  EXPECT_GT(report["contact"]["contacts"].get<int>(), 0) << "nothing touched anything: the run is too short";
  EXPECT_EQ(report["acceptance"].size(), 5u);
}

INSTANTIATE_TEST_SUITE_P(Scenes, ShortRun, testing::ValuesIn(shortened), name_of);

class Threads : public testing::TestWithParam<Short> {};

TEST_P(Threads, doNotChangeABit) {
  const auto one = report_of(GetParam().scene, GetParam().duration, {"--threads", "1"});
  const auto two = report_of(GetParam().scene, GetParam().duration, {"--threads", "2"});
  EXPECT_EQ(one["state_hash"], two["state_hash"]);
  EXPECT_EQ(one["momentum"]["to_free_nodes"], two["momentum"]["to_free_nodes"]);
}

INSTANTIATE_TEST_SUITE_P(Scenes, Threads, testing::ValuesIn(shortened), name_of);

TEST(ShortRunHosts, doublePrecisionAndTheMockKeepThePromiseToo) {
  for (const char* host : {"bullet64", "mock"}) {
    const auto report = report_of("jet", "0.1", {"--set", std::string("host=") + host});
    EXPECT_EQ(report["machine"]["precision"], "float64") << host;
    EXPECT_EQ(report["contact"]["crossings_found_by_verify"], 0) << host;
    EXPECT_GT(report["contact"]["contacts"].get<int>(), 0) << host;
  }
}

// The paper's Fig. 4, left: repulsion alone lets water through, and verify sees it.
TEST(Leak, withoutTheContinuousTestAndZonesCrossingsAreCounted) {
  const Folder folder;
  const Outcome outcome = oilskin({"run", "jet", "--quiet", "--no-render", "--frames-per-second", "0",
                                   "--out", folder.path(), "--duration", "0.15", "--set", "contact.ccd=false",
                                   "--set", "contact.zones=false", "--set", "acceptance={}"});
  EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
  const auto report = nlohmann::json::parse(folder.read("report.json"), nullptr, false);
  EXPECT_GT(report["contact"]["crossings_found_by_verify"].get<int>(), 0);
}

#ifdef OILSKIN_AUDIT

class Audit : public testing::TestWithParam<Short> {};

TEST_P(Audit, findsNoCrossingInTheTrace) {
  const Folder folder;
  const auto report = report_of(GetParam().scene, GetParam().duration, {"--trace", folder.path("trace")});
  // The auditor holds every surface to the δ that the run promised (the least of all surfaces).
  std::ostringstream delta;
  delta << std::setprecision(17) << report["contact"]["delta"].get<double>();
  const Outcome outcome = run_program(OILSKIN_AUDIT, {"--delta", delta.str(), folder.path("trace")});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.out << outcome.err;
}

INSTANTIATE_TEST_SUITE_P(Scenes, Audit, testing::ValuesIn(shortened), name_of);

TEST(Audit, findsTheCrossingsOfARunThatLeaks) {
  const Folder folder;
  oilskin({"run", "jet", "--quiet", "--no-render", "--frames-per-second", "0", "--out", folder.path(),
           "--duration", "0.12", "--trace", folder.path("trace"), "--set", "contact.ccd=false", "--set",
           "contact.zones=false"});
  EXPECT_EQ(run_program(OILSKIN_AUDIT, {folder.path("trace")}).exit_code, 1);
}

#endif

class FullRun : public testing::TestWithParam<Short> {};

TEST_P(FullRun, passesItsOwnAcceptance) {
  const auto report = report_of(GetParam().scene, "", {});
  for (const auto& check : report["acceptance"]) EXPECT_TRUE(check["ok"].get<bool>()) << check;
}

INSTANTIATE_TEST_SUITE_P(Scenes, FullRun, testing::ValuesIn(shortened), name_of);

}  // namespace
}  // namespace oilskin::test
