#include "fluid/boundary/boundary.h"

#include <algorithm>

#include "core/assert.h"
#include "core/body_motion.h"
#include "core/chunks.h"

namespace oilskin::fluid {

namespace {

constexpr std::size_t smallest_chunk = 64;

double mass_of(Span<const float> ratio, std::uint32_t particle, double mass) {
  return ratio.empty() ? mass : mass * static_cast<double>(ratio[particle]);
}

}  // namespace

void Boundary::clear() {
  geometry_.clear();
  nodes_.clear();
  wall_impulses_.clear();
  body_impulses_.clear();
}

void Boundary::find(const BoundaryInput& input, const Workers& workers) {
  OILSKIN_ASSERT(input.dt > 0 && input.particle_mass > 0 && input.support_radius > 0);
  mass_ = input.particle_mass;
  surfaces_.assign(input.surfaces.begin(), input.surfaces.end());
  memory_.prepare(input.surfaces);
  nodes_.clear();
  geometry_.find(input, workers);
  if (empty()) return;
  nodes_.number(geometry_.walls(), input.surfaces, workers);
  compliance_.bodies().build(geometry_, input.surfaces, memory_, input.passed, input.dt, mass_, workers);
  compliance_.build(geometry_, nodes_, node_motion(input.dt, workers), mass_, workers);
}

std::vector<WallNodeMotion> Boundary::node_motion(double dt, const Workers& workers) const {
  std::vector<WallNodeMotion> motion(nodes_.size());
  for_each_evenly(workers, nodes_.size(), smallest_chunk, [&](std::size_t n) {
    const std::uint32_t i = nodes_[n].node;
    const SurfaceMotion& s = *surfaces_[nodes_[n].surface];
    motion[n].inverse_mass = static_cast<float>(s.inverse_mass[i]);
    motion[n].velocity = ((s.x_t1[i] - s.x_t0[i]) / dt).cast<float>();
    if (motion[n].inverse_mass > 0) motion[n].carried = memory_.carried_impulse(s.id, i, dt).cast<float>();
  });
  return motion;
}

void Boundary::apply_load(const std::vector<WallLoad<double>>& load, Span<const float> mass_ratio,
                          std::vector<Vec3>& dv, const Workers& workers) {
  OILSKIN_ASSERT(load.size() == points().size() && geometry_.point_of().size() == dv.size());
  const std::vector<Wall>& walls = geometry_.walls();
  for_each_evenly(workers, points().size(), smallest_chunk, [&](std::size_t k) {
    const WallPoint& point = points()[k];
    Vec3 sum = Vec3::Zero();
    for (std::uint32_t w = point.begin; w < point.end; ++w)
      sum += load[k].on(walls[w].depth) * walls[w].gamma.cast<double>();
    dv[point.particle] += sum;
  });
  std::vector<Vec3> of_body(compliance_.bodies().empty() ? 0 : nodes_.size(), Vec3::Zero());
  for_each_evenly(workers, nodes_.size(), smallest_chunk, [&](std::size_t n) {
    Vec3 impulse = Vec3::Zero();
    for (const WallNodes::Corner& c : nodes_.corners_of(n)) {
      const Wall& wall = walls[c.wall];
      const double mass = mass_of(mass_ratio, points()[wall.point].particle, mass_);
      impulse -= mass * load[wall.point].on(wall.depth) * wall.share(c.corner) * wall.gamma.cast<double>();
    }
    SurfaceMotion& s = *surfaces_[nodes_[n].surface];
    if (s.body) of_body[n] = impulse;
    s.velocity[nodes_[n].node] += s.inverse_mass[nodes_[n].node] * impulse;
    s.impulse[nodes_[n].node] += impulse;
  });
  for (std::size_t n = 0; n < nodes_.size(); ++n)
    surfaces_[nodes_[n].surface]->touched.push_back(nodes_[n].node);
  push_bodies(of_body);
  record_wall_impulses(load, mass_ratio);
  record_body_impulses(load, mass_ratio);
}

/// `impulse` per node; empty = there is no body.
void Boundary::push_bodies(const std::vector<Vec3>& impulse) {
  if (impulse.empty()) return;
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    SurfaceMotion& s = *surfaces_[nodes_[n].surface];
    if (s.body) push_body(*s.body, s.x_t0[nodes_[n].node] - s.body->center_t0, impulse[n]);
  }
  for (SurfaceMotion* s : surfaces_) set_node_velocities(*s);
}

WallImpulse Boundary::wall_impulse(const Wall& wall, const std::vector<WallLoad<double>>& load,
                                   Span<const float> mass_ratio) const {
  const double theta = load[wall.point].on(wall.depth);
  WallImpulse w;
  w.particle = points()[wall.point].particle;
  w.surface = wall.surface;
  w.triangle = wall.triangle;
  w.weights = {wall.share(0), wall.share(1), wall.share(2)};
  w.normal = wall.gamma.cast<double>();
  w.impulse = mass_of(mass_ratio, w.particle, mass_) * std::max(theta, 0.0) * w.normal.norm();
  return w;
}

/// Dry friction is bounded by them, or needs to know the first layer (docs/theory/boundary.md 10).
void Boundary::record_wall_impulses(const std::vector<WallLoad<double>>& load, Span<const float> mass_ratio) {
  wall_impulses_.clear();
  if (std::none_of(surfaces_.begin(), surfaces_.end(), [](auto* s) { return s->has_dry_friction(); })) return;
  for (const Wall& wall : geometry_.walls())
    if (surfaces_[wall.surface]->has_dry_friction())
      wall_impulses_.push_back(wall_impulse(wall, load, mass_ratio));
}

/// Gaps have what they leave (B.46).
void Boundary::record_body_impulses(const std::vector<WallLoad<double>>& load, Span<const float> mass_ratio) {
  body_impulses_.clear();
  if (compliance_.bodies().empty()) return;
  for (const Wall& wall : geometry_.walls())
    if (const SurfaceMotion& s = *surfaces_[wall.surface]; s.body && s.solid)
      body_impulses_.push_back(wall_impulse(wall, load, mass_ratio));
}

}  // namespace oilskin::fluid
