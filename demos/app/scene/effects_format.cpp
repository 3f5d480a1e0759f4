#include "scene/effects_format.h"

namespace oilskin::demo {
namespace {

/// Ignoring an effect would pass for simulating it.
void refuse_later_effects(Fields& f) {
  for (const char* effect : {"wetting", "surface_tension", "adhesion"})
    if (f.raw(effect) != nullptr) f.fail(effect, "is not simulated by this version; leave it out");
}

void describe_viscosity(Fields& f, ImplicitViscositySettings& s) {
  f.number("coefficient", s.coefficient, {0, 1e6, true});
  f.number("tolerance", s.tolerance, between(1e-12, 0.1));
  f.integer("max_iterations", s.max_iterations, between(1, 10000));
}

}  // namespace

void describe(Fields& f, SceneEffects& effects) {
  f.optional_object("viscosity", effects.viscosity,
                    [](Fields& g, ImplicitViscositySettings& s) { describe_viscosity(g, s); });
  if (f.reading()) refuse_later_effects(f);
}

}  // namespace oilskin::demo
