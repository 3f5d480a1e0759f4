#include "oilskin/implicit_viscosity.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "core/archive.h"
#include "core/refuse.h"
#include "effects/viscosity/viscous_system.h"

namespace oilskin {

using effects::ParticleMemory;
using effects::SupportMemory;
using effects::ViscousSystem;
using Vector = ViscousSystem::Vector;

/// Kept from interval to interval for its memory alone.
struct ImplicitViscosity::Workspace {
  ViscousSystem system;
  Vector x, r, z, p, drag;

  void guess(EffectForces& f);
  ImplicitViscosityReport solve(const ImplicitViscositySettings& settings);
  double energy_bound();
  void apply(EffectForces& f, double share);
};

namespace {

/// How far rounding may keep the residual above the tolerance, in units of it.
constexpr double rounding_margin = 16;

Status visit(Archive& archive, ImplicitViscositySettings& s) {
  archive.values(s.coefficient, s.tolerance, s.max_iterations);
  if (archive.reading() && archive.ok() && archive.left() > 0)
    archive.refuse("there are more bytes than settings");
  return archive.status();
}

bool all_finite(const Vector& x) {
  return std::all_of(x.begin(), x.end(), [](const Vec3& v) { return v.allFinite(); });
}

std::string of_unconverged(const ImplicitViscosityReport& report, const ImplicitViscositySettings& settings) {
  std::ostringstream s;
  s << "the residual is " << report.residual << " after " << report.iterations << " iterations, tolerance "
    << settings.tolerance << ": less viscosity acts. Raise viscosity.max_iterations, or lower dt";
  return s.str();
}

}  // namespace

Status ImplicitViscositySettings::validate() const {
  if (!(coefficient > 0 && coefficient <= 1e6))
    return refuse_value("viscosity.coefficient", coefficient, "> 0, to 1e6 m²/s");
  if (!within(tolerance, 1e-12, 0.1)) return refuse_value("viscosity.tolerance", tolerance, "1e-12 … 0.1");
  if (max_iterations < 1 || max_iterations > 10000)
    return refuse_value("viscosity.max_iterations", max_iterations, "1 … 10000");
  return {};
}

ImplicitViscosity::ImplicitViscosity(const ImplicitViscositySettings& settings)
    : settings_(settings), status_(settings.validate()), workspace_(std::make_unique<Workspace>()) {}

ImplicitViscosity::~ImplicitViscosity() = default;

std::vector<double> ImplicitViscosity::particle_values() const {
  return std::vector<double>(effects::ParticleMemory::channels, 0);
}

std::vector<double> ImplicitViscosity::node_values() const {
  return std::vector<double>(effects::SupportMemory::channels, 0);
}

Status ImplicitViscosity::set_settings(const ImplicitViscositySettings& settings) {
  Status status = settings.validate();
  if (!status.ok()) return status;
  settings_ = settings;
  status_ = {};
  return {};
}

std::vector<std::uint8_t> ImplicitViscosity::save() const {
  std::vector<std::uint8_t> bytes;
  Archive archive(bytes);
  ImplicitViscositySettings copy = settings_;
  static_cast<void>(visit(archive, copy).ok());
  return bytes;
}

Status ImplicitViscosity::restore(Span<const std::uint8_t> saved) {
  Archive archive(saved);
  ImplicitViscositySettings read;
  Status status = visit(archive, read);
  return status.ok() ? set_settings(read) : status;
}

/// v* and the change of the last interval.
void ImplicitViscosity::Workspace::guess(EffectForces& f) {
  x = system.start();
  const ParticleMemory memory(f);
  for (std::size_t i = 0; i < f.id.size(); ++i) x[i] += f.dt * memory.last_drag(i);
}

/// Preconditioned conjugate gradients for (V.3), from x on.
ImplicitViscosityReport ImplicitViscosity::Workspace::solve(const ImplicitViscositySettings& settings) {
  const std::size_t n = system.size();
  const double scale = system.scale(), rounding = rounding_margin * system.rounding();
  const double target = std::max(settings.tolerance * scale, rounding);
  system.drag(x, drag, true);
  r.resize(n);
  for (std::size_t i = 0; i < n; ++i) r[i] = system.start()[i] - x[i] - drag[i];
  system.precondition(r, z);
  p = z;
  double rz = system.dot(r, z), norm = std::sqrt(system.dot(r, r));
  ImplicitViscosityReport report;
  for (; norm > target && report.iterations < settings.max_iterations; ++report.iterations) {
    system.drag(p, drag, false);
    for (std::size_t i = 0; i < n; ++i) drag[i] += p[i];
    const double step = rz / system.dot(p, drag);
    for (std::size_t i = 0; i < n; ++i) {
      x[i] += step * p[i];
      r[i] -= step * drag[i];
    }
    norm = std::sqrt(system.dot(r, r));
    system.precondition(r, z);
    const double next = system.dot(r, z), conjugate = next / rz;
    rz = next;
    for (std::size_t i = 0; i < n; ++i) p[i] = z[i] + conjugate * p[i];
  }
  report.residual = scale > 0 ? norm / scale : 0;
  report.converged = norm <= target;
  return report;
}

/// The largest share of the forces of x that takes energy from the liquid and its surfaces (V.9). After it
/// `drag` holds those of x.
double ImplicitViscosity::Workspace::energy_bound() {
  system.drag(x, drag, true);
  const double square = system.dot(drag, drag);
  if (!(square > 0)) return 1;
  return std::clamp((system.dot(system.start(), drag) + system.work_of_walls(x)) / square, 0.0, 1.0);
}

void ImplicitViscosity::Workspace::apply(EffectForces& f, double share) {
  const ParticleMemory memory(f);
  f.for_each(f.id.size(), [&](std::size_t i) {
    const Vec3 acceleration = -share / f.dt * drag[i];
    f.acceleration[i] += acceleration;
    memory.record(i, acceleration);
  });
  system.react(x, drag, share);
}

void ImplicitViscosity::act(EffectForces& f) {
  report_ = {};
  if (!status_.ok() || f.id.empty()) return;
  Workspace& w = *workspace_;
  SupportMemory::learn(f);
  ParticleMemory(f).learn();
  w.system.build(f, settings_.coefficient);
  w.guess(f);
  report_ = w.solve(settings_);
  report_.applied = w.energy_bound();
  if (!all_finite(w.drag) || !all_finite(w.x)) {  // numbers beyond range: none acts, and the next starts anew
    w.drag.assign(w.drag.size(), Vec3::Zero());
    w.x = w.system.start();
    report_.converged = false;
    report_.applied = 0;
  }
  if (!report_.converged) f.message = of_unconverged(report_, settings_);
  w.apply(f, report_.applied);
}

}  // namespace oilskin
