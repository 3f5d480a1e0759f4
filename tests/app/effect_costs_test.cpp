// Statistics, tables and plot of what effects cost, of runs that are given.
#include <gtest/gtest.h>

#include <sstream>

#include "output/effect_table.h"

namespace oilskin::demo {
namespace {

RunCost run_of(double wall, double memory) {
  RunCost run;
  run.wall_seconds = run.cpu_seconds = wall;
  run.effects_seconds = 0.25 * wall;
  run.stages_seconds = 0.9 * wall;
  run.simulated_seconds = 0.5;
  run.peak_memory = memory;
  run.particles = 100;
  run.threads = 1;
  return run;
}

EffectCost cost_of(const std::string& name, const std::vector<double>& walls, double memory) {
  EffectCost cost{name, Json::object(), {}};
  for (double wall : walls) cost.runs.push_back(run_of(wall, memory));
  return cost;
}

/// The heights of the rectangles of one colour.
std::vector<double> heights(const std::string& svg, const std::string& colour) {
  std::vector<double> found;
  std::istringstream lines(svg);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t at = line.find("height=\"");
    if (line.find("<rect ") == 0 && line.find(colour) != std::string::npos)
      found.push_back(std::stod(line.substr(at + 8)));
  }
  return found;
}

TEST(EffectCosts, the_median_is_that_of_sorted_values) {
  const Spread odd = spread_of({5, 1, 3}), even = spread_of({4, 1, 2, 9}), one = spread_of({7});
  EXPECT_EQ(odd.median, 3);
  EXPECT_EQ(odd.min, 1);
  EXPECT_EQ(odd.max, 5);
  EXPECT_EQ(even.median, 3);
  EXPECT_EQ(one.median, 7);
  EXPECT_EQ(spread_of({}).median, 0);
}

TEST(EffectCosts, ratios_compare_runs_of_the_same_round) {
  // The machine is ten times slower in the second round; the effect costs half as much again in both.
  const EffectCost none = cost_of("none", {1, 10}, 100), wetting = cost_of("wetting", {1.5, 15}, 120);
  const Spread ratio = wetting.ratio(&RunCost::wall_seconds, none);
  EXPECT_DOUBLE_EQ(ratio.min, 1.5);
  EXPECT_DOUBLE_EQ(ratio.max, 1.5);
  EXPECT_DOUBLE_EQ(wetting.ratio(&RunCost::peak_memory, none).median, 1.2);
  EXPECT_DOUBLE_EQ(wetting.seconds_per_simulated_second(), 8.25 / 0.5);
  EXPECT_DOUBLE_EQ(wetting.bytes_per_particle(), 1.2);
  EXPECT_DOUBLE_EQ(wetting.added_bytes_per_particle(none), 0.2);
}

TEST(EffectCosts, heights_of_bars_are_in_the_ratio_of_the_values) {
  const std::vector<EffectCost> costs = {cost_of("none", {2}, 1e8), cost_of("wetting", {3}, 2e8)};
  const std::string svg = effects_svg({"jet", "", {}}, costs);
  const std::vector<double> rest = heights(svg, "#7fa8c9"), part = heights(svg, "#b3541e");
  // Of each: time without the part, memory, legend.
  ASSERT_EQ(rest.size(), 5U) << svg;
  ASSERT_EQ(part.size(), 3U) << svg;
  EXPECT_NEAR((rest[1] + part[1]) / (rest[0] + part[0]), 1.5, 2e-3);
  EXPECT_NEAR(part[0] / (rest[0] + part[0]), 0.25, 2e-3);
  EXPECT_NEAR(rest[3] / rest[2], 2, 5e-3);
}

TEST(EffectCosts, no_time_and_no_particles_divide_by_nothing) {
  std::vector<EffectCost> costs = {cost_of("none", {0}, 0), cost_of("all", {0}, 0)};
  for (EffectCost& cost : costs) cost.runs[0].particles = 0;
  for (const std::string& text : {effects_csv(costs), effects_markdown({"a<b & c", "", {}}, costs),
                                  effects_svg({"a<b & c", "", {}}, costs)}) {
    EXPECT_EQ(text.find("nan"), std::string::npos) << text;
    EXPECT_EQ(text.find("inf"), std::string::npos) << text;
  }
  EXPECT_NE(effects_svg({"a<b & c", "", {}}, costs).find("a&lt;b &amp; c"), std::string::npos);
}

}  // namespace
}  // namespace oilskin::demo
