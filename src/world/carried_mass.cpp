#include "world/carried_mass.h"

#include <algorithm>
#include <cmath>

#include "core/assert.h"
#include "core/inverse_mass.h"

namespace oilskin::world {

namespace {

/// t_m of (C.30) [s].
constexpr double memory_time = 0.05;

/// Of the spacing: the motion of a node by its load in a step from which on it carries water (C.29).
/// Measured, as the next one, in docs/decisions/0019-mass-carried-by-light-cloth.md.
constexpr double largest_motion = 0.03;

/// Of a layer of particles: the most that a node carries (C.29).
constexpr double largest_share = 0.5;

/// Nodes whose load, times this, would not move them farther carry nothing (C.29): nodes that the water
/// hardly touches, or has left, must not strike it as if they were heavy.
constexpr double smallest_load = 64;

constexpr std::size_t chunk_size = 512;

/// A third of the areas of the triangles at each node [m²].
std::vector<double> node_areas(const SurfaceMotion& m, const Workers& workers) {
  std::vector<double> third(m.triangles.size()), area(m.x_t1.size(), 0);
  workers.for_each(m.triangles.size(), chunk_size, [&](std::size_t k) {
    const Triangle& t = m.triangles[k];
    const Vec3 &a = m.x_t1[t[0]], &b = m.x_t1[t[1]], &c = m.x_t1[t[2]];
    third[k] = (b - a).cross(c - a).norm() / 6;
  });
  for (std::size_t k = 0; k < m.triangles.size(); ++k)
    for (std::uint32_t node : m.triangles[k]) area[node] += third[k];
  return area;
}

/// (C.31)
Vec3 owed(const SurfaceMotion& m) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < m.added_mass.size(); ++i)
    sum += m.added_mass[i] * m.inverse_mass[i] * m.impulse[i];
  return sum;
}

/// r of (C.42): carried over own mass that the loaded nodes need on average, weighted by the loads.
double needed_ratio(double dt, const FluidSettings& fluid, const Attachment& a, const Workers& workers) {
  struct Sums {
    double needed = 0, loads = 0;
    void operator+=(const Sums& o) {
      needed += o.needed;
      loads += o.loads;
    }
  };
  const Sums all =
      workers.ordered_sum(a.mean_load.size(), chunk_size, Sums(), [&](std::size_t begin, std::size_t end) {
        Sums sums;
        for (std::size_t i = begin; i < end; ++i) {
          if (a.motion.inverse_mass[i] == 0) continue;
          const double load = a.mean_load[i].norm(), motion = dt * dt * load / own_mass(a.motion, i);
          sums.needed += load * std::max(0.0, motion / (largest_motion * fluid.spacing) - 1);
          sums.loads += load;
        }
        return sums;
      });
  return all.loads > 0 ? all.needed / all.loads : 0;
}

void record_load(double dt, Attachment& a, const Workers& workers) {
  const SurfaceMotion& m = a.motion;
  if (a.mean_load.size() != m.impulse.size()) a.mean_load.assign(m.impulse.size(), Vec3::Zero());
  const double fresh = -std::expm1(-dt / memory_time);
  workers.for_each(m.impulse.size(), chunk_size,
                   [&](std::size_t i) { a.mean_load[i] += fresh * (m.impulse[i] / dt - a.mean_load[i]); });
}

}  // namespace

/// (C.29)
void update_carried_mass(double dt, const FluidSettings& fluid, Attachment& a, const Workers& workers,
                         StepReport& report) {
  SurfaceMotion& m = a.motion;
  OILSKIN_ASSERT(dt > 0 && m.impulse.size() == m.x_t1.size());
  if (m.still != 0) return forget_load(a);  // prescribed nodes carry nothing
  report.momentum_owed += owed(m);
  record_load(dt, a, workers);
  const std::vector<double> area = node_areas(m, workers);
  const double most = largest_share * fluid.rest_density * fluid.spacing;
  const double ratio = needed_ratio(dt, fluid, a, workers);
  m.carried_mass.assign(m.x_t1.size(), 0);
  struct Most {
    double speed = 0, ratio = 0;
    void operator+=(const Most& o) {
      speed = std::max(speed, o.speed);
      ratio = std::max(ratio, o.ratio);
    }
  };
  const Most found =
      workers.ordered_sum(m.x_t1.size(), chunk_size, Most(), [&](std::size_t begin, std::size_t end) {
        Most most_of_chunk;
        for (std::size_t i = begin; i < end; ++i) {
          if (m.inverse_mass[i] == 0) continue;
          const double own = own_mass(m, i), load = a.mean_load[i].norm();
          most_of_chunk.speed = std::max(most_of_chunk.speed, load * dt / own);
          const double by_load = smallest_load * dt * dt * load / (largest_motion * fluid.spacing) - own;
          const double carried = std::min({ratio * own, most * area[i], by_load});
          if (!(carried > 0)) continue;
          m.carried_mass[i] = carried;
          most_of_chunk.ratio = std::max(most_of_chunk.ratio, carried / own);
        }
        return most_of_chunk;
      });
  report.load_speed = std::max(report.load_speed, found.speed);
  report.carried_ratio = std::max(report.carried_ratio, found.ratio);
}

void forget_load(Attachment& a) {
  a.mean_load.clear();
  a.motion.carried_mass.clear();
}

bool is_mean_load(const std::vector<Vec3>& load, std::size_t n) {
  return (load.empty() || load.size() == n) &&
         std::all_of(load.begin(), load.end(), [](const Vec3& f) { return f.allFinite(); });
}

}  // namespace oilskin::world
