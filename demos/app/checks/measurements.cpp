#include "checks/measurements.h"

#include <unistd.h>

#include <algorithm>
#include <fstream>

#include "geometry/closed_surface.h"
#include "geometry/nearest_surface.h"
#include "geometry/pool.h"
#include "geometry/shadow.h"

namespace oilskin::demo {
namespace {

constexpr std::uint64_t look_every = 10;  // steps, for what changes slowly
constexpr double layer_distance = 10;     // nodes so many thicknesses apart at rest are not of one layer

/// Of this process, now; 0 where the system does not tell [bytes].
std::uint64_t resident_bytes() {
  std::ifstream statm("/proc/self/statm");
  std::uint64_t size = 0, resident = 0;
  statm >> size >> resident;
  return resident * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

}  // namespace

Vec3 Measurer::up() const {
  const Vec3& g = scene_.world.gravity;
  return g.norm() > 0 ? Vec3(-g.normalized()) : Vec3(0, 1, 0);
}

void Measurer::after_step(Simulation& simulation, const StepReport& report) {
  const Acceptance& a = scene_.acceptance;
  const double t = simulation.time().value();
  since_look_ += report.dt;
  if (a.vertical_momentum) measure_impulses(simulation);
  if (a.pin_reaction) measure_reaction(simulation, report, t);
  if (a.pool_level && t > scene_.duration - a.pool_level->window) measure_pool_level(simulation, report.dt);
  if (a.pool_calm && t > scene_.duration - a.pool_calm->window) measure_pool_calm(simulation, report.dt);
  if (!a.at_rest.empty()) measure_rest(simulation, t);
  if (result_.resident_at_fifth == 0 && t >= 0.2 * scene_.duration)
    result_.resident_at_fifth = resident_bytes();
  if (a.inside_constant && (simulation.time().steps() - 1) % std::uint64_t(a.inside_constant->every) == 0)
    measure_inside(simulation);
  if (simulation.time().steps() % look_every != 0) return;
  if (a.max_stretch) measure_stretch(simulation);
  if (a.min_over_rim) measure_rim(simulation);
  if (a.dry_shadow) measure_shadow(simulation);
  if (a.slip_ratio) measure_slip(simulation, t);
  if (a.dam_break) measure_dam(simulation, t);
  if (a.enclosed_volume && t > a.enclosed_volume->from) measure_volume(simulation);
  if (a.energy_decay) measure_energy(simulation, t);
  if (a.close_layers) measure_layers(simulation);
  since_look_ = 0;
}

void Measurer::measure_impulses(Simulation& simulation) {
  auto add = [this](const SurfaceMotion* motion) {
    if (motion != nullptr)
      for (const Vec3& j : motion->impulse) result_.impulse_on_cloth += j;
  };
  for (std::size_t i = 0; i < scene_.cloth.size(); ++i) add(simulation.cloth(i));
  for (std::size_t i = 0; i < scene_.bodies.size(); ++i) add(simulation.body(i));
}

/// What the pins gave is what changed the momentum of the free nodes besides gravity and the water, plus what
/// the water gave to pinned nodes directly. Links are internal to the cloth. The fluid's momentum is not
/// used.
void Measurer::measure_reaction(Simulation& simulation, const StepReport& report, double t) {
  const bool counts = t > scene_.duration - scene_.acceptance.pin_reaction->window;
  velocity_before_.resize(scene_.cloth.size());
  double gained = 0, free_mass = 0;
  for (std::size_t c = 0; c < scene_.cloth.size(); ++c) {
    const SurfaceMotion* motion = simulation.cloth(c);
    if (motion == nullptr) continue;
    const bool known = velocity_before_[c].size() == motion->velocity.size();
    for (std::size_t i = 0; i < motion->velocity.size() && known; ++i) {
      const double j = motion->impulse[i].dot(up());
      gained -= j;  // the pins answer for a pinned node; a free node's change below contains j
      if (motion->inverse_mass[i] == 0) continue;
      const double m = 1 / motion->inverse_mass[i];
      gained += m * (motion->velocity[i] - velocity_before_[c][i]).dot(up());
      free_mass += m;
    }
    velocity_before_[c] = motion->velocity;
  }
  if (!counts) return;
  const double g = scene_.world.gravity.norm();
  const double water =
      simulation.world().particle_mass() * static_cast<double>(simulation.world().particle_count());
  result_.reaction_impulse += gained + free_mass * g * report.dt;
  result_.weight_impulse += (free_mass + water) * g * report.dt;
}

void Measurer::measure_stretch(Simulation& simulation) {
  for (std::size_t c = 0; c < scene_.cloth.size(); ++c) {
    const ClothModel& model = simulation.models()[c];
    const SurfaceMotion* motion = simulation.cloth(c);
    if (motion == nullptr) continue;
    for (const auto& [i, j] : model.links) {
      const double rest = (model.rest[i] - model.rest[j]).norm();
      result_.largest_stretch =
          std::max(result_.largest_stretch, (motion->x_t1[i] - motion->x_t1[j]).norm() / rest);
    }
  }
}

void Measurer::measure_rim(Simulation& simulation) {
  Box outline;
  for (const Vec3& x : simulation.models()[0].rest) outline.add(x);
  const World& world = simulation.world();
  const Vec3 n = up();
  double rim = std::numeric_limits<double>::infinity();
  for (const Vec3& x : simulation.models()[0].rest) rim = std::min(rim, x.dot(n));
  for (std::size_t i = 0; i < world.particle_count(); ++i) {
    const Vec3& x = world.positions()[i];
    // Clamped to the outline in all but the vertical, a particle over the rim moves.
    const Vec3 off = x - x.cwiseMax(outline.min).cwiseMin(outline.max);
    if ((off - n * off.dot(n)).norm() > 0 && x.dot(n) < rim - 0.02) result_.over_rim.insert(world.ids()[i]);
  }
}

void Measurer::measure_shadow(Simulation& simulation) {
  const DryShadowCheck& check = *scene_.acceptance.dry_shadow;
  const SurfaceMotion* motion = simulation.cloth(static_cast<std::size_t>(check.cloth));
  if (motion == nullptr) return;
  const Shadow shadow(*motion, -up());
  for (const Vec3& x : simulation.world().positions())
    if (shadow.covers(x, check.margin)) ++result_.in_shadow;
}

void Measurer::measure_slip(Simulation& simulation, double t) {
  const SlipRatioCheck& check = *scene_.acceptance.slip_ratio;
  if (t <= scene_.duration - check.window) return;
  const std::array<int, 2> sheets = {check.free, check.no_slip};
  for (int s = 0; s < 2; ++s) {
    const SurfaceMotion* motion = simulation.cloth(static_cast<std::size_t>(sheets[s]));
    if (motion == nullptr) continue;
    NearestSurface nearest(check.within * scene_.fluid.spacing);
    nearest.add(*motion, s);
    const World& world = simulation.world();
    for (std::size_t i = 0; i < world.particle_count(); ++i) {
      NearestSurface::Hit hit;
      if (!nearest.find(world.positions()[i], &hit) || hit.point.distance == 0) continue;
      Vec3 u = world.velocities()[i];
      for (int k = 0; k < 3; ++k) u -= hit.point.weights[k] * motion->velocity[hit.nodes[k]];
      const Vec3 n = hit.point.offset / hit.point.distance;
      result_.slip_way[s] += since_look_ * (u - n * n.dot(u)).norm();
      result_.slip_time[s] += since_look_;
    }
  }
}

double Measurer::water_volume(Simulation& simulation) const {
  return simulation.world().particle_mass() * static_cast<double>(simulation.world().particle_count()) /
         scene_.fluid.rest_density;
}

void Measurer::measure_pool_level(Simulation& simulation, double dt) {
  const PoolLevelCheck& check = *scene_.acceptance.pool_level;
  const SurfaceMotion* motion = simulation.cloth(static_cast<std::size_t>(check.cloth));
  if (motion == nullptr) return;
  const PoolSurface pool = pool_surface(*motion, up(), water_volume(simulation));
  // The height of the top layer's particles, by two ways; the lower counts. A heap in the middle does not
  // lift the pool that the volume gives, and water that hangs on the cloth is missed in the middle.
  const double spacing = scene_.fluid.spacing;
  const double level = std::min(pool.height - 0.5 * spacing,
                                level_in_middle(*motion, simulation.world().positions(), up(), check.middle));
  // A basin that cannot hold the water has no pool: all of it is in the wrong place.
  result_.above_pool_sum +=
      dt *
      (pool.in_rim ? fraction_above(simulation.world().positions(), up(), level + check.above * spacing) : 1);
  result_.above_pool_time += dt;
}

void Measurer::measure_pool_calm(Simulation& simulation, double dt) {
  const PoolCalmCheck& check = *scene_.acceptance.pool_calm;
  const SurfaceMotion* motion = simulation.cloth(static_cast<std::size_t>(check.cloth));
  if (motion == nullptr) return;
  const PoolSurface pool = pool_surface(*motion, up(), water_volume(simulation));
  const World& world = simulation.world();
  const double spacing = scene_.fluid.spacing;
  const double layer = scene_.fluid.rest_density * pool.area * spacing;  // [kg]
  const double energy = layer * scene_.world.gravity.norm() * spacing;
  result_.pool_energy_sum +=
      dt * (pool.in_rim && energy > 0
                ? world.particle_mass() * kinetic_energy_per_mass(world.velocities()) / energy
                : std::numeric_limits<double>::infinity());
  result_.pool_energy_time += dt;
}

void Measurer::measure_rest(Simulation& simulation, double t) {
  const std::vector<AtRestCheck>& checks = scene_.acceptance.at_rest;
  result_.rest_speed.resize(checks.size(), -1);
  const World& world = simulation.world();
  for (std::size_t i = 0; i < checks.size(); ++i) {
    if (t <= checks[i].from || t > checks[i].to) continue;
    result_.rest_speed[i] = std::max(
        result_.rest_speed[i], rms_speed_within(world.positions(), world.velocities(), checks[i].within));
  }
}

void Measurer::measure_dam(Simulation& simulation, double t) {
  const DamBreakCheck& check = *scene_.acceptance.dam_break;
  const DamPlace place{check.foot,    check.along.normalized(), up(), check.width,
                       check.breadth, scene_.fluid.spacing};
  result_.dam.push_back(look_at_dam(simulation.world().positions(), place, t));
}

void Measurer::measure_inside(Simulation& simulation) {
  const SurfaceMotion* motion =
      simulation.cloth(static_cast<std::size_t>(scene_.acceptance.inside_constant->cloth));
  if (motion == nullptr) return;
  const World& world = simulation.world();
  const ClosedSurface surface(*motion);
  const bool first = result_.inside_looks++ == 0;
  if (first && !surface.closed()) result_.inside_changed = world.particle_count();  // it has no inside
  std::uint64_t known = 0;
  for (std::size_t i = 0; i < world.particle_count(); ++i) {
    const int turns = surface.winding_number(world.positions()[i]);
    if (first) {
      winding_[world.ids()[i]] = turns;
      result_.inside += turns != 0 ? 1 : 0;
      continue;
    }
    const auto before = winding_.find(world.ids()[i]);
    if (before == winding_.end() || before->second != turns) ++result_.inside_changed;
    if (before != winding_.end()) ++known;
  }
  if (!first) result_.inside_changed += winding_.size() - known;  // those that are gone
}

void Measurer::measure_volume(Simulation& simulation) {
  const SurfaceMotion* motion =
      simulation.cloth(static_cast<std::size_t>(scene_.acceptance.enclosed_volume->cloth));
  const double water = water_volume(simulation);
  if (motion == nullptr || !(water > 0)) return;
  const double ratio = ClosedSurface(*motion).volume() / water;
  result_.least_volume = std::min(result_.least_volume, ratio);
  result_.largest_volume = std::max(result_.largest_volume, ratio);
}

/// Of what can move: water and the free nodes of cloth.
void Measurer::measure_energy(Simulation& simulation, double t) {
  const EnergyDecayCheck& check = *scene_.acceptance.energy_decay;
  const bool first = t > check.from && t <= check.from + check.window,
             last = t > scene_.duration - check.window;
  if (!first && !last) return;
  const World& world = simulation.world();
  double mass = world.particle_mass() * static_cast<double>(world.particle_count());
  double energy = world.particle_mass() * kinetic_energy_per_mass(world.velocities());
  for (std::size_t c = 0; c < scene_.cloth.size(); ++c) {
    const SurfaceMotion* motion = simulation.cloth(c);
    if (motion == nullptr) continue;
    for (std::size_t i = 0; i < motion->velocity.size(); ++i) {
      if (motion->inverse_mass[i] == 0) continue;
      energy += 0.5 / motion->inverse_mass[i] * motion->velocity[i].squaredNorm();
      mass += 1 / motion->inverse_mass[i];
    }
  }
  const double specific = mass > 0 ? energy / mass : std::numeric_limits<double>::infinity();
  for (const std::size_t window : {0, 1}) {
    if (!(window == 0 ? first : last)) continue;
    result_.energy_sum[window] += since_look_ * specific;
    result_.energy_time[window] += since_look_;
  }
}

/// Nodes that lie within the thickness of a node that is far from them in the cloth's rest shape.
void Measurer::measure_layers(Simulation& simulation) {
  const auto c = static_cast<std::size_t>(scene_.acceptance.close_layers->cloth);
  const SurfaceMotion* motion = simulation.cloth(c);
  if (motion == nullptr) return;
  const std::vector<Vec3>&x = motion->x_t1, &rest = simulation.models()[c].rest;
  const double h = motion->thickness;
  std::vector<std::size_t> order(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) { return x[i].x() < x[j].x(); });
  std::vector<std::uint8_t> close(x.size(), 0);
  for (std::size_t a = 0; a < order.size(); ++a) {
    for (std::size_t b = a + 1; b < order.size() && x[order[b]].x() - x[order[a]].x() < h; ++b) {
      const std::size_t i = order[a], j = order[b];
      if ((x[i] - x[j]).norm() < h && (rest[i] - rest[j]).norm() > layer_distance * h)
        close[i] = close[j] = 1;
    }
  }
  result_.close_nodes = std::max<std::uint64_t>(
      result_.close_nodes, static_cast<std::uint64_t>(std::count(close.begin(), close.end(), 1)));
}

void Measurer::finish(Simulation& simulation) {
  result_.resident_at_end = resident_bytes();
  if (scene_.acceptance.inside_constant) measure_inside(simulation);
  auto count = [this](Span<const Vec3> values) {
    for (const Vec3& v : values) result_.not_finite += v.allFinite() ? 0 : 1;
  };
  count(simulation.world().positions());
  count(simulation.world().velocities());
  for (std::size_t c = 0; c < scene_.cloth.size(); ++c) {
    const SurfaceMotion* motion = simulation.cloth(c);
    if (motion == nullptr) continue;
    count(motion->x_t1);
    count(motion->velocity);
    if (c == 0) result_.centre_node = motion->x_t1[centre_node(simulation.models()[0])];
  }
}

std::size_t centre_node(const ClothModel& model) {
  Vec3 mean = Vec3::Zero();
  for (const Vec3& x : model.rest) mean += x / static_cast<double>(model.rest.size());
  std::size_t best = 0;
  for (std::size_t i = 1; i < model.rest.size(); ++i)
    if ((model.rest[i] - mean).squaredNorm() < (model.rest[best] - mean).squaredNorm()) best = i;
  return best;
}

}  // namespace oilskin::demo
