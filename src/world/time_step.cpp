/// The longest accurate step, and the speeds that decide how many sub-steps a step has.
#include <algorithm>
#include <cmath>

#include "core/assert.h"
#include "fluid/stability.h"
#include "world/numeric_range.h"
#include "world/world_impl.h"

namespace oilskin {

/// A wall gives its own speed to the water in front of it, so the speed of surfaces counts like that of the
/// fluid, but only where their swept triangles overlap the fluid's box.
world::Speeds World::Impl::speeds(Span<SurfaceMotion* const> moved, double moved_for, double dt) const {
  world::Speeds found;
  Box water;
  for (std::size_t i = 0; i < state.particles.size(); ++i) {
    const Vec3 &x = state.particles.position[i], &v = state.particles.velocity[i];
    if (!world::is_in_range(x) || !world::is_in_range(v)) continue;  // removed by the next step
    water.add(x);
    // Momentum that a surface has not taken yet moves nothing.
    found.fluid = std::max(found.fluid, state.particles.motion[i].squaredNorm());
  }
  found.fluid = std::max(std::sqrt(found.fluid), emission->fastest_due(state.time, dt));
  found.change = state.max_acceleration;
  found.gravity = found.fluid > 0 || state.particles.size() > 0 ? settings.gravity.norm() : 0;
  const double reach = fluid->support_radius() + found.fluid * dt;
  if (moved_for > 0) found.surfaces = world::fastest_node(moved, water.inflated(reach), moved_for);
  return found;
}

/// The number of parts that stability asks for, (F.68).
double World::Impl::stable_parts(const world::Speeds& found, double dt) const {
  const FluidSettings& f = fluid_settings;
  return world::parts_needed(
      dt, std::min({fluid::longest_viscous_interval(f), fluid::longest_sound_interval(f, found.fluid),
                    effects.longest_interval(f).interval}));
}

double World::Impl::resting_interval() const {
  return fluid::longest_resting_interval(fluid_settings, settings.gravity.norm());
}

/// The limits (F.45) and (F.46). They hold for an interval: sub-steps relax them.
double World::Impl::longest_dt(double largest) const {
  std::vector<SurfaceMotion*> moved;
  for (const auto& a : attachments.all())
    if (!a->refused && world::can_collide(fluid_settings, a->settings)) moved.push_back(&a->motion);
  const world::Speeds found = speeds(moved, state.last_dt, largest);
  const FluidSettings& f = fluid_settings;
  const double parts = f.max_substeps, support = fluid->support_radius();
  double dt = std::min(largest, world::longest_step(found, parts * f.cfl * f.spacing));
  if (state.max_acceleration > 0)
    dt = std::min(dt, parts * 0.25 * std::sqrt(support / state.max_acceleration));
  dt = std::min(dt, parts * fluid::longest_viscous_interval(f));
  dt = std::min(dt, parts * fluid::longest_sound_interval(f, found.fluid));
  dt = std::min(dt, parts * resting_interval());
  dt = std::min(dt, parts * effects.longest_interval(f).interval);
  OILSKIN_ASSERT(dt > 0);
  return dt;
}

double World::suggested_dt(double largest) const {
  return impl_->status.ok() && largest > 0 ? impl_->longest_dt(largest) : largest;
}

}  // namespace oilskin
