#include "contact/reach.h"

#include <algorithm>

#include "core/assert.h"

namespace oilskin::contact {

double wall_offset(const Liquid& liquid, const SurfaceMotion& surface) {
  OILSKIN_ASSERT(liquid.spacing > 0 && surface.thickness > 0);
  return std::max(0.0, surface.thickness - 0.5 * liquid.spacing);
}

double friction_distance(const Liquid& liquid, const SurfaceMotion& surface, const SlipSettings& slip) {
  switch (slip.model) {
    case SlipModel::free:
      return 0;
    case SlipModel::viscous_wall:
      return wall_offset(liquid, surface) + liquid.spacing;
    case SlipModel::coulomb:
    case SlipModel::sticking:
      break;
  }
  // Particles at rest have d0 = h up to rounding; 0.1 dx keeps rounding from deciding.
  return surface.thickness + 0.1 * liquid.spacing;
}

double wall_layer(const Liquid& liquid, const SurfaceMotion& surface) {
  double layer = 0;
  for (bool back : {false, true}) {
    const SlipSettings& slip = surface.slip_on(back);
    if (slip.model == SlipModel::viscous_wall)
      layer = std::max(layer, friction_distance(liquid, surface, slip));
  }
  return layer;
}

}  // namespace oilskin::contact
