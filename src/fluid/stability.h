/// How long an interval may be so that what is integrated explicitly stays stable.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "oilskin/settings.h"

namespace oilskin::fluid {

/// ν dt/H² up to which the viscous term alone is stable, with a margin of 7 % (F.12).
constexpr double viscous_limit = 0.035;

constexpr double standard_gravity = 9.81;  // [m/s²]

/// The length of a metre in the unit of the world, by its gravity g: worlds in centimetres have 981.
/// Corrections with speeds that are fixed in m/s use it. Gravity below that of the earth is that of another
/// place, or none.
inline double metre(double g) {
  return std::max(1.0, g / standard_gravity);
}

/// t_r of (F.18) [s]: in which water that is compressed may expand.
inline double recovery_time(double spacing, double g) {
  const double longest = 4 * spacing / metre(g);
  return g > 0 ? std::min(0.9 * std::sqrt(spacing / g), longest) : longest;
}

inline double support_radius(const FluidSettings& s) {
  return s.support_ratio * s.spacing;
}

/// The largest ν dt [m²] that an interval of dt [s] takes, next to its XSPH (F.65).
inline double largest_viscous_step(const FluidSettings& s, double dt) {
  const double h = support_radius(s);
  return viscous_limit * h * h * std::max(0.5, 1 - 0.5 * s.xsph_rate.value_or(0) * dt);
}

/// ν dt as it is applied: the stable part of it [m²].
inline double viscous_step(const FluidSettings& s, double dt) {
  return std::min(s.viscosity * dt, largest_viscous_step(s, dt));
}

/// Half the largest eigenvalue of the viscous term in an interval of dt [s] at rest density (F.12);
/// viscous_limit without its margin.
inline double viscous_load(const FluidSettings& s, double dt) {
  const double h = support_radius(s);
  return 0.93 * viscous_step(s, dt) / (viscous_limit * h * h);
}

/// The longest interval [s] in which viscosity need not be limited; infinity without viscosity (F.66).
inline double longest_viscous_interval(const FluidSettings& s) {
  if (!(s.viscosity > 0)) return std::numeric_limits<double>::infinity();
  const double h = support_radius(s), d = viscous_limit * h * h;
  return std::max(0.5 * d / s.viscosity, d / (s.viscosity + 0.5 * d * s.xsph_rate.value_or(0)));
}

/// The height of a column that presets, budgets and water without a known pressure allow for [dx].
constexpr double usual_layers = 15;

/// The longest interval [s] in which water with boundary terms carries a column of `layers` > 0 spacings
/// above it (F.55), g = |gravity| [m/s²]; infinity with contact alone, which holds it.
inline double longest_loaded_interval(const FluidSettings& s, double layers, double g) {
  if (s.boundary != BoundaryModel::mirrored || !(g > 0)) return std::numeric_limits<double>::infinity();
  return (s.solver == PressureSolver::pcisph ? 0.45 : 0.7) * std::sqrt(s.spacing / (layers * g));
}

/// The longest interval [s] of the state equation at the speed v [m/s] of the fluid; infinity for other
/// solvers (F.46).
inline double longest_sound_interval(const FluidSettings& s, double v) {
  if (s.solver != PressureSolver::mcg03) return std::numeric_limits<double>::infinity();
  return 0.4 * support_radius(s) / (std::sqrt(s.stiffness) + v);
}

}  // namespace oilskin::fluid
