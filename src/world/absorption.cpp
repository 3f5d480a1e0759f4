#include "world/absorption.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "contact/predicates.h"
#include "core/assert.h"
#include "core/inverse_mass.h"
#include "world/clearance.h"
#include "world/numeric_range.h"
#include "world/particle_limit.h"
#include "world/point_cells.h"

namespace oilskin::world {

namespace {

/// Least distance of a new particle from others [dx].
constexpr double free_distance = 0.7;

/// Of a particle's mass: what nodes give together may differ from it by rounding.
constexpr double release_tolerance = 1e-12;

LiquidChange& change_of(Attachment& a) {
  const std::size_t n = a.motion.x_t1.size();
  if (a.motion.absorbed_mass.size() != n) a.motion.absorbed_mass.assign(n, 0);
  LiquidChange& c = a.liquid_change;
  if (c.mass.size() != n) {
    c.before = a.motion.absorbed_mass;
    c.mass.assign(n, 0);
    c.momentum.assign(n, Vec3::Zero());
  }
  return c;
}

/// The particles that releases may be near to.
PointCells particles_near(const fluid::Particles& particles, const std::vector<Vec3>& releases,
                          double distance) {
  Box bounds;
  for (const Vec3& x : releases)
    if (is_in_range(x)) bounds.add(x);
  bounds = bounds.inflated(distance);
  PointCells cells(distance);
  for (std::size_t i = 0; i < particles.size(); ++i)
    if (bounds.contains(particles.position[i])) cells.add(i, particles.position[i]);
  return cells;
}

bool is_way_free(const ActiveSurfaces& active, const Vec3& from, const Vec3& to) {
  Box way;
  way.add(from);
  way.add(to);
  for (const SurfaceMotion* s : active.motion)
    for (const Triangle& t : s->triangles) {
      const Vec3 &a = s->x_t1[t[0]], &b = s->x_t1[t[1]], &c = s->x_t1[t[2]];
      Box box;
      for (const Vec3* x : {&a, &b, &c}) box.add(*x);
      if (box.overlaps(way) && contact::paths_intersect({from, a, b, c}, {to, a, b, c}).hit) return false;
    }
  return true;
}

/// Whether the nodes have what they are to give, and it is a particle. A node may be named twice.
bool has_liquid(const Release& r, const Attachment& a, double particle_mass) {
  const std::vector<double>& there = a.motion.absorbed_mass;
  std::vector<std::pair<std::uint32_t, double>> nodes = r.nodes;
  std::stable_sort(nodes.begin(), nodes.end(), [](auto& x, auto& y) { return x.first < y.first; });
  double sum = 0, of_node = 0;
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const auto& [node, mass] = nodes[k];
    if (node >= there.size() || !(mass >= 0)) return false;
    of_node = (k > 0 && nodes[k - 1].first == node ? of_node : 0) + mass;
    if (of_node > there[node]) return false;
    sum += mass;
  }
  return std::abs(sum - particle_mass) <= release_tolerance * particle_mass;
}

bool is_release(const Release& r, const ActiveSurfaces& active, double particle_mass) {
  return r.surface < active.size() && is_in_range(r.position) && is_in_range(r.from) &&
         has_liquid(r, *active.attachment[r.surface], particle_mass);
}

/// The velocity of what the nodes give together.
Vec3 velocity_of(const Release& r, const SurfaceMotion& m) {
  Vec3 momentum = Vec3::Zero();
  double mass = 0;
  for (const auto& [node, part] : r.nodes) {
    momentum += part * m.velocity[node];
    mass += part;
  }
  return momentum / mass;
}

}  // namespace

void absorb(Attachment& a, std::uint32_t node, double mass, const Vec3& u) {
  LiquidChange& c = change_of(a);
  a.motion.absorbed_mass[node] += mass;
  c.mass[node] += mass;
  c.momentum[node] += mass * u;
}

void transport(Attachment& a, std::uint32_t from, std::uint32_t to, double mass) {
  LiquidChange& c = change_of(a);
  const double passed = std::min(mass, a.motion.absorbed_mass[from]);
  a.motion.absorbed_mass[from] -= passed;
  a.motion.absorbed_mass[to] += passed;
  c.passages.push_back({from, to, passed});
}

double take(Attachment& a, std::uint32_t node, double mass) {
  change_of(a);
  double& there = a.motion.absorbed_mass[node];
  const double taken = std::min(mass, there);
  there -= taken;
  return taken;
}

double absorbed_mass(const Attachment& a) {
  return std::accumulate(a.motion.absorbed_mass.begin(), a.motion.absorbed_mass.end(), 0.0);
}

void release_particles(Span<const Release> releases, const ActiveSurfaces& active, const WorldSettings& world,
                       double spacing, double rest_density, double particle_mass, const Workers& workers,
                       fluid::Particles& particles, std::uint64_t& next_id, Ledger& ledger) {
  if (releases.empty()) return;
  std::vector<Vec3> places;
  for (const Release& r : releases) places.push_back(r.position);
  const std::vector<std::uint8_t> blocked = find_blocked_points(active.at_end(), places, workers);
  PointCells taken = particles_near(particles, places, free_distance * spacing);
  for (std::size_t k = 0; k < releases.size(); ++k) {
    const Release& r = releases[k];
    if (blocked[k] || !is_release(r, active, particle_mass) || !world.kill_box.contains(r.position) ||
        particles.size() >= particle_limit(world) || taken.has_near(r.position) ||
        !is_way_free(active, r.from, r.position))
      continue;
    Attachment& a = *active.attachment[r.surface];
    const Vec3 velocity = velocity_of(r, a.motion);
    double sum = 0;
    for (const auto& [node, mass] : r.nodes) sum += take(a, node, mass);
    OILSKIN_ASSERT(std::abs(sum - particle_mass) <= 2 * release_tolerance * particle_mass);
    taken.add(particles.size(), r.position);
    particles.push_back(next_id++, r.position, velocity, rest_density);
    ledger.released(velocity);
  }
}

std::vector<Vec3> add_momentum_of_liquid(Attachment& a, SurfaceMotion& m) {
  LiquidChange& c = a.liquid_change;
  if (c.mass.size() != m.x_t1.size()) return {};
  std::vector<Vec3> arrived(c.mass.size());  // momentum relative to the node
  for (std::size_t i = 0; i < arrived.size(); ++i) arrived[i] = c.momentum[i] - c.mass[i] * m.velocity[i];
  for (const Passage& p : c.passages) arrived[p.to] += p.mass * (m.velocity[p.from] - m.velocity[p.to]);
  std::vector<Vec3> impulse = m.impulse;
  for (std::size_t i = 0; i < arrived.size(); ++i) {
    if (m.inverse_mass[i] == 0 || arrived[i].isZero(0)) continue;
    const double own = own_mass(m, i);
    const double dry = own - c.before[i];  // ≤ 0: the host does not weigh what its nodes hold
    const Vec3 dv = arrived[i] / (dry > 0 ? own + a.motion.absorbed_mass[i] - c.before[i] : own);
    m.velocity[i] += dv;
    m.add_impulse(static_cast<std::uint32_t>(i), dv / m.inverse_mass[i]);
  }
  std::sort(m.touched.begin(), m.touched.end());
  c = {};
  return impulse;
}

}  // namespace oilskin::world
