#include <LinearMath/btIDebugDraw.h>

#include <algorithm>

#include "convert.h"
#include "coupling_impl.h"

namespace oilskin::bullet {

namespace {

constexpr double white_speed = 3;  // [m/s]

btVector3 color_of(double speed) {
  const auto s = static_cast<btScalar>(std::min(1.0, speed / white_speed));
  return btVector3(btScalar(0.1), btScalar(0.3), btScalar(0.8)).lerp(btVector3(1, 1, 1), s);
}

void draw_particles(const World& world, btIDebugDraw* drawer) {
  const double length = 0.5 * world.fluid_settings().spacing;
  for (std::size_t i = 0; i < world.particle_count(); ++i) {
    const Vec3 x = world.positions()[i], v = world.motions()[i];
    const double speed = v.norm();
    const Vec3 tail = x - length * (speed > 0 ? Vec3(v / speed) : Vec3(Vec3::UnitY()));
    drawer->drawLine(to_bt(x), to_bt(tail), color_of(speed));
  }
}

void draw_contacts(const World& world, btIDebugDraw* drawer) {
  const btVector3 color(1, btScalar(0.5), 0);
  for (const Contact& c : world.contacts()) {
    if (c.particle >= world.particle_count()) continue;  // particles were removed after the contact
    const Vec3 foot = world.positions()[c.particle] - c.distance * c.normal;
    drawer->drawContactPoint(to_bt(foot), to_bt(c.normal), static_cast<btScalar>(c.distance), 0, color);
  }
}

}  // namespace

void btFluidCoupling::debugDraw(btIDebugDraw* drawer) {
  if (!drawer) return;
  const int mode = drawer->getDebugMode();
  for (const World* world : m_impl->worlds()) {
    if (mode & btIDebugDraw::DBG_DrawWireframe) draw_particles(*world, drawer);
    if (mode & (btIDebugDraw::DBG_DrawContactPoints | btIDebugDraw::DBG_DrawNormals))
      draw_contacts(*world, drawer);
  }
}

}  // namespace oilskin::bullet
