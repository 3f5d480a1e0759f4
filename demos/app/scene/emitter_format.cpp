#include "scene/emitter_format.h"

#include <cmath>

#include "scene/surface_format.h"

namespace oilskin::demo {

void describe(Fields& f, PlacedMesh& m) {
  f.text("mesh", m.file);
  if (f.reading() && m.file.empty()) f.fail("mesh", "must name a mesh file (.obj)");
  f.vec3("translate", m.translate);
  f.quaternion("rotate", m.rotate);
  f.number("scale", m.scale, positive());
}

namespace {

void describe(Fields& f, DiscEmitter& e) {
  f.vec3("center", e.center);
  f.direction("direction", e.direction);
  f.number("radius", e.radius, positive());
  f.number("speed", e.speed, positive());
  describe_times(f, e);
  f.number("shake", e.shake, between(0, 0.25));
}

/// A list of three rows.
void describe_matrix(Fields& f, const char* key, std::vector<Vec3>& rows) {
  if (!f.reading()) {
    Json& out = (*f.out())[key] = Json::array();
    for (const Vec3& row : rows) out.push_back({row.x(), row.y(), row.z()});
    return;
  }
  const Json* found = f.raw(key);
  if (found == nullptr || !found->is_array() || found->size() != 3)
    f.fail(key, "must be a list of three rows of three numbers");
  const Json row_keys = {{"0", (*found)[0]}, {"1", (*found)[1]}, {"2", (*found)[2]}};
  Fields all = Fields::reader(row_keys, f.path_of(key));
  for (const char* row : {"0", "1", "2"}) all.vec3(row, rows.emplace_back(Vec3::Zero()));
}

void describe_wave(Fields& f, StandingWave& w) {
  f.direction("along", w.along);
  f.direction("up", w.up);
  f.number("wavelength", w.wavelength, positive());
  f.number("depth", w.depth, positive());
  if (f.reading() && std::abs(w.along.normalized().dot(w.up.normalized())) > 1e-6)
    f.fail("up", "must be across \"along\"");
}

void describe(Fields& f, FieldTerm& t) {
  f.choice("field", t.kind,
           {{"linear", FieldKind::linear},
            {"rotation", FieldKind::rotation},
            {"taylor_green", FieldKind::taylor_green},
            {"standing_wave", FieldKind::standing_wave}});
  if (f.reading() && !f.has("field"))
    f.fail("field", "is missing: linear, rotation, taylor_green or standing_wave");
  f.vec3("origin", t.origin);
  if (t.kind == FieldKind::linear) return describe_matrix(f, "gradient", t.gradient);
  if (t.kind == FieldKind::rotation) {
    f.direction("axis", t.axis);
    return f.number("rate", t.rate, any_number());
  }
  f.number("amplitude", t.amplitude, any_number());
  if (t.kind == FieldKind::standing_wave) return describe_wave(f, t.wave);
  f.direction("edge_u", t.edge_u);
  f.direction("edge_v", t.edge_v);
  if (f.reading() && std::abs(t.edge_u.normalized().dot(t.edge_v.normalized())) > 1e-6)
    f.fail("edge_v", "must be across edge_u");
}

void describe(Fields& f, InitialFields& s) {
  f.list("flow", s.flow, [](Fields& g, FieldTerm& t) { describe(g, t); });
  f.list("displacement", s.displacement, [](Fields& g, FieldTerm& t) { describe(g, t); });
  f.number("shake", s.shake, between(0, 0.25));
}

void describe(Fields& f, FilledBox& e) {
  f.vec3("min", e.box.min);
  f.vec3("max", e.box.max);
  f.check_box(e.box);
  f.vec3("velocity", e.velocity);
  f.number("start", e.start, not_negative());
  describe(f, e.initial);
}

void describe(Fields& f, PlacedMeshEmitter& e) {
  describe(f, e.mesh);
  f.vec3("velocity", e.velocity);
  f.number("start", e.start, not_negative());
  describe(f, e.initial);
}

void describe(Fields& f, RainEmitter& e) {
  f.vec3("corner", e.corner);
  f.direction("edge_u", e.edge_u);
  f.direction("edge_v", e.edge_v);
  f.number("drops_per_second", e.drops_per_second, positive());
  f.number("drop_radius", e.drop_radius, not_negative());
  f.vec3("velocity", e.velocity);
  describe_times(f, e);
}

enum class EmitterShape { disc, box, mesh, rain };

}  // namespace

void describe_emitter(Fields& f, Emitter& e) {
  auto shape = static_cast<EmitterShape>(e.shape.index());
  f.choice("shape", shape,
           {{"disc", EmitterShape::disc},
            {"box", EmitterShape::box},
            {"mesh", EmitterShape::mesh},
            {"rain", EmitterShape::rain}});
  if (f.reading()) {
    if (!f.has("shape")) f.fail("shape", "is missing: disc, box, mesh or rain");
    if (shape == EmitterShape::disc) e.shape = DiscEmitter();
    if (shape == EmitterShape::box) e.shape = FilledBox();
    if (shape == EmitterShape::mesh) e.shape = PlacedMeshEmitter();
    if (shape == EmitterShape::rain) e.shape = RainEmitter();
  }
  std::visit([&](auto& emitter) { describe(f, emitter); }, e.shape);
  f.object("motion", [&](Fields& g) { describe(g, e.motion); });
  f.boolean("inherits_motion", e.inherits_motion);
  f.number("max_age", e.max_age, positive());
}

}  // namespace oilskin::demo
