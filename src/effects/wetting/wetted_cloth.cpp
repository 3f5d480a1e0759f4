#include "effects/wetting/wetted_cloth.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/assert.h"

namespace oilskin {

namespace {

/// Most drops of a surface in one call.
constexpr int max_drops = 256;

/// A sheet steeper than this (cosine between its normal and gravity) drips at its border.
constexpr double steep = 0.3;

double liquid_in(const SurfaceMotion& motion, std::size_t node) {
  return motion.absorbed_mass.empty() ? 0 : motion.absorbed_mass[node];
}

}  // namespace

WettedCloth::WettedCloth(const SurfaceMotion& motion, std::vector<Vec3> rest, const Fabric& fabric)
    : motion_id_(motion.id),
      fabric_(fabric),
      rest_(std::move(rest)),
      triangles_(motion.triangles),
      topology_(motion.triangles, rest_.size()),
      transport_(rest_, motion.triangles, fabric) {}

bool WettedCloth::is_for(const SurfaceMotion& motion, const std::vector<Vec3>& rest) const {
  return motion.id == motion_id_ && rest == rest_ && motion.triangles.size() == triangles_.size();
}

std::array<double, 3> WettedCloth::uptake(const SurfaceMotion& motion, const VisibleWall& wall, double dt,
                                          double absorption, double area, double mass, double least) const {
  double saturation = 0;
  std::array<double, 3> space{};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t node = wall.nodes[k];
    const double c = capacity()[node];
    if (!(c > 0)) continue;
    saturation += wall.weights[k] * liquid_in(motion, node) / c;
    space[k] = std::max(0.0, fabric_.saturation_limit * c - liquid_in(motion, node));
  }
  const double capacity_below =
      fabric_.capacity * area * std::max(0.0, fabric_.saturation_limit - saturation);
  const double wanted = std::min(mass, -capacity_below * std::expm1(-absorption * dt / fabric_.capacity));
  std::array<double, 3> given{};
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    given[k] = std::min(std::max(0.0, wall.weights[k]) * wanted, space[k]);
    sum += given[k];
  }
  if (sum > 0 && mass - sum < least)
    for (double& g : given) g *= mass / sum;
  return given;
}

void WettedCloth::dry(double dt, double rate, Span<const double> covered, std::size_t surface,
                      EffectExchange& e) const {
  const SurfaceMotion& motion = *e.surfaces[surface];
  OILSKIN_ASSERT(rate > 0 && covered.size() >= motion.absorbed_mass.size());
  for (std::uint32_t i = 0; i < motion.absorbed_mass.size(); ++i) {
    if (!(motion.absorbed_mass[i] > 0)) continue;
    const double both_sides = 2 * capacity()[i] / fabric_.capacity;
    const double open = both_sides > 0 ? std::max(0.0, 1 - covered[i] / both_sides) : 1;
    e.dry(surface, i, -std::expm1(-rate * open * dt) * motion.absorbed_mass[i]);
  }
}

/// The transport gives what each node has afterwards. Nodes that lost and nodes that gained are paired in
/// their order, so that the momentum of the liquid is kept: nodes of one row of a sheet have successive
/// numbers.
void WettedCloth::spread(double dt, std::size_t surface, EffectExchange& e) {
  const SurfaceMotion& motion = *e.surfaces[surface];
  if (motion.absorbed_mass.size() != rest_.size()) return;
  liquid_ = motion.absorbed_mass;
  const Status status = transport_.step(dt, motion.x_t1, e.gravity, liquid_);
  OILSKIN_ASSERT(status.ok());
  if (!status.ok()) return;
  std::vector<double> change(liquid_.size());
  for (std::size_t i = 0; i < change.size(); ++i) change[i] = liquid_[i] - motion.absorbed_mass[i];
  std::uint32_t from = 0, to = 0;
  const auto n = static_cast<std::uint32_t>(change.size());
  while (true) {
    while (from < n && !(change[from] < 0)) ++from;
    while (to < n && !(change[to] > 0)) ++to;
    if (from == n || to == n) return;
    const double mass = std::min(-change[from], change[to]);
    e.transport(surface, from, to, mass);
    change[from] += mass;
    change[to] -= mass;
  }
}

/// True if there is enough for a particle.
bool WettedCloth::gather_drops(double dt, double rate, const SurfaceMotion& motion, double enough,
                               Span<double> gathered) const {
  const double part = -std::expm1(-rate * dt);
  double sum = 0;
  for (std::size_t i = 0; i < gathered.size(); ++i) {
    const double excess = std::max(0.0, liquid_in(motion, i) - capacity()[i]);
    gathered[i] = std::min(excess, gathered[i] + part * std::max(0.0, excess - gathered[i]));
    sum += gathered[i];
  }
  return sum >= enough;
}

/// From the nodes around a site, the nearest over edges first, until there is enough. A particle may be as
/// much as many nodes hold; none where the part of the sheet has less.
std::vector<std::pair<std::uint32_t, double>> WettedCloth::collect(std::uint32_t site, double needed,
                                                                   Span<const double> gathered) const {
  std::vector<std::pair<std::uint32_t, double>> parts;
  std::vector<std::uint32_t> found = {site};
  std::vector<std::uint8_t> is_found(gathered.size(), 0);
  is_found[site] = 1;
  double missing = needed;
  for (std::size_t k = 0; k < found.size(); ++k) {
    const std::uint32_t node = found[k];
    const double part = std::min(gathered[node], missing);
    if (part > 0) parts.emplace_back(node, part);
    missing -= part;
    if (!(missing > 0)) return parts;
    for (const std::uint32_t t : topology_.triangles_of(node))
      for (const std::uint32_t other : triangles_[t]) {
        if (is_found[other]) continue;
        is_found[other] = 1;
        found.push_back(other);
      }
  }
  return {};
}

/// To the lower side; at the lower border of a steep sheet downwards.
Vec3 WettedCloth::direction_of_drop(const SurfaceMotion& motion, std::uint32_t node, const Vec3& down) const {
  Vec3 normal = Vec3::Zero(), outward = Vec3::Zero();
  double distance = 0;
  for (const std::uint32_t t : topology_.triangles_of(node)) {
    const Triangle& nodes = triangles_[t];
    const Vec3 &a = motion.x_t1[nodes[0]], &b = motion.x_t1[nodes[1]], &c = motion.x_t1[nodes[2]];
    const Vec3 from_middle = motion.x_t1[node] - (a + b + c) / 3;
    normal += (b - a).cross(c - a);
    outward += from_middle;
    distance += from_middle.norm();
  }
  normal.normalize();
  const bool is_lower_border = outward.dot(down) > steep * distance;
  if (std::abs(normal.dot(down)) < steep && is_lower_border) return down;
  return normal.dot(down) < 0 ? Vec3(-normal) : normal;
}

void WettedCloth::drip(double dt, double rate, std::size_t surface, Span<double> gathered,
                       EffectExchange& e) const {
  const SurfaceMotion& motion = *e.surfaces[surface];
  if (e.gravity.isZero(0)) return;  // a film that nothing pulls off
  if (!gather_drops(dt, rate, motion, e.particle_mass, gathered)) return;
  const Vec3 down = e.gravity.stableNormalized();
  std::vector<std::uint32_t> sites;
  for (std::uint32_t i = 0; i < gathered.size(); ++i)
    if (gathered[i] > 0) sites.push_back(i);
  std::stable_sort(sites.begin(), sites.end(), [&](std::uint32_t a, std::uint32_t b) {
    return down.dot(motion.x_t1[a]) > down.dot(motion.x_t1[b]);
  });
  const double away = std::max(motion.thickness, 0.5 * e.spacing) + 2 * motion.delta;
  int drops = 0;
  double left = std::accumulate(gathered.begin(), gathered.end(), 0.0);
  for (const std::uint32_t site : sites) {
    if (left < e.particle_mass || drops == max_drops) return;
    if (!(gathered[site] > 0)) continue;
    Release drop;
    drop.nodes = collect(site, e.particle_mass, gathered);
    if (drop.nodes.empty()) continue;
    const Vec3 direction = direction_of_drop(motion, site, down);
    drop.surface = surface;
    drop.from = motion.x_t1[site] + 2 * motion.delta * direction;
    drop.position = motion.x_t1[site] + away * direction;
    // If the place is not free the drop gathers anew: that is how it waits.
    for (const auto& [node, part] : drop.nodes) gathered[node] -= part;
    e.release(drop);
    left -= e.particle_mass;
    ++drops;
  }
}

}  // namespace oilskin
