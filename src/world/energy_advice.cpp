/// What avoids energy that a step made, with numbers.
#include <cmath>
#include <optional>
#include <sstream>

#include "core/inverse_mass.h"
#include "world/world_impl.h"

namespace oilskin {

namespace {

constexpr double frame = 1.0 / 60;  // [s]

/// A frame of a program for graphics has no time for more.
constexpr double most_steps = 100;

/// What a surface took in a step.
struct Load {
  std::size_t surface = 0;
  double mass = 0;          ///< of its free nodes [kg]
  double touched_mass = 0;  ///< of those that got an impulse
  double impulse = 0;       ///< [N s]
  /// The speed that the load gives to the nodes before their host responds, p dt/σ [m/s].
  double kick() const { return touched_mass > 0 ? impulse / touched_mass : 0; }
};

Load load_on(const SurfaceMotion& m) {
  Load load;
  Vec3 impulse = Vec3::Zero();
  for (std::size_t j = 0; j < m.impulse.size(); ++j) {
    if (m.inverse_mass[j] == 0) continue;
    const double own = own_mass(m, j);
    load.mass += own;
    if (m.impulse[j].isZero(0)) continue;
    load.touched_mass += own;
    impulse += m.impulse[j];
  }
  load.impulse = impulse.norm();
  return load;
}

/// Two digits, without an exponent up to a million.
std::string rounded(double value) {
  std::ostringstream s;
  if (value >= 99.5 && value < 1e6) {
    const double unit = std::pow(10, std::floor(std::log10(value)) - 1);
    s << std::round(value / unit) * unit;
  } else {
    s.precision(2);
    s << value;
  }
  return s.str();
}

std::string about_cloth(const Load& load, double dt, double gravity, double max_kick) {
  const double ratio = load.kick() / max_kick;
  std::ostringstream s;
  s << "the cloth (surface " << load.surface + 1 << ") ";
  if (gravity > 0) s << "carries " << rounded(load.kick() / (gravity * dt)) << " × its mass";
  if (!(gravity > 0)) s << "takes " << rounded(load.kick()) << " m/s a step";
  s << " at " << rounded(1e3 * dt) << " ms: ";
  const double steps = std::ceil(frame / (dt / ratio));
  if (steps <= most_steps)
    s << steps << " steps a frame of 1/60 s, or ≥ " << rounded(load.mass * ratio) << " kg";
  else
    s << "this is an impact that no usual step resolves; less speed or water at once, or more mass";
  return s.str();
}

std::string about_water(double distance, double dt, int substeps) {
  std::ostringstream s;
  if (distance > 1) {
    s << "the fastest water moves " << rounded(distance) << " × fluid.cfl spacings in an interval of "
      << rounded(1e3 * dt / substeps) << " ms: dt ≤ " << rounded(1e3 * dt / distance)
      << " ms, or fluid.max_substeps ≥ " << std::ceil(substeps * distance);
  } else {
    s << "the pressure of the water raised it in a step of " << rounded(1e3 * dt) << " ms: dt ≤ "
      << rounded(500 * dt) << " ms";
  }
  return s.str();
}

std::string about_thickness(std::size_t surface, double thickness, double spacing) {
  std::ostringstream s;
  s << "surface " << surface + 1 << " is " << rounded(1e3 * thickness)
    << " mm thick; with boundary terms half a spacing, " << rounded(500 * spacing)
    << " mm, is the most that keeps water at rest on it calm, at any dt";
  return s.str();
}

}  // namespace

/// The load of a step must not give cloth more than the speed of a fall through one spacing: water that
/// follows it would be a layer behind (F.63).
void World::Impl::advise_on_energy(world::StepContext& step) const {
  const EnergyReport& energy = step.report.energy;
  const double g = settings.gravity.norm(), spacing = fluid_settings.spacing;
  const double max_kick = g > 0 ? std::sqrt(g * spacing) : fluid_settings.cfl * spacing / step.dt;
  Load largest;
  std::optional<std::string> thick;
  for (std::size_t k = 0; k < step.surfaces.size(); ++k) {
    const SurfaceMotion& surface = *step.surfaces.motion[k];
    if (!thick && fluid_settings.boundary == BoundaryModel::mirrored && !surface.touched.empty() &&
        surface.thickness > 0.5 * spacing * (1 + 1e-6))
      thick = about_thickness(k, surface.thickness, spacing);
    Load load = load_on(*step.surfaces.motion[k]);
    load.surface = k;
    if (load.kick() > largest.kick()) largest = load;
  }
  const double interval = step.dt / step.report.substeps;
  const double distance = energy.max_speed * interval / (fluid_settings.cfl * spacing);
  step.report.flags |= flag_energy_made;
  std::string cause = about_water(distance, step.dt, step.report.substeps);
  if (largest.kick() > max_kick)
    cause = about_cloth(largest, step.dt, g, max_kick);
  else if (thick)
    cause = *thick;
  step.report.messages.push_back("energy made: " + cause);
}

}  // namespace oilskin
