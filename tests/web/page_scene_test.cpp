// The functions that the web page calls, on this machine: the scene that they run is the program's.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>
#include <string>

#include "hosts/bullet_simulation.h"
#include "page_api.h"
#include "scene/scene_reader.h"

namespace {

using oilskin::demo::Json;

const std::string coarse = "fluid.spacing=0.01\ncloth.0.grid=[29,29]\n";
const std::string leaking = coarse + "contact.ccd=false\ncontact.zones=false\n";
/// From the nozzle to the cloth the jet takes about 70 steps.
constexpr int until_wet = 130;

std::string jet() {
  std::ifstream in(OILSKIN_SCENES "/jet.json");
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

Json report() {
  return Json::parse(page_report());
}

/// What the program `oilskin` runs.
std::string hash_of_program(int steps) {
  Json json = oilskin::demo::parse_json(jet(), "jet");
  oilskin::demo::apply_override(json, "fluid.spacing=0.01");
  oilskin::demo::apply_override(json, "cloth.0.grid=[29,29]");
  const oilskin::demo::Scene scene = oilskin::demo::read_scene(json, "");
  const auto simulation = oilskin::demo::make_simulation(scene, {});
  for (int i = 0; i < steps; ++i) simulation->step(scene.dt);
  std::ostringstream out;
  out << "0x" << std::hex;
  out.width(16);
  out.fill('0');
  out << simulation->world().state_hash();
  return out.str();
}

TEST(PageScene, is_the_scene_of_the_program_bit_for_bit) {
  ASSERT_EQ(page_open(jet().c_str(), coarse.c_str()), 1) << page_message();
  ASSERT_EQ(page_step(until_wet), 1) << page_message();
  EXPECT_GT(report()["contacts"], 0);
  EXPECT_EQ(page_steps(), until_wet);
  EXPECT_EQ(page_state_hash(), hash_of_program(until_wet));
}

TEST(PageScene, certifies_every_step_with_contact_and_leaks_without) {
  ASSERT_EQ(page_open(jet().c_str(), coarse.c_str()), 1);
  ASSERT_EQ(page_step(until_wet), 1);
  EXPECT_EQ(report()["crossings"], 0);
  EXPECT_EQ(report()["certified"], until_wet);
  EXPECT_GT(report()["verified_pairs"], 0);
  ASSERT_EQ(page_open(jet().c_str(), leaking.c_str()), 1);
  ASSERT_EQ(page_step(until_wet), 1);
  EXPECT_GT(report()["crossings"], 0);
  EXPECT_EQ(report()["certified"], 0);
}

TEST(PageScene, contact_can_be_switched_between_steps) {
  ASSERT_EQ(page_open(jet().c_str(), coarse.c_str()), 1);
  ASSERT_EQ(page_step(60), 1);
  ASSERT_EQ(page_set_contact(0), 1);
  ASSERT_EQ(page_step(until_wet - 60), 1);
  EXPECT_EQ(report()["certified"], 60);
  EXPECT_GT(report()["crossings"], 0);
  const std::string off = page_state_hash();
  ASSERT_EQ(page_open(jet().c_str(), leaking.c_str()), 1);
  ASSERT_EQ(page_step(until_wet), 1);
  EXPECT_EQ(page_state_hash(), off) << "contact has nothing to do before the water arrives";
}

TEST(PageScene, the_cloth_is_pulled_and_the_nozzle_turned_and_nothing_passes) {
  ASSERT_EQ(page_open(jet().c_str(), coarse.c_str()), 1);
  ASSERT_EQ(page_step(60), 1);
  std::uint32_t count = 0;
  const std::vector<float> place = [&] {
    const float* const x = page_nodes(&count) + 3 * (10 * 29 + 10);
    return std::vector<float>(x, x + 3);
  }();
  ASSERT_EQ(page_grab(place[0], place[1], place[2]), 1) << page_message();
  ASSERT_EQ(page_pull(place[0], place[1] + 0.1, place[2]), 1);
  ASSERT_EQ(page_aim(0.3, -1, 0), 1) << page_message();
  ASSERT_EQ(page_step(100), 1);
  EXPECT_NEAR(page_nodes(&count)[3 * (10 * 29 + 10) + 1], place[1] + 0.1, 0.02);
  EXPECT_EQ(report()["crossings"], 0);
  EXPECT_EQ(report()["certified"], 160);
  EXPECT_NEAR(report()["nozzle"]["direction"][0].get<double>(), 0.3 / std::hypot(0.3, 1), 1e-12);
  ASSERT_EQ(page_release(), 1);
  ASSERT_EQ(page_step(60), 1);
  EXPECT_LT(page_nodes(&count)[3 * (10 * 29 + 10) + 1], place[1] + 0.08) << "it falls";
  EXPECT_EQ(report()["crossings"], 0);
}

TEST(PageScene, gives_what_is_drawn) {
  ASSERT_EQ(page_open(jet().c_str(), coarse.c_str()), 1);
  ASSERT_EQ(page_step(40), 1);
  std::uint32_t particles = 0, nodes = 0, triangles = 0;
  const float* const x = page_particles(&particles);
  ASSERT_EQ(particles, report()["particles"]);
  ASSERT_GT(particles, 0u);
  for (std::uint32_t i = 0; i < particles; ++i) {
    EXPECT_LT(x[4 * i + 1], 0.151f);
    EXPECT_GT(x[4 * i + 3], 1.5f) << "of a jet of 2 m/s";
    EXPECT_LT(x[4 * i + 3], 3.0f);
  }
  ASSERT_NE(page_nodes(&nodes), nullptr);
  EXPECT_EQ(nodes, 29u * 29u);
  const std::uint32_t* const t = page_triangles(&triangles);
  ASSERT_EQ(triangles, 2 * 28u * 28u);
  for (std::uint32_t k = 0; k < 3 * triangles; ++k) EXPECT_LT(t[k], nodes);
  EXPECT_EQ(Json::parse(page_description())["name"], "jet");
}

TEST(PageScene, refuses_bad_input_in_words_and_keeps_the_scene) {
  ASSERT_EQ(page_open(jet().c_str(), coarse.c_str()), 1);
  ASSERT_EQ(page_step(20), 1);
  const std::string before = page_state_hash();
  EXPECT_EQ(page_open("{ \"cloth\": [", ""), 0);
  EXPECT_NE(std::string(page_message()).find("is not JSON"), std::string::npos) << page_message();
  EXPECT_EQ(page_open(jet().c_str(), "fluid.spacing=-1"), 0);
  EXPECT_NE(std::string(page_message()).find("fluid.spacing"), std::string::npos) << page_message();
  EXPECT_EQ(page_open(jet().c_str(), "fluid.spacing"), 0);
  EXPECT_NE(std::string(page_message()).find("KEY=VALUE"), std::string::npos) << page_message();
  EXPECT_EQ(page_open("{ \"dt\": 0.001 }", ""), 0);
  EXPECT_NE(std::string(page_message()).find("cloth"), std::string::npos) << page_message();
  EXPECT_EQ(page_grab(NAN, 0, 0), 0);
  EXPECT_EQ(page_pull(0, HUGE_VAL, 0), 0);
  EXPECT_EQ(page_aim(0, 0, 0), 0);
  EXPECT_EQ(page_aim(NAN, 0, 0), 0);
  EXPECT_EQ(page_state_hash(), before);
  EXPECT_EQ(page_step(1), 1);
  EXPECT_STREQ(page_message(), "");
}

}  // namespace
