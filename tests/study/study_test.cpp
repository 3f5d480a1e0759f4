// The study: Pareto front, tables that continue, sweeps, and the command's refusals.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "hosts/mock_simulation.h"
#include "scene/options.h"
#include "study/run/obtain_run.h"
#include "study/run/study_table.h"
#include "study/study_command.h"
#include "study/tables/study_tables.h"

namespace oilskin::demo {
namespace {

namespace fs = std::filesystem;

/// A folder that is there while a test runs.
class Study : public ::testing::Test {
 protected:
  std::string directory_;

  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "oilskin-study-XXXXXX").string();
    directory_ = mkdtemp(name.data());
    fs::create_directories(directory_ + "/runs");
  }
  void TearDown() override { fs::remove_all(directory_); }

  std::string text(const std::string& file) const {
    std::ifstream in(directory_ + "/" + file);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  TablePlace table_place() const { return {directory_, 1, false, true, make_mock_simulation}; }
  int study(const std::vector<std::string>& parts, const std::vector<std::string>& cases) const {
    StudyOptions options;
    options.parts = parts;
    options.cases = cases;
    options.out = directory_;
    options.repeat = 1;
    options.quiet = true;
    return study_command(options, HostKind::bullet, make_mock_simulation);
  }
};

StudyRow row(const std::string& of, double error, double seconds) {
  StudyRow row{"sweep", "label", "q", {}};
  row.run.name = of;
  row.run.quantities = {{"q", 1 + error, 1}};
  row.run.cost.simulated_seconds = 1;
  row.run.cost.wall_seconds = {seconds};
  return row;
}

TEST(ParetoFront, has_the_rows_that_no_other_beats) {
  std::vector<StudyRow> rows = {row("a", 0.1, 1),  row("a", 0.05, 2), row("a", 0.06, 3),
                                row("a", 0.01, 9), row("a", 0.05, 4), row("b", 0.5, 50)};
  mark_pareto_front(rows);
  std::vector<bool> front;
  for (const StudyRow& r : rows) front.push_back(r.on_front);
  EXPECT_EQ(front, (std::vector<bool>{true, true, false, true, false, true}));
}

TEST(ParetoFront, leaves_out_what_leaks_fails_or_has_no_number) {
  std::vector<StudyRow> rows = {row("a", 0.01, 1), row("a", 0.02, 1), row("a", 0.03, 1), row("a", 0.9, 9)};
  rows[0].run.crossings = 1;
  rows[1].run.failure = "refused";
  rows[2].run.quantities[0].value = std::nan("");
  mark_pareto_front(rows);
  for (int k = 0; k < 3; ++k) EXPECT_FALSE(rows[static_cast<std::size_t>(k)].on_front) << k;
  EXPECT_TRUE(rows[3].on_front);
}

TEST(StudyRow, costs_are_median_least_and_largest_of_the_repetitions) {
  StudyRow r = row("a", 0.1, 4);
  r.run.cost.wall_seconds = {4, 1, 9};
  r.run.cost.simulated_seconds = 2;
  const Spread cost = r.run.cost.seconds_per_simulated_second();
  EXPECT_EQ(cost.median, 2);
  EXPECT_EQ(cost.min, 0.5);
  EXPECT_EQ(cost.max, 4.5);
}

TEST_F(Study, rows_of_a_table_are_computed_once) {
  int computed = 0;
  const auto value = [&] { return std::to_string(++computed); };
  const std::vector<TableRow> two = {{"one", value}, {"two", value}};
  EXPECT_EQ(rows_of_table("t", "head", two, table_place()), "head\n1\n2\n");
  const std::vector<TableRow> three = {{"two", value}, {"three", value}, {"one", value}};
  EXPECT_EQ(rows_of_table("t", "head", three, table_place()), "head\n2\n3\n1\n");
  TablePlace again = table_place();
  again.again = true;
  EXPECT_EQ(rows_of_table("t", "head", {{"one", value}}, again), "head\n4\n");
  TablePlace other = table_place();
  other.threads = 2;
  EXPECT_EQ(rows_of_table("t", "head", {{"one", value}}, other), "head\n5\n") << "another machine";
}

TEST_F(Study, a_sweep_that_is_resumed_gives_the_same_files) {
  EXPECT_EQ(study({"boundary"}, {"weight"}), 0);
  const std::string csv = text("study.csv"), markdown = text("study.md");
  EXPECT_NE(csv.find("weight,boundary,contact_only,0.005"), std::string::npos) << csv;
  EXPECT_NE(csv.find("weight,boundary,mirrored,0.005"), std::string::npos) << csv;
  EXPECT_EQ(study({"boundary"}, {"weight"}), 0);
  EXPECT_EQ(text("study.csv"), csv) << "times included: nothing was computed again";
  EXPECT_EQ(text("study.md"), markdown);
}

TEST_F(Study, contact_alone_stands_lower_than_with_boundary_terms) {
  RunPlace place{directory_, 1, 1, false, HostKind::bullet, make_mock_simulation};
  const auto error = [&](const std::string& boundary) {
    StudyRow r{"boundary", boundary, "height / depth", {}};
    Variation variation;
    variation.set = {"fluid.boundary=" + boundary};
    r.run = obtain_run(validation_case("weight"), 0.01, variation, place, [](double) {}).run;
    return r.error();
  };
  EXPECT_GT(error("contact_only"), 5 * error("mirrored"));
}

TEST_F(Study, wrong_names_are_refused_before_anything_runs) {
  EXPECT_THROW(study({"toleranc"}, {}), SceneError);
  EXPECT_THROW(study({"boundary"}, {"wait"}), SceneError);
  EXPECT_THROW(sweep("none"), SceneError);
  EXPECT_THROW(study_table("none"), SceneError);
  EXPECT_TRUE(fs::is_empty(directory_ + "/runs"));
}

TEST(Sweeps, are_of_settings_that_scenes_accept) {
  for (const Sweep& s : sweeps())
    for (const StudiedCase& studied : studied_cases()) {
      const ValidationCase& of = validation_case(studied.name);
      for (const SweepPoint& point : points_of(s, of))
        EXPECT_NO_THROW(
            varied_scene(of, point.spacing > 0 ? point.spacing : studied.spacing, point.variation))
            << s.name << " " << point.label;
    }
}

TEST(Sweeps, change_what_they_name) {
  const ValidationCase& of = validation_case("weight");
  Variation v;
  EXPECT_EQ(varied_scene(of, 0.005, v).dt, 0.001);
  v.step = 4;
  v.thickness = 0.5;
  v.set = {"fluid.solver=pcisph"};
  const Scene scene = varied_scene(of, 0.005, v);
  EXPECT_EQ(scene.dt, 0.004);
  EXPECT_EQ(scene.bodies[0].surface.thickness, 0.0025);
  EXPECT_EQ(scene.fluid.solver, PressureSolver::pcisph);
  v.preset = PresetKind::game;
  EXPECT_NE(varied_scene(of, 0.005, v).dt, 0.004) << "the preset has a step of its own";
  v.set = {"bodies.0.thickness=1"};
  EXPECT_THROW(varied_scene(of, 0.005, v), SceneError);
}

}  // namespace
}  // namespace oilskin::demo
