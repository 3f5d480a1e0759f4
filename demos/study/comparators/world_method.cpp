// The library, as it is by default and reduced to what [Huber2013] describes.
#include <stdexcept>

#include "study/comparators/make_methods.h"
#include "study/comparators/world_settings.h"

namespace oilskin::study {
namespace {

/// The fluid of [Huber2013] does not know of surfaces: no boundary terms, no filter of neighbours, no bounds
/// on predicted positions, no sub-steps.
FluidSettings fluid_of(Method method, const MethodSettings& settings) {
  if (method == Method::oilskin) return fluid_settings(settings, FluidSettings().max_substeps);
  FluidSettings fluid = fluid_settings(settings, 1);
  fluid.solver = PressureSolver::pcisph;
  fluid.boundary = BoundaryModel::contact_only;
  fluid.occlusion = fluid.contact_aware = false;
  return fluid;
}

ContactSettings contact_of(Method method) {
  ContactSettings contact;
  if (method == Method::oilskin) return contact;
  contact.repulsion = Repulsion::bridson;
  contact.ccd = method == Method::paper;
  contact.zones = false;
  return contact;
}

class WorldMethod : public CouplingMethod {
 public:
  WorldMethod(Method method, const MethodSettings& settings)
      : world_(world_settings(settings), fluid_of(method, settings), contact_of(method)) {
    if (!world_.status().ok()) throw std::invalid_argument(world_.status().message);
    surface_settings_.thickness = settings.thickness;
  }

  Status attach(SurfaceHost& host, std::size_t* surface) override {
    SurfaceId id;
    Status status = world_.attach(host, surface_settings_, &id);
    if (!status.ok()) return status;
    if (surface != nullptr) *surface = surfaces_.size();
    surfaces_.push_back(id);
    return status;
  }
  Status add_particles(Span<const Vec3> positions, Span<const Vec3> velocities) override {
    return world_.add_particles(positions, velocities);
  }
  Status step(double dt) override { return world_.step(dt).status; }

  Span<const std::uint64_t> ids() const override { return world_.ids(); }
  Span<const Vec3> positions() const override { return world_.positions(); }
  Span<const Vec3> velocities() const override { return world_.velocities(); }
  Span<const double> densities() const override { return world_.densities(); }
  Span<const double> pressures() const override { return world_.pressures(); }
  double particle_mass() const override { return world_.particle_mass(); }
  const SurfaceMotion& surface(std::size_t index) const override {
    return *world_.surface(surfaces_.at(index));
  }
  void set_observer(IntervalObserver* observer) override { world_.set_observer(observer); }

 private:
  World world_;
  SurfaceSettings surface_settings_;
  std::vector<SurfaceId> surfaces_;
};

}  // namespace

std::unique_ptr<CouplingMethod> make_world_method(Method method, const MethodSettings& settings) {
  return std::make_unique<WorldMethod>(method, settings);
}

}  // namespace oilskin::study
