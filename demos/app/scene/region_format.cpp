#include "scene/region_format.h"

namespace oilskin::demo {
namespace {

void describe_ball(Fields& f, Capsule& ball) {
  f.vec3("center", ball.from);
  f.number("radius", ball.radius, positive());
  ball.to = ball.from;
}

void describe_box(Fields& f, Box& box) {
  for (const char* key : {"min", "max"})
    if (f.reading() && !f.has(key)) f.fail(key, "is missing: a corner of the box");
  f.vec3("min", box.min);
  f.vec3("max", box.max);
  if (f.reading() && !(box.min.array() <= box.max.array()).all())
    f.fail("max", "must be at least min in every coordinate");
}

void describe_region(Fields& f, Region& r) {
  f.optional_object("box", r.box, [](Fields& g, Box& box) { describe_box(g, box); });
  f.optional_object("ball", r.capsule, [](Fields& g, Capsule& ball) { describe_ball(g, ball); });
}

void describe(Fields& f, UniformForce& u) {
  f.vec3("acceleration", u.acceleration);
}

void describe(Fields& f, VortexForce& v) {
  f.vec3("center", v.center);
  f.direction("axis", v.axis);
  f.number("radius", v.radius, positive());
  f.number("strength", v.strength, any_number());
}

void describe(Fields& f, WindForce& w) {
  f.vec3("velocity", w.velocity);
  f.number("air_density", w.air_density, not_negative());
  f.number("drag_coefficient", w.drag_coefficient, not_negative());
  f.number("friction_coefficient", w.friction_coefficient, not_negative());
}

enum class ForceKind { uniform, vortex, wind };

}  // namespace

void describe_sink(Fields& f, Region& r) {
  describe_region(f, r);
  if (f.reading() && !r.box && !r.capsule) f.fail("box", "is missing: a sink needs a \"box\" or a \"ball\"");
}

void describe(Fields& f, Force& force) {
  auto kind = static_cast<ForceKind>(force.index());
  f.choice("force", kind,
           {{"uniform", ForceKind::uniform}, {"vortex", ForceKind::vortex}, {"wind", ForceKind::wind}});
  if (f.reading()) {
    if (!f.has("force")) f.fail("force", "is missing: uniform, vortex or wind");
    if (kind == ForceKind::vortex) force = VortexForce();
    if (kind == ForceKind::wind) force = WindForce();
  }
  std::visit(
      [&](auto& field) {
        describe_region(f, field.region);
        describe(f, field);
      },
      force);
}

}  // namespace oilskin::demo
