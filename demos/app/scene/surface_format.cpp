#include "scene/surface_format.h"

namespace oilskin::demo {
namespace {

void describe(Fields& f, SlipSettings& s) {
  f.choice("model", s.model,
           {{"free", SlipModel::free},
            {"coulomb", SlipModel::coulomb},
            {"strict_no_slip", SlipModel::sticking},
            {"viscous_wall", SlipModel::viscous_wall},
            {"no_slip", SlipModel::viscous_wall}});  // the last name of a value is the one that is written
  f.number("friction", s.friction, not_negative());
  f.number("slip_length", s.slip_length, not_negative());
  if (f.has("model")) return;
  for (const char* key : {"friction", "slip_length"})
    if (f.has(key)) f.fail(key, "has no effect without \"model\", which is \"free\"");
}

}  // namespace

void describe(Fields& f, SurfaceSettings& s) {
  f.optional_number("thickness", s.thickness, positive());
  f.object("slip", [&](Fields& g) { describe(g, s.slip); });
  f.optional_object("slip_back", s.slip_back, [](Fields& g, SlipSettings& back) { describe(g, back); });
  f.boolean("smooth", s.smooth);
  f.optional_boolean("solid", s.solid);
  f.mask("collision_group", s.collision_group);
  f.mask("collision_mask", s.collision_mask);
}

void describe(Fields& f, Motion& m) {
  f.vec3("velocity", m.velocity);
  f.vec3("spin_center", m.spin_center);
  f.direction("spin_axis", m.spin_axis);
  f.number("spin_rate", m.spin_rate, any_number());
  describe_times(f, m);
}

}  // namespace oilskin::demo
