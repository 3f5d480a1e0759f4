#include "scene/scene_format.h"

#include <algorithm>

#include "oilskin/presets.h"
#include "scene/body_format.h"
#include "scene/effects_format.h"
#include "scene/emitter_format.h"
#include "scene/mesh_options.h"
#include "scene/region_format.h"
#include "scene/surface_format.h"

namespace oilskin::demo {
namespace {

void describe(Fields& f, FluidSettings& s) {
  f.number("spacing", s.spacing, positive());
  f.number("rest_density", s.rest_density, positive());
  f.number("support_ratio", s.support_ratio, between(1.5, 4));
  f.choice("solver", s.solver,
           {{"pcisph", PressureSolver::pcisph},
            {"dfsph", PressureSolver::dfsph},
            {"mcg03", PressureSolver::mcg03}});
  f.number("tolerance", s.tolerance, not_negative());
  f.number("divergence_tolerance", s.divergence_tolerance, not_negative());
  f.integer("min_iterations", s.min_iterations, between(1, 100000));
  f.integer("max_iterations", s.max_iterations, between(1, 100000));
  f.number("gradient_correction", s.gradient_correction, between(0, 1));
  f.number("stiffness", s.stiffness, positive());
  f.number("viscosity", s.viscosity, not_negative());
  f.optional_number("xsph_rate", s.xsph_rate, not_negative());
  f.optional_number("xsph_strain", s.xsph_strain, not_negative());
  f.boolean("contact_aware", s.contact_aware);
  f.boolean("occlusion", s.occlusion);
  // The state equation has no boundary terms.
  if (f.reading() && s.solver == PressureSolver::mcg03) s.boundary = BoundaryModel::contact_only;
  f.choice("boundary", s.boundary,
           {{"contact_only", BoundaryModel::contact_only}, {"mirrored", BoundaryModel::mirrored}});
  f.number("cfl", s.cfl, positive());
  f.integer("max_substeps", s.max_substeps, between(1, 1000));
}

void describe(Fields& f, PinBox& p) {
  f.box("within", p.within);
  if (f.reading() && !f.has("within")) f.fail("within", "is missing: the box whose nodes are pinned");
  f.number("hold", p.hold, not_negative());
  f.number("release", p.release, not_negative());
  if (f.reading() && p.release <= p.hold && p.hold > 0) f.fail("release", "must be after \"hold\"");
  f.object("motion", [&](Fields& g) {
    describe(g, p.motion);
    if (g.reading() && p.motion.moves() && p.motion.start < p.hold)
      g.fail("start", "is before \"hold\": nodes that are not held yet cannot be moved");
  });
}

void describe(Fields& f, Anchor& a) {
  f.integer("body", a.body, between(0, 1e6));
  f.box("within", a.within);
  if (f.reading() && !f.has("within")) f.fail("within", "is missing: the box whose nodes are anchored");
}

void write_pins(Fields& f, Pins& pins) {
  Json& out = (*f.out())["pins"];
  switch (pins.kind) {
    case PinKind::none:
      out = "none";
      break;
    case PinKind::corners:
      out = "corners";
      break;
    case PinKind::border:
      out = "border";
      break;
    case PinKind::nodes:
      out = pins.nodes;
      break;
    case PinKind::boxes:
      f.list("pins", pins.boxes, [](Fields& g, PinBox& p) { describe(g, p); });
      break;
  }
}

/// "none", "corners", "border", a list of node indices, or a list of boxes.
void describe_pins(Fields& f, Pins& pins) {
  if (!f.reading()) return write_pins(f, pins);
  const Json* found = f.raw("pins");
  if (found == nullptr) return;
  if (found->is_string())
    return f.choice("pins", pins.kind,
                    {{"none", PinKind::none}, {"corners", PinKind::corners}, {"border", PinKind::border}});
  if (!found->is_array())
    f.fail("pins", "must be none, corners, border, a list of node indices or a list of boxes");
  if (found->empty() || found->front().is_object()) {
    pins.kind = PinKind::boxes;
    return f.list("pins", pins.boxes, [](Fields& g, PinBox& p) { describe(g, p); });
  }
  pins.kind = PinKind::nodes;
  for (std::size_t i = 0; i < found->size(); ++i) {
    const Json& node = (*found)[i];
    if (!node.is_number_integer() || node.get<std::int64_t>() < 0 || node.get<std::int64_t>() > 2147483647)
      f.fail("pins." + std::to_string(i),
             "is " + node.dump() + ", must be the index of a node, a whole number >= 0");
    pins.nodes.push_back(node.get<int>());
  }
}

void describe_grid(Fields& f, Cloth& c) {
  f.pair("grid", c.grid, between(2, 2000));
  f.pair("size", c.size, positive());
  f.vec3("center", c.center);
  f.direction("normal", c.normal);
  f.direction("u_axis", c.u_axis);
  f.number("bowl_depth", c.bowl_depth, any_number());
  if (f.reading() && c.normal.normalized().cross(c.u_axis.normalized()).norm() < 1e-3)
    f.fail("u_axis", "is parallel to the normal, must lie across it");
}

void describe(Fields& f, Cloth& c) {
  if (f.has("mesh")) c.mesh.emplace();
  if (c.mesh) {
    describe(f, *c.mesh);
  } else {
    describe_grid(f, c);
  }
  f.number("areal_density", c.areal_density, {1e-6, 1e6});
  describe_pins(f, c.pins);
  f.integer("substeps", c.substeps, between(1, 10000));
  f.integer("iterations", c.iterations, between(1, 10000));
  f.boolean("bend_links", c.bend_links);
  f.boolean("waterproof", c.waterproof);
  f.optional_object("fabric", c.fabric, [](Fields& g, Fabric& fabric) { describe(g, fabric); });
  f.vec3("wind", c.wind);
  f.list("anchors", c.anchors, [](Fields& g, Anchor& a) { describe(g, a); });
  describe(f, c.surface);
}

void describe(Fields& f, ContactSettings& s) {
  f.choice("repulsion", s.repulsion,
           {{"split", Repulsion::split}, {"bridson", Repulsion::bridson}, {"none", Repulsion::none}});
  f.number("stiffness", s.stiffness, not_negative());
  f.boolean("ccd", s.ccd);
  f.boolean("zones", s.zones);
  f.integer("sweeps", s.solver_iterations, between(1, 1000));
  f.integer("rounds", s.ccd_iterations, between(0, 100));
  f.choice("infeasible", s.infeasible,
           {{"stall", Infeasible::stall}, {"remove", Infeasible::remove}, {"allow", Infeasible::allow}});
  f.boolean("verify", s.verify);
  f.choice("hierarchy", s.hierarchy, {{"flat", Hierarchy::flat}, {"fcl", Hierarchy::fcl}});
}

void describe(Fields& f, Slice& s) {
  f.vec3("point", s.point);
  f.direction("normal", s.normal);
  f.number("thickness", s.thickness, positive());
}

void describe(Fields& f, View& v) {
  f.vec3("eye", v.eye);
  f.vec3("target", v.target);
  f.direction("up", v.up);
  f.number("angle", v.angle, between(1, 150));
  f.number("orthographic", v.orthographic, not_negative());
  f.optional_object("slice", v.slice, [](Fields& g, Slice& s) { describe(g, s); });
  f.choice("water", v.water,
           {{"auto", WaterLook::automatic},
            {"balls", WaterLook::balls},
            {"surface", WaterLook::surface},
            {"clear", WaterLook::clear}});
  f.choice("colour", v.colour,
           {{"speed", WaterColour::speed},
            {"pressure", WaterColour::pressure},
            {"density", WaterColour::density}});
  f.text("title", v.title);
  if (f.reading() && (v.target - v.eye).cross(v.up).norm() < 1e-9)
    f.fail("eye", "the line of sight is parallel to \"up\" or has no length");
}

void describe(Fields& f, Pictures& p) {
  f.number("frames_per_second", p.frames_per_second, between(0, 1e6));
  f.number("max_speed", p.max_speed, not_negative());
  f.number("max_pressure", p.max_pressure, positive());
  f.list("views", p.views, [](Fields& g, View& v) { describe(g, v); });
}

}  // namespace

void describe(Fields& f, WaterMeshSettings& s) {
  f.number("cell", s.cell, not_negative());
  f.number("gap", s.gap, not_negative());
  f.choice("mode", s.mode,
           {{"none", ObstacleMode::none},
            {"reset", ObstacleMode::reset},
            {"gap", ObstacleMode::gap},
            {"touch", ObstacleMode::touch},
            {"overlap", ObstacleMode::overlap},
            {"wet", ObstacleMode::wet}});
  f.choice("field", s.field,
           {{"density_decay", ReconstructionField::density_decay},
            {"eigenvalue_decay", ReconstructionField::eigenvalue_decay},
            {"zhu_bridson", ReconstructionField::zhu_bridson},
            {"density", ReconstructionField::density}});
  f.number("touch_range", s.touch_range, between(0, 1.5));
  f.number("wet_saturation", s.wet_saturation, between(0, 1));
  f.number("wet_blend", s.wet_blend, between(0, 1));
  f.number("overlap_depth", s.overlap_depth, not_negative());
  f.integer("smoothing", s.smoothing, between(0, 1000));
  f.boolean("keep_volume", s.keep_volume);
  f.number("min_blob", s.min_blob, not_negative());
  f.names("formats", s.formats, known_formats());
  f.names("channels", s.channels, known_channels());
  if (f.reading() && s.formats.empty()) f.fail("formats", "is empty, must name one or more");
}

double spacing_of(Fields& f) {
  const Json* fluid = f.raw("fluid");
  const bool has_spacing =
      fluid != nullptr && fluid->is_object() && fluid->contains("spacing") && (*fluid)["spacing"].is_number();
  return has_spacing ? (*fluid)["spacing"].get<double>() : FluidSettings().spacing;
}

/// What the other keys of a scene change.
void apply_preset(Fields& f, Scene& s) {
  f.choice("preset", s.preset,
           {{"none", PresetKind::none},
            {"game", PresetKind::game},
            {"film", PresetKind::film},
            {"measurement", PresetKind::measurement}});
  if (!f.reading() || s.preset == PresetKind::none) return;
  const double spacing = spacing_of(f);
  if (!(spacing > 0)) return;  // refused where it is read
  const Preset preset = s.preset == PresetKind::game   ? game_preset(spacing)
                        : s.preset == PresetKind::film ? film_preset(spacing)
                                                       : measurement_preset(spacing);
  s.dt = preset.dt;
  s.fluid = preset.fluid;
  s.contact = preset.contact;
}

/// Empty: that of the file is used.
bool is_folder_name(const std::string& name) {
  const auto is_fit = [](unsigned char c) { return c >= ' ' && c != '/' && c != '\\' && c != 127; };
  return name != "." && name != ".." && std::all_of(name.begin(), name.end(), is_fit);
}

/// The report names the thickness of each surface.
void set_thicknesses(Scene& s) {
  const double thickness = default_thickness(s.fluid.spacing);
  for (Cloth& c : s.cloth)
    if (!c.surface.thickness) c.surface.thickness = thickness;
  for (Body& b : s.bodies)
    if (!b.surface.thickness) b.surface.thickness = thickness;
}

void describe(Fields& f, Scene& s) {
  f.text("name", s.name);
  if (f.reading() && !is_folder_name(s.name))
    f.fail("name", "is " + Json(s.name).dump() + ", must be the name of a folder, not a path");
  f.text("description", s.description);
  f.choice("host", s.host,
           {{"bullet", HostKind::bullet}, {"bullet64", HostKind::bullet64}, {"mock", HostKind::mock}});
  apply_preset(f, s);
  f.number("dt", s.dt, {0, 1000, true});
  f.boolean("adaptive_dt", s.adaptive_dt);
  f.number("min_dt", s.min_dt, {0, 1000, true});
  f.number("duration", s.duration, between(0, 1e6));
  f.integer("series_every", s.series_every, between(0, 1e9));
  f.unsigned_integer("seed", s.seed);
  f.vec3("gravity", s.world.gravity);
  const auto set_smoothing = [&] { oilskin::set_smoothing(s.fluid, s.world.gravity.norm()); };
  if (!f.reading()) set_smoothing();  // the report names the values that the world uses
  f.object("fluid", [&](Fields& g) { describe(g, s.fluid); });
  if (f.reading()) set_smoothing();
  f.list("emitters", s.emitters, [](Fields& g, Emitter& e) { describe_emitter(g, e); });
  if (!f.reading()) set_thicknesses(s);
  f.list("cloth", s.cloth, [](Fields& g, Cloth& c) { describe(g, c); });
  f.list("bodies", s.bodies, [](Fields& g, Body& b) { describe(g, b); });
  f.list("sinks", s.sinks, [](Fields& g, Region& r) { describe_sink(g, r); });
  f.number("max_age", s.max_age, positive());
  if (f.reading()) set_thicknesses(s);
  f.object("contact", [&](Fields& g) { describe(g, s.contact); });
  f.box("kill_box", s.world.kill_box);
  f.unsigned_integer("max_particles", s.world.max_particles);
  f.number("step_budget", s.world.step_budget, not_negative());
  f.object("effects", [&](Fields& g) { describe(g, s.effects); });
  f.optional_object("surface", s.water_mesh, [&](Fields& g, WaterMeshSettings& w) {
    if (g.reading() && s.effects.wetting) w.mode = ObstacleMode::wet;
    describe(g, w);
  });
  if (f.reading() && s.water_mesh)
    if (const Status status = check_mesh_settings(*s.water_mesh, s.fluid.spacing); !status.ok())
      f.fail("surface", status.message);
  f.json_object("acceptance", s.acceptance);
  f.object("pictures", [&](Fields& g) { describe(g, s.pictures); });
}

}  // namespace oilskin::demo
