#include "scene/effects_format.h"

#include "scene/region_format.h"

namespace oilskin::demo {
namespace {

/// There is no such key: the refusal names the one that does what its reader wants.
void refuse_adhesion(Fields& f) {
  if (f.raw("adhesion") != nullptr)
    f.fail("adhesion", "is part of surface_tension: its contact_angle says how far the water adheres");
}

void describe_surface_tension(Fields& f, SurfaceTensionSettings& s) {
  f.number("coefficient", s.coefficient, positive());
  f.number("contact_angle", s.contact_angle, between(0, 180));
}

void describe_viscosity(Fields& f, ImplicitViscositySettings& s) {
  f.number("coefficient", s.coefficient, {0, 1e6, true});
  f.number("tolerance", s.tolerance, between(1e-12, 0.1));
  f.integer("max_iterations", s.max_iterations, between(1, 10000));
}

enum class Textile { none, cotton, wool, nylon };

/// What the other keys change.
void apply_textile(Fields& f, Fabric& fabric) {
  if (!f.reading()) return;
  Textile textile = Textile::none;
  f.choice("textile", textile,
           {{"none", Textile::none},
            {"cotton", Textile::cotton},
            {"wool", Textile::wool},
            {"nylon", Textile::nylon}});
  if (textile == Textile::cotton) fabric = cotton_fabric();
  if (textile == Textile::wool) fabric = wool_fabric();
  if (textile == Textile::nylon) fabric = nylon_fabric();
}

void describe_wetting(Fields& f, WettingSettings& s) {
  describe(f, s.fabric);
  f.number("absorption", s.absorption, between(0, 1e6));
  f.number("dripping", s.dripping, between(0, 1e6));
  f.number("drying", s.drying, between(0, 1e6));
  f.number("transport_interval", s.transport_interval, between(0, 1));
}

}  // namespace

void describe(Fields& f, Fabric& s) {
  apply_textile(f, s);
  f.number("capacity", s.capacity, between(1e-6, 1e3));
  f.number("diffusivity", s.diffusivity, between(1e-15, 1));
  f.number("mobility_exponent", s.mobility_exponent, between(0, 10));
  f.number("capillary_rise", s.capillary_rise, between(1e-6, 1e12));
  f.number("anisotropy", s.anisotropy, between(1e-3, 1e3));
  f.direction("warp", s.warp);
  f.number("saturation_limit", s.saturation_limit, between(1, 10));
}

void describe(Fields& f, SceneEffects& effects) {
  f.optional_object("viscosity", effects.viscosity,
                    [](Fields& g, ImplicitViscositySettings& s) { describe_viscosity(g, s); });
  f.optional_object("wetting", effects.wetting,
                    [](Fields& g, WettingSettings& s) { describe_wetting(g, s); });
  if (f.reading()) refuse_adhesion(f);
  f.optional_object("surface_tension", effects.surface_tension, describe_surface_tension);
  if (f.reading() || !effects.forces.empty())
    f.list("forces", effects.forces, [](Fields& g, Force& force) { describe(g, force); });
}

}  // namespace oilskin::demo
