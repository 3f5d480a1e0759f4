#include "fluid/emission/source.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "core/assert.h"
#include "core/refuse.h"
#include "fluid/emission/random.h"

namespace oilskin::fluid {

namespace {

/// Each coordinate uniform between ± `amplitude` (F.71).
Vec3 random_vector(std::uint64_t seed, std::uint64_t counter, double amplitude) {
  const auto coordinate = [&](std::uint64_t k) {
    return amplitude * (2 * random_unit(seed, 3 * counter + k) - 1);
  };
  return {coordinate(0), coordinate(1), coordinate(2)};
}

/// Where a particle at x is carried by the field in a unit of time: eight steps of Runge and Kutta (F.71).
/// The flow of a field without divergence keeps volumes, which x + u(x) does not.
Vec3 carried(const VectorField& u, Vec3 x) {
  constexpr int steps = 8;
  constexpr double h = 1.0 / steps;
  for (int k = 0; k < steps; ++k) {
    const Vec3 a = u(x), b = u(x + 0.5 * h * a), c = u(x + 0.5 * h * b), d = u(x + h * c);
    x += h / 6 * (a + 2 * b + 2 * c + d);
  }
  return x;
}

void visit(Archive& archive, RainEmitter& emitter) {
  auto& [corner, edge_u, edge_v, drops_per_second, drop_radius, velocity, start, stop, seed] = emitter;
  archive.values(corner, edge_u, edge_v, drops_per_second, drop_radius, velocity, start, stop, seed);
}

bool all_finite(const std::vector<Vec3>& values) {
  return std::all_of(values.begin(), values.end(), [](const Vec3& x) { return x.allFinite(); });
}

}  // namespace

double Source::time_of(std::uint64_t k) const {
  // A drop starts at a random time within its period, so that several emitters are not synchronous.
  const double phase = kind == Kind::rain ? random_unit(rain.seed, 3 * k + 2) : 0;
  return start + (static_cast<double>(k) + phase) * period;
}

Vec3 Source::place_of(std::size_t site) const {
  OILSKIN_ASSERT(site < sites.size());
  if (kind == Kind::rain) {
    const Vec3 center = rain.corner + random_unit(rain.seed, 3 * next) * rain.edge_u +
                        random_unit(rain.seed, 3 * next + 1) * rain.edge_v;
    return center + sites[site];
  }
  if (shake == 0) return sites[site];
  return sites[site] + random_vector(seed, next * sites.size() + site, shake);
}

void Source::set_velocity(const Vec3& v) {
  velocity = v;
  fastest = v.norm();
}

Status check_shake(const char* field, double shake) {
  return shake >= 0 && shake <= 0.25 ? Status{}
                                     : refuse_value(field, shake, "0 … 0.25 spacings of the fluid");
}

Status place(const char* emitter, const Vec3& velocity, const InitialState& initial, double spacing,
             Source& source) {
  Status status = check_shake((std::string(emitter) + ": initial.shake").c_str(), initial.shake);
  if (!status.ok()) return status;
  source.set_velocity(velocity);
  for (std::size_t k = 0; k < source.sites.size(); ++k) {
    Vec3& x = source.sites[k];
    if (initial.displacement) x = carried(initial.displacement, x);
    if (initial.shake > 0) x += random_vector(initial.seed, k, initial.shake * spacing);
    if (initial.velocity) source.velocities.push_back(velocity + initial.velocity(x));
    if (!x.allFinite() || (initial.velocity && !source.velocities.back().allFinite())) {
      return refuse(emitter, ": initial: particle ", k, " starts at ", x.transpose(),
                    " m; place and velocity must be "
                    "finite");
    }
    if (initial.velocity) source.fastest = std::max(source.fastest, source.velocities.back().norm());
  }
  return {};
}

void visit(Archive& archive, Source& source) {
  auto& [kind, sites, velocities, velocity, fastest, start, stop, period, shake, seed, rain, begun, next,
         waiting] = source;
  archive.values(kind, sites, velocities, velocity, fastest, start, stop, period, shake, seed);
  visit(archive, rain);
  archive.values(begun, next, waiting);
}

bool is_in_range(const Source& s, double time) {
  if (!s.velocity.allFinite() || !std::isfinite(s.start) || std::isnan(s.stop)) return false;
  if (!(s.fastest >= 0) || !std::isfinite(s.shake)) return false;
  if (!all_finite(s.sites) || !all_finite(s.velocities)) return false;
  if (!s.velocities.empty() && s.velocities.size() != s.sites.size()) return false;
  if (s.kind == Source::Kind::volume) return s.waiting.empty();
  if (s.kind != Source::Kind::nozzle && s.kind != Source::Kind::rain) return false;
  if (s.waiting.size() != (s.kind == Source::Kind::nozzle ? s.sites.size() : 0)) return false;
  if (!s.rain.corner.allFinite() || !s.rain.edge_u.allFinite() || !s.rain.edge_v.allFinite()) return false;
  if (!(s.start >= 0 && s.stop > s.start && s.period >= min_period && std::isfinite(s.period))) return false;
  const double due = (std::min(time, s.stop) - s.start) / s.period;
  return due < 0x1p53 && (!s.begun || static_cast<double>(s.next) >= due - 2);
}

}  // namespace oilskin::fluid
