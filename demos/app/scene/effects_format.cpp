#include "scene/effects_format.h"

namespace oilskin::demo {
namespace {

/// Ignoring an effect would pass for simulating it.
void refuse_later_effects(Fields& f) {
  for (const char* effect : {"wetting", "surface_tension", "adhesion"})
    if (f.raw(effect) != nullptr) f.fail(effect, "is not simulated by this version; leave it out");
}

}  // namespace

void describe(Fields& f, SceneEffects&) {
  if (f.reading()) refuse_later_effects(f);
}

}  // namespace oilskin::demo
