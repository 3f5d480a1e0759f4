#include "listening.h"

#include <algorithm>

#include "convert.h"

namespace oilskin::bullet {

namespace {

/// Σ |J| x / Σ |J| over the nodes; the origin without an impulse.
Vec3 mean_place(const SurfaceMotion& surface) {
  double weight = 0;
  Vec3 moment = Vec3::Zero();
  for (std::uint32_t j : surface.touched) {
    const double size = surface.impulse[j].norm();
    weight += size;
    moment += size * surface.x_t1[j];
  }
  return weight > 0 ? Vec3(moment / weight) : Vec3::Zero();
}

bool has_impulse(const SurfaceMotion& surface) {
  return surface.impulse.size() == surface.x_t1.size() &&
         std::any_of(surface.touched.begin(), surface.touched.end(),
                     [&](std::uint32_t j) { return !surface.impulse[j].isZero(0); });
}

btFluidTouch touch_of(const SurfaceMotion& surface, const SurfaceLoad& load, double area, double dt) {
  btFluidTouch touch;
  touch.m_impulse = to_bt(load.impulse);
  touch.m_angularImpulse = to_bt(load.angular_impulse);
  touch.m_place = to_bt(mean_place(surface));
  touch.m_area = static_cast<btScalar>(area);
  touch.m_timeStep = static_cast<btScalar>(dt);
  return touch;
}

}  // namespace

bool Listening::has(const btFluidListener* listener) const {
  return std::find(listeners.begin(), listeners.end(), listener) != listeners.end();
}

void Listening::add_load(const SurfaceMotion& surface, double area, double dt, std::uint64_t attachment,
                         Touched& touched) {
  if (!has_impulse(surface)) return add_no_load(dt, attachment, touched);
  const SurfaceLoad load = load_of(surface);
  touched.total.impulse += load.impulse;
  touched.total.angular_impulse += load.angular_impulse;
  const bool begins = !touched.is_touched;
  touched.is_touched = true;
  touched.since_touch = 0;
  if (listeners.empty()) return;
  FluidEvent event = {FluidEvent::Kind::touch_began, attachment, touch_of(surface, load, area, dt), {}};
  if (begins) due.push_back(event);
  event.kind = FluidEvent::Kind::splash;
  due.push_back(event);
}

void Listening::add_flow(const btFluidFlow& flow, std::uint64_t attachment) {
  if (listeners.empty()) return;
  if (flow.m_entered > 0) due.push_back({FluidEvent::Kind::water_entered, attachment, {}, flow});
  if (flow.m_left > 0) due.push_back({FluidEvent::Kind::water_left, attachment, {}, flow});
}

void Listening::add_no_load(double dt, std::uint64_t attachment, Touched& touched) {
  if (!touched.is_touched) return;
  touched.since_touch += dt;
  if (touched.since_touch < touch_hold) return;
  touched.is_touched = false;
  if (!listeners.empty()) due.push_back({FluidEvent::Kind::touch_ended, attachment, {}, {}});
}

}  // namespace oilskin::bullet
