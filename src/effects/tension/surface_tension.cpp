#include "oilskin/surface_tension.h"

#include <cmath>
#include <sstream>

#include "core/archive.h"
#include "core/refuse.h"
#include "effects/tension/rim.h"
#include "effects/tension/tension_model.h"

namespace oilskin {

using effects::LackKernel;
using effects::Rim;
using effects::SlopeKernel;

namespace {

double volume(const EffectForces& f, std::size_t i) {
  return f.mass(i) / f.rest_density;
}

double longest_stable(double coefficient, double rest_density, double spacing) {
  return effects::longest_interval * std::sqrt(rest_density * std::pow(spacing, 3) / coefficient);
}

/// σ, or what the interval is stable for (S.9).
double stable_coefficient(const EffectForces& f, double coefficient) {
  const double part = longest_stable(coefficient, f.rest_density, f.spacing) / f.dt;
  return part > 1 - 1e-9 ? coefficient : part * part * coefficient;
}

/// Below it drops boil (decision 0025).
constexpr double least_support_ratio = 2;

/// What the user should know of an interval in which `acts` of `wanted` acts [N/m].
std::string message_of(const EffectForces& f, double wanted, double acts) {
  std::ostringstream text;
  if (acts < wanted)
    text << "acts with " << acts << " N/m, which this interval is stable for, in place of " << wanted
         << ": use shorter steps, or more fluid.max_substeps";
  const double ratio = f.support_radius / f.spacing;
  if (ratio < (1 - 1e-9) * least_support_ratio)
    text << (acts < wanted ? "; " : "") << "drops boil at fluid.support_ratio " << ratio << ": use "
         << least_support_ratio;
  return text.str();
}

}  // namespace

Status SurfaceTensionSettings::validate() const {
  if (!(std::isfinite(coefficient) && coefficient > 0))
    return refuse_value("surface_tension.coefficient", coefficient, "finite and > 0 N/m");
  if (!within(contact_angle, 0, 180))
    return refuse_value("surface_tension.contact_angle", contact_angle, "0 … 180 degrees");
  return {};
}

SurfaceTension::SurfaceTension(const SurfaceTensionSettings& settings)
    : settings_(settings), status_(settings.validate()) {}

Status SurfaceTension::set_settings(const SurfaceTensionSettings& settings) {
  Status status = settings.validate();
  if (!status.ok()) return status;
  settings_ = settings;
  status_ = {};
  return {};
}

double SurfaceTension::longest_interval(const FluidSettings& fluid) const {
  if (!status_.ok()) return Effect::longest_interval(fluid);
  return longest_stable(settings_.coefficient, fluid.rest_density, fluid.spacing);
}

void SurfaceTension::act(EffectForces& f) {
  if (!status_.ok()) return;
  const double acts = stable_coefficient(f, settings_.coefficient);
  strength_ = effects::calibration * acts;
  const effects::WallParts of_wall = effects::wall_parts(settings_.contact_angle);
  wall_attraction_ = of_wall.attraction;
  wall_as_fluid_ = of_wall.fluid;
  lack_.resize(f.id.size());
  slope_.resize(f.id.size());
  f.for_each(f.id.size(), [&](std::size_t i) { find_border(f, i); });
  f.for_each(f.id.size(), [&](std::size_t i) { f.acceleration[i] += pair_acceleration(f, i); });
  act_with_walls(f);
  if (f.is_last) f.message = message_of(f, settings_.coefficient, acts);
}

/// d_i and g_i (S.1), (S.2). A wall counts as a part of the fluid that it would be, were it fluid.
void SurfaceTension::find_border(const EffectForces& f, std::size_t i) {
  const double h = f.support_radius;
  double mass = volume(f, i) * LackKernel::value(0);
  Vec3 slope = Vec3::Zero();
  for (std::uint32_t j : f.neighbours(i)) {
    const Vec3 d = (f.position[i] - f.position[j]) / h;
    const double q = d.norm(), v = volume(f, j);
    mass += v * LackKernel::value(q);
    slope += v * SlopeKernel::first(q) * d;
  }
  mass /= h * h * h;
  slope /= h * h * h;
  const auto add_plane = [&](double part, double distance, const Vec3& normal) {
    mass += part * LackKernel::half_space(distance / h);
    slope -= part * SlopeKernel::plane(distance / h) * normal;
  };
  const Rim rim(f, i);
  if (rim.part > 0) add_plane(rim.part * wall_as_fluid_, rim.distance, rim.normal);
  if (rim.part < 1)
    for (const VisibleWall& w : f.walls(i))
      add_plane((1 - rim.part) * wall_as_fluid_ * w.share, w.distance, w.normal);
  lack_[i] = std::max(0.0, 1 - mass);
  slope_[i] = slope;
}

/// (S.4) changes sign with the order of the pair.
Vec3 SurfaceTension::pair_acceleration(const EffectForces& f, std::size_t i) const {
  constexpr double of_lack = effects::energy_of_lack, of_slope = effects::energy_of_slope;
  Vec3 force = Vec3::Zero();
  for (std::uint32_t j : f.neighbours(i)) {
    const Vec3 d = (f.position[i] - f.position[j]) / f.support_radius, dg = slope_[i] - slope_[j];
    const double q = d.norm();
    const double along = of_lack * (lack_[i] + lack_[j]) * LackKernel::slope_over_q(q) -
                         of_slope * SlopeKernel::second(q) * d.dot(dg);
    force += volume(f, j) * (along * d - of_slope * SlopeKernel::first(q) * dg);
  }
  return strength_ / (std::pow(f.support_radius, 5) * f.rest_density) * force;
}

/// (S.5) and (S.6).
Vec3 SurfaceTension::plane_force(const EffectForces& f, std::size_t i, double share, double distance,
                                 const Vec3& normal) const {
  const double z = distance / f.support_radius;
  const double towards =
      wall_attraction_ * effects::half_space_attraction(z) +
      wall_as_fluid_ * effects::energy_of_lack * lack_[i] * LackKernel::plane(z) -
      wall_as_fluid_ * effects::energy_of_slope * SlopeKernel::plane_derivative(z) * normal.dot(slope_[i]);
  const double unit = strength_ * volume(f, i) / (f.support_radius * f.support_radius);
  return -unit * share * towards * normal;
}

void SurfaceTension::act_with_walls(EffectForces& f) const {
  const auto act = [&](std::size_t i, const VisibleWall& w, const Vec3& force) {
    f.acceleration[i] += force / f.mass(i);
    f.push(w.surface, w.nodes, w.weights, -force);
  };
  for (std::size_t i = 0; i < f.id.size(); ++i) {
    const Rim rim(f, i);
    if (rim.part > 0) {  // (S.8)
      const double across = strength_ * volume(f, i) * wall_as_fluid_ * effects::energy_of_slope *
                            SlopeKernel::plane(rim.distance / f.support_radius) /
                            (f.support_radius * rim.distance);
      act(i, *rim.wall,
          plane_force(f, i, rim.part, rim.distance, rim.normal) + rim.part * across * rim.turning(slope_[i]));
    }
    if (rim.part < 1)
      for (const VisibleWall& w : f.walls(i))
        act(i, w, plane_force(f, i, (1 - rim.part) * w.share, w.distance, w.normal));
  }
}

std::vector<std::uint8_t> SurfaceTension::save() const {
  std::vector<std::uint8_t> bytes;
  Archive archive(bytes);
  double coefficient = settings_.coefficient, angle = settings_.contact_angle;
  archive.values(coefficient, angle);
  return bytes;
}

Status SurfaceTension::restore(Span<const std::uint8_t> saved) {
  Archive archive(saved);
  SurfaceTensionSettings read;
  archive.values(read.coefficient, read.contact_angle);
  if (!archive.ok() || archive.left() > 0) return Status::refused("its settings are damaged");
  return set_settings(read);
}

}  // namespace oilskin
