#include "oilskin/settings.h"

#include <cmath>

#include "core/refuse.h"
#include "oilskin/surface_motion.h"

namespace oilskin {

namespace {

/// Values of enums may come from files.
template <class E>
bool is_one_of(E value, E last) {
  return static_cast<int>(value) >= 0 && static_cast<int>(value) <= static_cast<int>(last);
}

bool positive(double x) {
  return std::isfinite(x) && x > 0;
}
bool not_negative(double x) {
  return std::isfinite(x) && x >= 0;
}

}  // namespace

Status FluidSettings::validate() const {
  if (!within(spacing, 1e-6, 1e3)) return refuse_value("fluid.spacing", spacing, "1e-6 … 1e3 m");
  if (!within(rest_density, 1e-6, 1e9))
    return refuse_value("fluid.rest_density", rest_density, "1e-6 … 1e9 kg/m³");
  if (!within(support_ratio, 1.5, 4)) return refuse_value("fluid.support_ratio", support_ratio, "1.5 … 4");
  if (!not_negative(tolerance)) return refuse_value("fluid.tolerance", tolerance, "finite and ≥ 0");
  if (min_iterations < 1) return refuse_value("fluid.min_iterations", min_iterations, "≥ 1");
  if (max_iterations < min_iterations)
    return refuse_value("fluid.max_iterations", max_iterations, "≥ fluid.min_iterations");
  if (!within(gradient_correction, 0, 1))
    return refuse_value("fluid.gradient_correction", gradient_correction, "0 … 1");
  if (!positive(stiffness)) return refuse_value("fluid.stiffness", stiffness, "finite and > 0 m²/s²");
  if (!not_negative(viscosity)) return refuse_value("fluid.viscosity", viscosity, "finite and ≥ 0 m²/s");
  if (!not_negative(xsph_rate.value_or(0)))
    return refuse_value("fluid.xsph_rate", *xsph_rate, "finite and ≥ 0 1/s");
  if (!not_negative(xsph_strain.value_or(0)))
    return refuse_value("fluid.xsph_strain", *xsph_strain, "finite and ≥ 0");
  if (!not_negative(divergence_tolerance))
    return refuse_value("fluid.divergence_tolerance", divergence_tolerance, "finite and ≥ 0");
  if (!positive(cfl)) return refuse_value("fluid.cfl", cfl, "finite and > 0");
  if (max_substeps < 1 || max_substeps > 1000)
    return refuse_value("fluid.max_substeps", max_substeps, "1 … 1000");
  if (!is_one_of(solver, PressureSolver::dfsph))
    return refuse_value("fluid.solver", static_cast<int>(solver), "a PressureSolver");
  if (!is_one_of(boundary, BoundaryModel::mirrored))
    return refuse_value("fluid.boundary", static_cast<int>(boundary), "a BoundaryModel");
  if (boundary == BoundaryModel::mirrored && solver == PressureSolver::mcg03)
    return refuse_value("fluid.boundary", "mirrored",
                        "contact_only with solver mcg03, or use pcisph or dfsph");
  if (boundary == BoundaryModel::mirrored && support_ratio > 2.5)
    return refuse_value("fluid.support_ratio", support_ratio,
                        "1.5 … 2.5 with fluid.boundary mirrored, which has one layer of images");
  return {};
}

double default_xsph_rate(double spacing, double g) {
  return 0.5 * std::sqrt(g / spacing);
}

void set_smoothing(FluidSettings& fluid, double g) {
  if (!fluid.xsph_strain) fluid.xsph_strain = fluid.xsph_rate ? 0 : 1;
  if (!fluid.xsph_rate) fluid.xsph_rate = default_xsph_rate(fluid.spacing, g);
}

double default_thickness(double spacing) {
  return 0.2 * spacing;
}

Status SurfaceSettings::validate() const {
  if (thickness && !(positive(*thickness) && *thickness < 1e15))
    return refuse_value("thickness", *thickness, "a length > 0 m and < 1e15 m");
  const auto check = [](const SlipSettings& s, const char* friction, const char* slip_length) -> Status {
    if (!is_one_of(s.model, SlipModel::viscous_wall))
      return refuse_value("slip.model", static_cast<int>(s.model), "a SlipModel");
    if (std::isnan(s.friction) || s.friction < 0) return refuse_value(friction, s.friction, "≥ 0");
    if (std::isnan(s.slip_length) || s.slip_length < 0)
      return refuse_value(slip_length, s.slip_length, "≥ 0 m");
    return {};
  };
  if (Status s = check(slip, "slip.friction", "slip.slip_length"); !s.ok()) return s;
  if (slip_back)
    if (Status s = check(*slip_back, "slip_back.friction", "slip_back.slip_length"); !s.ok()) return s;
  return {};
}

Status ContactSettings::validate() const {
  if (!is_one_of(repulsion, Repulsion::none))
    return refuse_value("contact.repulsion", static_cast<int>(repulsion), "a Repulsion");
  if (!is_one_of(infeasible, Infeasible::allow))
    return refuse_value("contact.infeasible", static_cast<int>(infeasible), "an Infeasible");
  if (!is_one_of(hierarchy, Hierarchy::fcl))
    return refuse_value("contact.hierarchy", static_cast<int>(hierarchy), "a Hierarchy");
  if (!not_negative(stiffness)) return refuse_value("contact.stiffness", stiffness, "finite and ≥ 0 N/m");
  if (solver_iterations < 1 || solver_iterations > 1000)
    return refuse_value("contact.sweeps", solver_iterations, "1 … 1000");
  if (ccd_iterations < 0 || ccd_iterations > 100)
    return refuse_value("contact.rounds", ccd_iterations, "0 … 100");
  return {};
}

Status WorldSettings::validate() const {
  if (!(gravity.array().abs() <= 1e6).all())
    return refuse_value("gravity", gravity.transpose(), "finite, and no component beyond 1e6 m/s²");
  if (!kill_box.min.allFinite() || !kill_box.max.allFinite() ||
      !(kill_box.min.array() < kill_box.max.array()).all())
    return refuse_value("kill_box", kill_box.min.transpose(), "finite with min < max on every axis");
  if (threads < 0) return refuse_value("threads", threads, "≥ 0 (0 = all)");
  if (!not_negative(step_budget))
    return refuse_value("step_budget", step_budget, "finite and ≥ 0 s (0 = no limit)");
  return {};
}

double minimum_separation(double thickness, double max_coordinate, Storage storage) {
  return std::max(1e-3 * thickness, 64 * epsilon_of(storage) * max_coordinate);
}

}  // namespace oilskin
