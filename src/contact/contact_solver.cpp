#include "oilskin/contact.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "contact/contact_pass.h"
#include "contact/verify.h"
#include "core/assert.h"
#include "core/body_motion.h"
#include "core/inverse_mass.h"
#include "core/refuse.h"

namespace oilskin {

struct ContactSolver::Impl {
  ContactSettings settings;
  Workers workers;
  std::map<std::uint64_t, contact::SurfaceGeometry> geometry;  // by surface id
  contact::ContactBuffers buffers;
  std::vector<Contact> contacts;

  Impl(const ContactSettings& s, int threads) : settings(s), workers(threads) {}
};

ContactSolver::ContactSolver(const ContactSettings& settings, int threads)
    : impl_(std::make_unique<Impl>(settings, threads)) {}
ContactSolver::~ContactSolver() = default;
ContactSolver::ContactSolver(ContactSolver&&) noexcept = default;
ContactSolver& ContactSolver::operator=(ContactSolver&&) noexcept = default;

const ContactSettings& ContactSolver::settings() const {
  return impl_->settings;
}

Status ContactSolver::set_settings(const ContactSettings& settings) {
  Status status = settings.validate();
  if (status.ok()) impl_->settings = settings;
  return status;
}

namespace {

Status check_finite(const char* name, Span<const Vec3> values) {
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!(values[i].array().abs() < 1e15).all())
      return refuse(name, "[", i, "] is not finite, or beyond 1e15");
  return {};
}

Status check_particles(const ParticleMotion& p) {
  const std::size_t n = p.id.size();
  if (p.x_t0.size() != n || p.x_t1.size() != n || p.velocity.size() != n || p.inverse_mass.size() != n ||
      p.removed.size() != n)
    return refuse("the arrays of the particles differ in length; each must have ", n, " entries, as id has");
  if (!(p.spacing > 0 && p.spacing < 1e15))
    return refuse("the spacing of the particles is ", p.spacing, "; it must be > 0 and < 1e15 m");
  if (!(p.rest_density >= 0 && p.rest_density < 1e15))
    return refuse("the rest density is ", p.rest_density, "; it must be ≥ 0 and < 1e15 kg/m³");
  if (!(p.viscosity >= 0 && p.viscosity < 1e15))
    return refuse("the viscosity is ", p.viscosity, "; it must be ≥ 0 and < 1e15 m²/s");
  for (const auto& [name, values] : {std::pair<const char*, Span<const Vec3>>{"particle x_t0", p.x_t0},
                                     {"particle x_t1", Span<const Vec3>(p.x_t1)},
                                     {"particle velocity", Span<const Vec3>(p.velocity)}})
    if (Status s = check_finite(name, values); !s.ok()) return s;
  for (std::size_t i = 0; i < n; ++i)
    if (!is_inverse_mass(p.inverse_mass[i]))
      return refuse("particle inverse_mass[", i, "] is ", p.inverse_mass[i], "; it must be ",
                    inverse_mass_range);
  return {};
}

Status check_settings(const SurfaceMotion& s) {
  SurfaceSettings settings;
  settings.thickness = s.thickness;
  settings.slip = s.slip;
  settings.slip_back = s.slip_back;
  const Status status = settings.validate();
  return status.ok() ? status : refuse("surface ", s.id, ": ", status.message);
}

Status check_surface(const SurfaceMotion& s) {
  const std::size_t n = s.x_t0.size();
  if (s.id == 0) return refuse("a surface has id 0; ids begin at 1");
  if (s.x_t1.size() != n || s.velocity.size() != n || s.inverse_mass.size() != n)
    return refuse("the arrays of surface ", s.id, " differ in length; each must have ", n,
                  " entries, as x_t0 has");
  if (!s.holdable.empty() && s.holdable.size() != n)
    return refuse("holdable of surface ", s.id, " has ", s.holdable.size(), " entries; it must have ", n,
                  " or none");
  if (s.triangles.empty()) return refuse("surface ", s.id, " has no triangles");
  for (std::size_t t = 0; t < s.triangles.size(); ++t)
    for (std::uint32_t v : s.triangles[t])
      if (v >= n)
        return refuse("triangle ", t, " of surface ", s.id, " has the node index ", v, "; there are ", n,
                      " nodes");
  if (!(s.delta > 0) || !(s.thickness >= 4 * s.delta))
    return refuse("surface ", s.id, " has thickness ", s.thickness, " and delta ", s.delta,
                  "; it must hold that thickness ≥ 4 delta > 0");
  for (const auto& [name, values] : {std::pair<const char*, Span<const Vec3>>{"surface x_t0", s.x_t0},
                                     {"surface x_t1", s.x_t1},
                                     {"surface velocity", s.velocity}})
    if (Status status = check_finite(name, values); !status.ok()) return status;
  for (std::size_t i = 0; i < n; ++i)
    if (!is_inverse_mass(s.inverse_mass[i]))
      return refuse("surface inverse_mass[", i, "] is ", s.inverse_mass[i], "; it must be ",
                    inverse_mass_range);
  const Status body = check_body(s);
  return body.ok() ? body : refuse("surface ", s.id, ": ", body.message);
}

Status check_surfaces(Span<SurfaceMotion* const> surfaces) {
  std::vector<std::uint64_t> ids;
  for (const SurfaceMotion* s : surfaces) {
    if (!s) return refuse("surface ", ids.size(), " is a null pointer");
    if (Status status = check_surface(*s); !status.ok()) return status;
    if (Status status = check_settings(*s); !status.ok()) return status;
    ids.push_back(s->id);
  }
  std::sort(ids.begin(), ids.end());
  const auto repeated = std::adjacent_find(ids.begin(), ids.end());
  if (repeated != ids.end()) return refuse("two surfaces have the id ", *repeated, "; ids must differ");
  return {};
}

}  // namespace

Status ContactSolver::resolve(double dt, ParticleMotion& particles, Span<SurfaceMotion* const> surfaces,
                              ContactReport& report, StageSeconds& seconds) {
  if (!(dt > 0) || !std::isfinite(dt)) return refuse("dt is ", dt, "; it must be finite and > 0 s");
  if (Status s = impl_->settings.validate(); !s.ok()) return s;
  if (Status s = check_particles(particles); !s.ok()) return s;
  if (Status s = check_surfaces(surfaces); !s.ok()) return s;
  report = {};
  std::fill(particles.removed.begin(), particles.removed.end(), std::uint8_t{0});
  std::vector<contact::SurfaceGeometry*> geometry;
  for (SurfaceMotion* s : surfaces) {
    s->still = 0;
    geometry.push_back(&impl_->geometry[s->id]);
    geometry.back()->analyse(*s);
  }
  contact::ContactPass pass(dt, impl_->settings, impl_->workers, particles, surfaces, geometry,
                            impl_->buffers, report, seconds);
  pass.find();
  pass.solve();
  impl_->contacts = pass.take_contacts();
  OILSKIN_ASSERT(static_cast<std::uint64_t>(
                     std::count(particles.removed.begin(), particles.removed.end(), 1)) == report.removed);
  if (impl_->settings.verify) {
    StageTimer timer(seconds.verify);
    report.crossings_found_by_verify =
        contact::count_crossings(particles, surfaces, impl_->workers, &report.verified_pairs);
  }
  return {};
}

const std::vector<Contact>& ContactSolver::contacts() const {
  return impl_->contacts;
}

void ContactSolver::forget(std::uint64_t surface_id) {
  impl_->geometry.erase(surface_id);
}

}  // namespace oilskin
