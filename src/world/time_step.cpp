/// The longest accurate step, and the number of sub-steps of a step.
#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "core/assert.h"
#include "fluid/stability.h"
#include "world/numeric_range.h"
#include "world/upper_pressure.h"
#include "world/world_impl.h"

namespace oilskin {

using world::StepContext;

/// A wall gives its own speed to the water in front of it, so the speed of surfaces counts like that of the
/// fluid, but only where their swept triangles overlap the fluid's box.
world::Speeds World::Impl::speeds(Span<SurfaceMotion* const> moved, double moved_for, double dt) const {
  struct Water {
    Box box;
    double speed = 0;  // squared
    void operator+=(const Water& o) {
      box.add(o.box);
      speed = std::max(speed, o.speed);
    }
  };
  const fluid::Particles& particles = state.particles;
  const Water water =
      workers->ordered_sum(particles.size(), 4096, Water(), [&](std::size_t begin, std::size_t end) {
        Water part;
        for (std::size_t i = begin; i < end; ++i) {
          if (!world::is_in_range(particles, i)) continue;  // removed by the next step
          part.box.add(particles.position[i]);
          // Momentum that a surface has not taken yet moves nothing.
          part.speed = std::max(part.speed, particles.motion[i].squaredNorm());
        }
        return part;
      });
  Box box = water.box;
  const Box due = emission->due_volumes(state.time, dt);
  box.add(due);
  world::Speeds found;
  found.fluid = std::max(std::sqrt(water.speed), emission->fastest_due(state.time, dt));
  found.change = state.max_acceleration;
  const double g = settings.gravity.norm();
  found.has_water = box.min.x() <= box.max.x();
  if (found.has_water && g > 0)
    found.height =
        fluid_settings.spacing + world::tallest_part(particles.position, due, box, settings.gravity / -g,
                                                     fluid->support_radius() + found.fluid * dt, *workers);
  found.gravity = found.fluid > 0 || found.has_water ? g : 0;
  const double reach = fluid->support_radius() + found.fluid * dt;
  found.has_cloth = found.has_water && world::has_free_nodes(moved, box.inflated(reach));
  if (moved_for > 0) found.surfaces = world::fastest_node(moved, box.inflated(reach), moved_for, *workers);
  return found;
}

/// The number of parts that stability asks for, (F.68).
double World::Impl::stable_parts(const world::Speeds& found, double dt) const {
  const FluidSettings& f = fluid_settings;
  return world::parts_needed(
      dt, std::min({fluid::longest_viscous_interval(f), fluid::longest_sound_interval(f, found.fluid),
                    effects.longest_interval(f).interval}));
}

/// By the pressure of the last interval, in heights of a column. It is at most the height of the tallest
/// water: impacts have more, for a moment, and are limited by speeds. It is at least that height up to 15 dx,
/// since in water that falls or fills a vessel the pressure rises too fast to be seen in time; before the
/// first interval the height counts in full. In longer intervals drops on light cloth make energy, and PCISPH
/// bursts in shallow water.
double World::Impl::loaded_interval(const world::Speeds& found) const {
  using fluid::usual_layers;
  const FluidSettings& f = fluid_settings;
  const double g = settings.gravity.norm(), of_layer = f.rest_density * g * f.spacing;
  if (f.boundary != BoundaryModel::mirrored || !(of_layer > 0))
    return std::numeric_limits<double>::infinity();
  const double least = found.has_cloth || f.solver == PressureSolver::pcisph ? usual_layers : 3;
  const double reached = std::max(least, found.height / f.spacing);
  const double pressure = world::upper_pressure(state.particles.pressure, *workers) / of_layer;
  const double layers =
      pressure > 0 ? std::clamp(pressure, std::min(reached, usual_layers), reached) : reached;
  return fluid::longest_loaded_interval(f, layers, g);
}

namespace {

/// `cause` needs more sub-steps than max_substeps; `rest` is what follows from it.
template <class... Rest>
void report_limit(StepContext& step, const std::string& cause, double longest, int maximum,
                  const Rest&... rest) {
  std::ostringstream text;
  text << cause << " at dt " << step.dt << " s needs " << world::parts_needed(step.dt, longest)
       << " fluid sub-steps; max_substeps is " << maximum << ", so ";
  (text << ... << rest);
  step.report.messages.push_back(text.str());
}

}  // namespace

/// More parts than max_substeps are needed: which limit it is, with the numbers.
void World::Impl::report_instability(StepContext& step, const world::Speeds& found) const {
  const FluidSettings& f = fluid_settings;
  const double part = step.dt / step.report.substeps, viscous = fluid::longest_viscous_interval(f);
  const world::Effects::Limit effect = effects.longest_interval(f);
  if (part > effect.interval)
    report_limit(step, "the effect " + effect.name, effect.interval, f.max_substeps,
                 "its intervals are longer than it asks for");
  if (part > fluid::longest_sound_interval(f, found.fluid)) step.report.flags |= flag_sound_too_fast;
  if (part <= viscous) return;
  step.report.flags |= flag_viscosity_limited;
  std::ostringstream cause;
  cause << "fluid.viscosity " << f.viscosity << " m²/s";
  report_limit(step, cause.str(), viscous, f.max_substeps, fluid::viscous_step(f, part) / part,
               " m²/s was applied");
}

/// Before the first step the height of the water stands for its pressure, even where it falls. Up to 1.2
/// times `loaded` water at rest keeps its depth.
void World::Impl::report_load(StepContext& step, double loaded) const {
  constexpr double most = 1.2;
  const int maximum = fluid_settings.max_substeps;
  if (state.step_count == 0 || step.report.substeps < maximum || step.dt / maximum <= most * loaded) return;
  step.report.flags |= flag_load_limited;
  step.report.substeps_needed = std::max(step.report.substeps_needed, world::parts_needed(step.dt, loaded));
  report_limit(step, "the weight of the water", loaded, maximum, "it is compressed");
}

/// What the time limit leaves of `count` sub-steps, and of the iterations. With fewer sub-steps than `least`
/// water would be compressed to a multiple of its density.
int World::Impl::within_budget(StepContext& step, int least, int count) {
  const FluidSettings& f = fluid_settings;
  world::StepBudget::Plan plan{count, f.max_iterations};
  if (settings.step_budget > 0) plan = budget.plan(settings.step_budget, {least, f.min_iterations}, plan);
  step.report.substeps_left_out = count - plan.substeps;
  step.report.iteration_limit = plan.iterations < f.max_iterations ? plan.iterations : 0;
  fluid->limit_iterations(plan.iterations);
  return plan.substeps;
}

void World::Impl::choose_substeps(StepContext& step) {
  const double distance = fluid_settings.cfl * fluid_settings.spacing, dt = step.dt;
  const int maximum = fluid_settings.max_substeps;
  const std::vector<SurfaceMotion*>& surfaces = step.surfaces.motion;
  int& count = step.report.substeps;
  const world::Speeds found = speeds(surfaces, dt, dt);
  double& needed = step.report.substeps_needed;
  needed = found.has_water || found.fluid > 0 ? stable_parts(found, dt) : 1;
  const auto stable = [&](double longest) {
    const double parts = found.has_water ? world::parts_needed(dt, longest) : 1;
    return static_cast<int>(std::min(std::max(needed, parts), static_cast<double>(maximum)));
  };
  const double loaded = loaded_interval(found),
               usual = fluid::longest_loaded_interval(fluid_settings, fluid::usual_layers,
                                                      settings.gravity.norm());
  count = std::max(world::substep_count(found, dt, distance, maximum), stable(loaded));
  count = within_budget(step, stable(std::max(loaded, usual)), count);
  if (needed > count) report_instability(step, found);
  if (found.has_water && step.report.substeps_left_out == 0) report_load(step, loaded);
  OILSKIN_ASSERT(count >= 1 && count <= maximum);
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
  dt = std::min(dt, parts * loaded_interval(found));
  dt = std::min(dt, parts * effects.longest_interval(f).interval);
  OILSKIN_ASSERT(dt > 0);
  return dt;
}

double World::suggested_dt(double largest) const {
  return impl_->status.ok() && largest > 0 ? impl_->longest_dt(largest) : largest;
}

}  // namespace oilskin
