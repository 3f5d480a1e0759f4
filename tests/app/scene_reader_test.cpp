// Scene files: what is read is what is written, every key is documented, --set reaches every place.
#include "scene/scene_reader.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include "app/refused_scene.h"
#include "checks/acceptance.h"
#include "checks/check_table.h"
#include "oilskin/presets.h"
#include "scene/initial_fields.h"
#include "scene/tank.h"

namespace oilskin::demo {
namespace {

using test::message_of;

FilledBox box_of_every_field() {
  FilledBox box;
  box.box = {Vec3::Zero(), Vec3::Ones()};
  for (const FieldKind kind :
       {FieldKind::linear, FieldKind::rotation, FieldKind::taylor_green, FieldKind::standing_wave})
    box.initial.flow.emplace_back().kind = kind;
  box.initial.flow[0].gradient = {Vec3(0, 1, 2), Vec3(3, 4, 5), Vec3(6, 7, 8)};
  box.initial.displacement = {box.initial.flow.back()};
  box.initial.shake = 0.1;
  return box;
}

/// A scene that uses every shape and every optional part, so that writing it names every key.
Scene everything() {
  Scene scene;
  scene.name = "everything";
  scene.effects.viscosity.emplace();
  scene.effects.wetting.emplace();
  DiscEmitter disc;
  disc.stop = 1;
  RainEmitter rain;
  rain.stop = 2;
  PlacedMeshEmitter mesh_emitter;
  mesh_emitter.mesh.file = "vee.obj";
  scene.emitters = {disc, box_of_every_field(), mesh_emitter, rain};
  scene.emitters[0].motion.stop = 4;
  scene.emitters[0].max_age = 5;
  Cloth grid, mesh;
  PinBox pin;
  pin.within = {Vec3::Constant(-1), Vec3::Constant(1)};
  pin.hold = 0.5;
  pin.release = 1;
  pin.motion.start = 0.5;
  pin.motion.stop = 2;
  grid.pins.kind = PinKind::boxes;
  grid.fabric.emplace();
  grid.pins.boxes = {pin};
  grid.surface.slip_back.emplace().model = SlipModel::viscous_wall;
  mesh.mesh.emplace();
  mesh.mesh->file = "vee.obj";
  mesh.pins.kind = PinKind::nodes;
  mesh.pins.nodes = {0, 1};
  scene.cloth = {grid, mesh};
  Body box, sphere, plane, body, tank;
  tank.shape = TankShape{{Vec3::Zero(), Vec3::Ones()}, Vec3(0, 1, 0), {0, 0, 0, 1}};
  sphere.shape = SphereShape();
  plane.shape = PlaneShape();
  body.shape = *mesh.mesh;
  box.motion.stop = 3;
  body.surface.solid = true;
  Body raft;
  raft.shape = CompoundShape{{BoxShape(), BoxShape()}};
  raft.density = 300;
  Body floating;
  floating.mass = 2;
  scene.bodies = {box, sphere, plane, body, tank, raft, floating};
  grid.anchors.push_back({5, pin.within});
  grid.wind = Vec3(3, 0, 0);
  scene.cloth = {grid, mesh};
  Region both = ball_region(Vec3(1, 2, 3), 0.5);
  both.box = pin.within;
  scene.sinks = {both, box_region(pin.within)};
  scene.max_age = 3;
  WindForce wind;
  wind.region = both;
  scene.effects.forces = {UniformForce(), VortexForce(), wind};
  scene.effects.surface_tension.emplace().contact_angle = 40;
  scene.acceptance = Json::parse(R"({
    "min_emitted": 1, "min_over_rim": 1, "vertical_momentum": 0.03, "sag_below_dry": 0.02, "max_stretch": 2,
    "slip_ratio": {}, "pin_reaction": {}, "dry_shadow": {}, "pool_level": {}, "pool_calm": {},
    "at_rest": [{"within": {"min": [0, 0, 0], "max": [1, 1, 1]}, "from": 0.5, "to": 1, "speed": 0.02}],
    "dam_break": {"height": 0.05}, "inside_constant": {}, "enclosed_volume": {"at_most": 2},
    "energy_decay": {}, "close_layers": {}, "memory_growth": 0.05, "wetting": {}, "drained": {},
    "floats": [{"body": 6, "tank": 4, "travel": 0.1}, {"body": 5}]})");
  scene.pictures.views.emplace_back();
  scene.pictures.views.back().slice.emplace();
  scene.pictures.views.back().colour = WaterColour::density;
  scene.pictures.views.back().orthographic = 0.3;
  return scene;
}

/// The scene with every value as resolved.
Json resolved(const Scene& scene) {
  return resolved_scene(scene, Acceptance(scene));
}

void collect_keys(const Json& json, std::set<std::string>& keys) {
  for (const auto& item : json.items()) {
    if (json.is_object()) keys.insert(item.key());
    if (item.value().is_structured()) collect_keys(item.value(), keys);
  }
}

TEST(SceneReader, what_is_written_is_read_back) {
  const Json written = resolved(everything());
  const Scene again = read_scene(written, OILSKIN_SCENES);
  EXPECT_EQ(resolved(again), written);
  EXPECT_EQ(resolved(again).dump(), written.dump()) << "the same order";
}

TEST(SceneReader, defaults_survive_an_empty_file) {
  const Scene scene = read_scene(Json::object(), ".");
  EXPECT_EQ(write_scene(scene), write_scene(Scene()));
  EXPECT_EQ(scene.fluid.spacing, FluidSettings().spacing);
}

TEST(SceneReader, where_cloth_is_wetted_the_water_mesh_meets_it_unless_the_scene_asks_for_another_mode) {
  const auto mode = [](const char* text) { return read_scene(Json::parse(text), ".").water_mesh->mode; };
  EXPECT_EQ(mode(R"({"surface": {}})"), ObstacleMode::gap);
  EXPECT_EQ(mode(R"({"surface": {}, "effects": {"wetting": {}}})"), ObstacleMode::wet);
  EXPECT_EQ(mode(R"({"surface": {"mode": "touch"}, "effects": {"wetting": {}}})"), ObstacleMode::touch);
  EXPECT_EQ(mode(R"({"surface": {"mode": "wet"}})"), ObstacleMode::wet);
}

TEST(SceneReader, formats_and_channels_of_the_water_mesh_are_known_words_each_once) {
  const auto surface = [](const char* text) { return *read_scene(Json::parse(text), ".").water_mesh; };
  EXPECT_EQ(surface(R"({"surface": {}})").formats, std::vector<std::string>{"ply"});
  EXPECT_EQ(surface(R"({"surface": {}})").channels, std::vector<std::string>{"velocity"});
  const WaterMeshSettings both = surface(R"({"surface": {"formats": ["vdb", "ply"], "channels": []}})");
  EXPECT_EQ(both.formats, (std::vector<std::string>{"ply", "vdb"}));
  EXPECT_TRUE(both.channels.empty());
  const auto refuses = [](const char* text, const char* why) {
    try {
      read_scene(Json::parse(text), ".");
      ADD_FAILURE() << text;
    } catch (const SceneError& e) {
      EXPECT_NE(std::string(e.what()).find(why), std::string::npos) << e.what();
    }
  };
  refuses(R"({"surface": {"formats": []}})", "surface.formats: is empty");
  refuses(R"({"surface": {"formats": "ply"}})", "surface.formats: is \"ply\", must be a list of words");
  refuses(R"({"surface": {"formats": ["ply", "obj"]}})", "has \"obj\", must be a list of words from ply");
  refuses(R"({"surface": {"channels": ["id", 3]}})", "surface.channels: has 3");
  refuses(R"({"surface": {"channels": ["id", "id"]}})", "has \"id\" twice");
}

TEST(SceneReader, every_shipped_scene_reads) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(OILSKIN_SCENES)) {
    if (entry.path().extension() != ".json") continue;
    const Scene scene = read_scene(read_json_file(entry.path().string()), OILSKIN_SCENES);
    EXPECT_EQ(scene.name, entry.path().stem().string());
    EXPECT_FALSE(scene.description.empty()) << scene.name;
    EXPECT_NO_THROW(Acceptance{scene}) << scene.name;
    EXPECT_TRUE(scene.contact.verify) << scene.name << ": shipped scenes verify";
    ++count;
  }
  EXPECT_GE(count, 11);
}

TEST(SceneReader, the_tests_scene_asks_for_every_check) {
  const Json asked = resolved(everything())["acceptance"];
  for (const CheckEntry& entry : check_table())
    EXPECT_TRUE(entry.key == nullptr || asked.contains(entry.key)) << (entry.key ? entry.key : "");
}

TEST(SceneReader, every_key_is_documented) {
  std::ifstream in(OILSKIN_SCENE_DOC);
  std::stringstream text;
  text << in.rdbuf();
  std::set<std::string> keys;
  collect_keys(resolved(everything()), keys);
  EXPECT_GT(keys.size(), 80u);
  for (const std::string& key : keys)
    EXPECT_NE(text.str().find("`" + key + "`"), std::string::npos)
        << key << " is not in docs/manual/scene_file.md";
}

TEST(SceneReader, messages_name_the_path) {
  EXPECT_EQ(message_of(R"({"cloth": [{}, {"slip": {"modle": "free"}}]})"),
            "cloth.1.slip.modle: this key is not known; the nearest is \"model\"");
  EXPECT_EQ(message_of(R"({"cloth": [{"slip": {"friction": 0.9}}]})"),
            "cloth.0.slip.friction: has no effect without \"model\", which is \"free\"");
  EXPECT_EQ(message_of(R"({"fluid": {"spacing": -1}})"), "fluid.spacing: is -1, must be > 0");
  EXPECT_NE(message_of(R"({"cloth": [{"normal": [1, 0, 0], "u_axis": [1, 0, 0]}]})").find("parallel"),
            std::string::npos);
}

TEST(SceneReader, pins_move_after_they_are_held_and_are_let_go_after_that) {
  const auto pins = [](const std::string& more) {
    return R"({"cloth": [{"pins": [{"within": {"min": [-1, -1, -1], "max": [1, 1, 1]}, )" + more + "}]}]}";
  };
  EXPECT_EQ(message_of(pins(R"("hold": 0.5, "motion": {"spin_rate": 1})")),
            "cloth.0.pins.0.motion.start: is before \"hold\": nodes that are not held yet cannot be moved");
  EXPECT_EQ(message_of(pins(R"("hold": 0.5, "release": 0.5)")),
            "cloth.0.pins.0.release: must be after \"hold\"");
}

TEST(SceneReader, keys_of_checks_are_checked) {
  EXPECT_EQ(message_of(R"({"acceptance": 3})"), "acceptance: is 3, must be an object");
  EXPECT_EQ(message_of(R"({"acceptance": {"dam_brake": {}}})"),
            "acceptance.dam_brake: this key is not known; the nearest is \"dam_break\"");
  EXPECT_EQ(message_of(R"({"acceptance": {"min_emitted": 1.5}})"),
            "acceptance.min_emitted: is 1.5, must be a whole number, from 0 to 2e+09");
  EXPECT_EQ(message_of(R"({"acceptance": {"dry_shadow": {"margine": 1}}})"),
            "acceptance.dry_shadow.margine: this key is not known; the nearest is \"margin\"");
}

TEST(SceneReader, checks_that_could_never_be_looked_at_are_refused) {
  EXPECT_EQ(message_of(R"({"acceptance": {"at_rest": [{}]}})"),
            "acceptance.at_rest.0.within: is missing: the box whose water is to be at rest");
  EXPECT_EQ(message_of(R"({"acceptance": {"at_rest": [{"within": {"min": [0, 0, 0], "max": [1, 1, 1]},
                                                       "from": 1, "to": 0.5}]}})"),
            "acceptance.at_rest.0.to: must be later than \"from\"");
  EXPECT_EQ(message_of(R"({"acceptance": {"pool_level": {"cloth": 0}}})"),
            "acceptance.pool_level.cloth: is 0, must be the index of a cloth, the scene has 0");
  EXPECT_EQ(message_of(R"({"cloth": [{}], "acceptance": {"pool_calm": {"cloth": 1}}})"),
            "acceptance.pool_calm.cloth: is 1, must be the index of a cloth, the scene has 1");
  EXPECT_EQ(message_of(R"({"gravity": [0, 0, 0], "acceptance": {"dam_break": {}}})"),
            "gravity: is zero; a pool or a dam break needs a weight");
  EXPECT_EQ(message_of(R"({"acceptance": {"dam_break": {"along": [1, 1, 0]}}})"),
            "acceptance.dam_break.along: must be square to gravity");
}

std::string message_of_box(const std::string& keys) {
  return message_of(R"({"emitters": [{"shape": "box", "min": [0, 0, 0], "max": [1, 1, 1], )" + keys + "}]}");
}

TEST(SceneReader, fields_are_checked) {
  EXPECT_EQ(message_of_box(R"("flow": [{"field": "rotation", "rate": 3}], "shake": 0.25)"), "");
  EXPECT_EQ(message_of_box(R"("flow": [{}])"),
            "emitters.0.flow.0.field: is missing: linear, rotation, taylor_green or standing_wave");
  EXPECT_EQ(message_of_box(R"("flow": [{"field": "linear", "gradient": [[1, 2, 3], [1, 2, 3]]}])"),
            "emitters.0.flow.0.gradient: must be a list of three rows of three numbers");
  EXPECT_EQ(message_of_box(R"("flow": [{"field": "linear", "gradient": [[1, 2, 3], [1, 2], [0, 0, 0]]}])"),
            "emitters.0.flow.0.gradient.1: is [1,2], must be a list of 3 numbers");
  EXPECT_EQ(
      message_of_box(R"("flow": [{"field": "linear", "rate": 1, "gradient": [[1,2,3],[1,2,3],[1,2,3]]}])"),
      "emitters.0.flow.0.rate: this key is not known; known are field, origin, gradient");
  EXPECT_EQ(message_of_box(R"("displacement": [{"field": "standing_wave", "up": [1, 1, 0]}])"),
            "emitters.0.displacement.0.up: must be across \"along\"");
  EXPECT_EQ(message_of_box(R"("flow": [{"field": "taylor_green", "edge_v": [1, 1, 0]}])"),
            "emitters.0.flow.0.edge_v: must be across edge_u");
  EXPECT_EQ(message_of_box(R"("shake": 0.3)"), "emitters.0.shake: is 0.3, must be from 0 to 0.25");
}

TEST(SceneReader, fields_give_places_and_velocities) {
  InitialFields fields = box_of_every_field().initial;
  fields.flow.resize(2);
  fields.flow[1].rate = 2;
  fields.flow[1].origin = Vec3(0, 5, 1);
  const InitialState state = initial_state(fields, 7);
  const Vec3 x(1, 2, 3);
  EXPECT_EQ(state.velocity(x), Vec3(8, 26, 44) + 2 * Vec3(0, 1, 0).cross(Vec3(1, -3, 2)));
  EXPECT_EQ(state.displacement(x), Vec3::Zero()) << "no amplitude";
  EXPECT_EQ(state.seed, 7u);
  EXPECT_FALSE(initial_state(InitialFields{}, 1).velocity) << "no field: all particles have one velocity";
}

TEST(SceneReader, a_tank_is_one_sheet_that_faces_inwards) {
  EXPECT_EQ(message_of(R"({"bodies": [{"shape": "tank", "min": [0, 0, 0], "max": [1, 0, 1]}]})"),
            "bodies.0.max: must exceed min in every coordinate");
  EXPECT_EQ(
      message_of(R"({"bodies": [{"shape": "tank", "min": [0, 0, 0], "max": [1, 2, 1], "open": [0, 1, 1]}]})"),
      "bodies.0.open: must be along x, y or z, or [0, 0, 0] for a closed box");
  for (const Vec3& open : {Vec3(0, 0, 0), Vec3(0, 3, 0), Vec3(-1, 0, 0), Vec3(0, 0, 0.1)}) {
    TankShape tank{{Vec3(-1, 2, 3), Vec3(3, 5, 4)}, open, {0, 0, 0, 1}};
    const Mesh mesh = tank_mesh(tank);
    EXPECT_EQ(mesh.triangles.size(), open.isZero() ? 12u : 10u);
    const Vec3 middle(1, 3.5, 3.5);
    double area = 0, volume = 0;  // of the pyramids from the middle to the faces
    for (const Triangle& t : mesh.triangles) {
      const Vec3 a = mesh.vertices[t[0]], b = mesh.vertices[t[1]], c = mesh.vertices[t[2]];
      const Vec3 normal = (b - a).cross(c - a);
      EXPECT_GT(normal.dot(middle - a), 0);
      EXPECT_GT(normal.normalized().dot(open), -0.05) << "no face on the open side";
      area += 0.5 * normal.norm();
      volume += normal.dot(middle - a) / 6;
    }
    const Vec3 size = tank.inside.max - tank.inside.min;
    const double open_share = open.isZero() ? 0 : 1.0 / 6;
    EXPECT_NEAR(volume, size.prod() * (1 - open_share), 1e-12);
    const double lid = open.y() != 0 ? 4 * 1 : open.x() != 0 ? 3 * 1 : open.z() != 0 ? 4 * 3 : 0;
    EXPECT_NEAR(area, 2 * (4 * 3 + 3 * 1 + 4 * 1) - lid, 1e-12);
  }
}

TEST(SceneReader, walls_of_a_tank_lie_outside_its_faces) {
  const double half_turn = std::sqrt(0.5);
  for (const Vec3& open : {Vec3(0, 0, 0), Vec3(0, 3, 0), Vec3(-1, 0, 0)}) {
    const TankShape tank{{Vec3(-1, 2, 3), Vec3(3, 5, 4)}, open, {0, 0, half_turn, half_turn}};
    const std::vector<BoxShape> walls = tank_walls(tank, 0.25);
    ASSERT_EQ(walls.size(), open.isZero() ? 6u : 5u);
    const Mesh faces = tank_mesh(tank);
    for (std::size_t w = 0; w < walls.size(); ++w) {
      const auto& q = walls[w].rotate;
      const Eigen::Quaterniond turn(q[3], q[0], q[1], q[2]);
      const auto outside = [&](const Vec3& p) {  // by which a point lies outside the wall; negative: inside
        return ((turn.conjugate() * (p - walls[w].center)).cwiseAbs() - walls[w].half_extents).maxCoeff();
      };
      EXPECT_NEAR(walls[w].half_extents.minCoeff(), 0.125, 1e-12);
      EXPECT_GT(outside(Vec3(1, 3.5, 3.5)), 0.49) << "the inside is free";
      for (const Triangle& t : {faces.triangles[2 * w], faces.triangles[2 * w + 1]})
        for (const std::uint32_t k : t) EXPECT_NEAR(outside(faces.vertices[k]), 0, 1e-12) << "wall " << w;
    }
  }
}

TEST(SceneReader, a_cut_needs_a_slab_and_a_known_colour) {
  EXPECT_NE(message_of(R"({"pictures": {"views": [{"slice": {"thickness": 0}}]}})").find("must be > 0"),
            std::string::npos);
  EXPECT_NE(message_of(R"({"pictures": {"views": [{"slice": {"normal": [0, 0, 0]}}]}})").find("normal"),
            std::string::npos);
  EXPECT_NE(message_of(R"({"pictures": {"views": [{"colour": "presure"}]}})").find("pressure"),
            std::string::npos);
}

TEST(SceneReader, what_is_suggested_is_near_by_edit_distance) {
  EXPECT_EQ(suggestion("thicknes", {"spacing", "thickness", "substeps"}), "; the nearest is \"thickness\"");
  EXPECT_EQ(suggestion("strong", {"none", "position", "force"}), "");
  EXPECT_EQ(suggestion("x", {}), "");
}

TEST(Override, reaches_keys_lists_and_new_places) {
  Json scene = Json::parse(R"({"cloth": [{"grid": [5, 5]}]})");
  apply_override(scene, "cloth.0.thickness=0.0005");
  apply_override(scene, "cloth.0.grid.1=7");
  apply_override(scene, "cloth.1.pins=corners");
  apply_override(scene, "contact.ccd=false");
  apply_override(scene, "emitters=[]");
  EXPECT_EQ(scene, Json::parse(R"({"cloth": [{"grid": [5, 7], "thickness": 0.0005}, {"pins": "corners"}],
                                   "contact": {"ccd": false}, "emitters": []})"));
}

TEST(Override, refuses_paths_that_do_not_exist) {
  Json scene = Json::parse(R"({"cloth": [{"grid": [5, 5]}], "dt": 1})");
  for (const char* wrong : {"cloth.3.thickness=1", "cloth.x=1", "dt.a=1", "=1", "dt", "cloth..a=1"})
    EXPECT_THROW(apply_override(scene, wrong), SceneError) << wrong;
}

TEST(SceneReader, a_preset_is_what_the_other_keys_change) {
  const auto read = [](const char* text) { return read_scene(parse_json(text, "test"), "."); };
  const Scene game = read(R"({"preset": "game", "fluid": {"spacing": 0.01, "cfl": 0.7}})");
  EXPECT_DOUBLE_EQ(game.dt, 1.0 / 120);
  EXPECT_EQ(game.fluid.tolerance, 0.005);
  EXPECT_EQ(game.fluid.cfl, 0.7);
  EXPECT_TRUE(read(R"({"preset": "measurement", "dt": 0.002})").contact.verify);
  EXPECT_EQ(read(R"({"preset": "measurement", "dt": 0.002})").dt, 0.002);
  EXPECT_LT(read(R"({"preset": "measurement", "fluid": {"spacing": 0.01}})").dt,
            read(R"({"preset": "measurement", "fluid": {"spacing": 0.02}})").dt);
  EXPECT_NE(message_of(R"({"preset": "games"})"), "");
  EXPECT_NE(message_of(R"({"preset": "film", "fluid": {"spacing": "a"}})"), "");
}

TEST(Presets, are_valid_and_ordered_by_accuracy) {
  for (const double spacing : {0.0005, 0.005, 0.02, 0.5}) {
    const Preset game = game_preset(spacing), film = film_preset(spacing),
                 exact = measurement_preset(spacing);
    for (const Preset& preset : {game, film, exact, game_preset(spacing, 1), game_preset(spacing, 16)}) {
      EXPECT_TRUE(preset.fluid.validate().ok()) << preset.fluid.validate().message;
      EXPECT_TRUE(preset.contact.validate().ok());
      EXPECT_GT(preset.dt, 0);
      EXPECT_EQ(preset.fluid.spacing, spacing);
    }
    EXPECT_GT(game.fluid.tolerance, film.fluid.tolerance);
    EXPECT_GT(film.fluid.tolerance, exact.fluid.tolerance);
    EXPECT_GT(game.fluid.cfl, film.fluid.cfl);
    EXPECT_GT(film.fluid.cfl, exact.fluid.cfl);
  }
}

}  // namespace
}  // namespace oilskin::demo
