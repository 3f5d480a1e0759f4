#include "fluid/boundary/wall_bodies.h"

#include <algorithm>
#include <cmath>

#include "core/assert.h"
#include "core/unit_vector.h"

namespace oilskin::fluid {

namespace {

constexpr std::uint32_t none = UINT32_MAX;
constexpr std::size_t coupling_chunk = 256;

}  // namespace

void WallBodies::build(const WallGeometry& geometry, Span<SurfaceMotion* const> surfaces,
                       const LoadMemory& memory, double passed, double dt, double particle_mass,
                       const Workers& workers) {
  mass_ = particle_mass;
  bodies_.clear();
  couplings_.clear();
  add_bodies(surfaces, memory, passed, dt);
  if (empty()) return;
  couple(geometry, surfaces);
  const std::vector<float> at_rest(geometry.points().size());
  predict(at_rest, at_rest, workers);
}

void WallBodies::add_bodies(Span<SurfaceMotion* const> surfaces, const LoadMemory& memory, double passed,
                            double dt) {
  of_surface_.assign(surfaces.size(), none);
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    if (!surfaces[s]->body) continue;
    of_surface_[s] = static_cast<std::uint32_t>(bodies_.size());
    const BodyMotion& b = *surfaces[s]->body;
    Body body{b.inverse_mass, b.inverse_inertia, {}, Vec3::Zero(), 1, {}};
    const LoadMemory::OfBody carried = memory.carried_of_body(*surfaces[s], passed, dt);
    body.before = body.velocity_from({b.impulse - carried.impulse, b.angular_impulse - carried.moment});
    body.before.linear += (b.inverse_mass.array() > 0).select(passed * b.gravity, Vec3::Zero());
    body.down = unit_or_zero(b.gravity);
    body.yields = std::sqrt(1 - carried.firmness);
    body.before.linear = body.yielding(body.yielding(body.before.linear));
    bodies_.push_back(std::move(body));
  }
}

void WallBodies::couple(const WallGeometry& geometry, Span<SurfaceMotion* const> surfaces) {
  const std::vector<WallPoint>& points = geometry.points();
  begin_.assign(1, 0);
  for (std::uint32_t k = 0; k < points.size(); ++k) {
    const std::size_t first = couplings_.size();
    for (std::uint32_t w = points[k].begin; w < points[k].end; ++w) {
      const Wall& wall = geometry.walls()[w];
      const std::uint32_t body = of_surface_[wall.surface];
      if (body == none) continue;
      const SurfaceMotion& s = *surfaces[wall.surface];
      Vec3 arm = -s.body->center_t0;
      for (int c = 0; c < 3; ++c)
        arm += wall.share(c) * s.x_t0[s.triangles[wall.triangle][static_cast<std::size_t>(c)]];
      auto at = std::find_if(couplings_.begin() + static_cast<std::ptrdiff_t>(first), couplings_.end(),
                             [body](const Coupling& c) { return c.body == body; });
      if (at == couplings_.end()) at = couplings_.insert(at, {k, body, {}, {}});
      const Vec3 gamma = wall.gamma.cast<double>();
      const Wrench g{gamma, arm.cross(gamma)};
      at->gamma += g;
      at->depth_gamma += g.times(static_cast<double>(wall.depth));
    }
    for (std::size_t c = first; c < couplings_.size(); ++c)
      bodies_[couplings_[c].body].couplings.push_back(static_cast<std::uint32_t>(c));
    begin_.push_back(static_cast<std::uint32_t>(couplings_.size()));
  }
  velocity_.assign(bodies_.size(), {});
}

/// m Σ_k (θ_k g_k + depth_k Σ_T d_T g_T): what the particles get from the body [N s].
Wrench WallBodies::sum_over(const Body& body, const std::vector<float>& theta,
                            const std::vector<float>* depth, const Workers& workers) const {
  const auto sum = [&](std::size_t begin, std::size_t end) {
    Wrench part;
    for (std::size_t i = begin; i < end; ++i) {
      const Coupling& c = couplings_[body.couplings[i]];
      part += c.gamma.times(static_cast<double>(theta[c.point]));
      if (depth) part += c.depth_gamma.times(static_cast<double>((*depth)[c.point]));
    }
    return part;
  };
  return workers.ordered_sum(body.couplings.size(), coupling_chunk, Wrench(), sum).times(mass_);
}

void WallBodies::predict(const std::vector<float>& theta, const std::vector<float>& depth,
                         const Workers& workers) {
  OILSKIN_ASSERT(theta.size() + 1 == begin_.size() && depth.size() == theta.size());
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    velocity_[b] = bodies_[b].velocity_from(sum_over(bodies_[b], theta, &depth, workers).times(-1));
    velocity_[b] += bodies_[b].before;
  }
}

void WallBodies::respond(const std::vector<float>& theta, const Workers& workers) {
  for (std::size_t b = 0; b < bodies_.size(); ++b)
    velocity_[b] = bodies_[b].velocity_from(sum_over(bodies_[b], theta, nullptr, workers));
}

float WallBodies::flux_at(std::size_t point) const {
  double flux = 0;
  for (std::uint32_t c = begin_[point]; c < begin_[point + 1]; ++c)
    flux += couplings_[c].gamma.dot(velocity_[couplings_[c].body]);
  return static_cast<float>(flux);
}

/// |g_k·M⁻¹ g_l| is at most the product of the lengths of g_k and g_l in the metric M⁻¹.
void WallBodies::add_row_sums(std::vector<float>& rows) const {
  for (const Body& body : bodies_) {
    double sum = 0;
    std::vector<double> length;
    for (std::uint32_t c : body.couplings) {
      const Wrench& g = couplings_[c].gamma;
      length.push_back(std::sqrt(std::max(0.0, g.dot(body.velocity_from(g)))));
      sum += length.back();
    }
    for (std::size_t i = 0; i < length.size(); ++i)
      rows[couplings_[body.couplings[i]].point] += static_cast<float>(mass_ * length[i] * sum);
  }
}

}  // namespace oilskin::fluid
