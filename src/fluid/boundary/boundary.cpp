#include "fluid/boundary/boundary.h"

#include "core/assert.h"

namespace oilskin::fluid {

namespace {

constexpr std::size_t point_chunk = 256;

}  // namespace

void Boundary::clear() {
  geometry_.clear();
  nodes_.clear();
}

void Boundary::find(const BoundaryInput& input, const Workers& workers) {
  OILSKIN_ASSERT(input.dt > 0 && input.particle_mass > 0 && input.support_radius > 0);
  OILSKIN_ASSERT(input.neighbours.size() == input.x.size());
  mass_ = input.particle_mass;
  surfaces_.assign(input.surfaces.begin(), input.surfaces.end());
  memory_.prepare(input.surfaces);
  nodes_.clear();
  geometry_.find(input, workers);
  if (empty()) return;
  nodes_.number(geometry_.walls(), input.surfaces);
  compliance_.build(geometry_, nodes_, node_motion(input.dt), mass_, workers);
}

std::vector<WallNodeMotion> Boundary::node_motion(double dt) const {
  std::vector<WallNodeMotion> motion(nodes_.size());
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    const std::uint32_t i = nodes_[n].node;
    const SurfaceMotion& s = *surfaces_[nodes_[n].surface];
    motion[n].inverse_mass = static_cast<float>(s.inverse_mass[i]);
    motion[n].velocity = ((s.x_t1[i] - s.x_t0[i]) / dt).cast<float>();
    if (motion[n].inverse_mass > 0) motion[n].carried = memory_.carried_impulse(s.id, i, dt).cast<float>();
  }
  return motion;
}

void Boundary::apply_load(const std::vector<WallLoad<double>>& load, std::vector<Vec3>& dv,
                          const Workers& workers) {
  OILSKIN_ASSERT(load.size() == points().size() && geometry_.point_of().size() == dv.size());
  const std::vector<Wall>& walls = geometry_.walls();
  workers.for_each(points().size(), point_chunk, [&](std::size_t k) {
    const WallPoint& point = points()[k];
    Vec3 sum = Vec3::Zero();
    for (std::uint32_t w = point.begin; w < point.end; ++w)
      sum += load[k].on(walls[w].depth) * walls[w].gamma.cast<double>();
    dv[point.particle] += sum;
  });
  workers.for_each(nodes_.size(), point_chunk, [&](std::size_t n) {
    Vec3 impulse = Vec3::Zero();
    for (const WallNodes::Corner& c : nodes_.corners_of(n)) {
      const Wall& wall = walls[c.wall];
      impulse -= mass_ * load[wall.point].on(wall.depth) * wall.share(c.corner) * wall.gamma.cast<double>();
    }
    SurfaceMotion& s = *surfaces_[nodes_[n].surface];
    s.velocity[nodes_[n].node] += s.inverse_mass[nodes_[n].node] * impulse;
    s.impulse[nodes_[n].node] += impulse;
  });
}

}  // namespace oilskin::fluid
