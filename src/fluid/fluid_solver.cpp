#include "fluid/fluid_solver.h"

#include <algorithm>
#include <cmath>

#include "core/assert.h"
#include "core/body_motion.h"
#include "core/stage_timer.h"
#include "core/unit_vector.h"
#include "fluid/occlusion.h"
#include "fluid/pressure/pressure_model.h"

namespace oilskin::fluid {

namespace {

[[maybe_unused]] bool sorted_by_particle(Span<const PredictionContact> contacts) {
  return std::is_sorted(contacts.begin(), contacts.end(),
                        [](const auto& a, const auto& b) { return a.particle < b.particle; });
}

bool is_identity(const std::vector<std::uint32_t>& order) {
  for (std::size_t i = 0; i < order.size(); ++i)
    if (order[i] != i) return false;
  return true;
}

std::unique_ptr<PressureModel> make_model(const FluidSettings& s) {
  switch (s.solver) {
    case PressureSolver::mcg03:
      return make_mcg03(s);
    case PressureSolver::pcisph:
      return make_pcisph(s);
    case PressureSolver::dfsph:
      return make_dfsph(s);
  }
  return nullptr;
}

}  // namespace

struct FluidSolver::Impl {
  Impl(const FluidSettings& s, std::shared_ptr<Workers> w)
      : settings(s), workers(std::move(w)), state(*workers, s.support_ratio), model(make_model(s)) {}

  void load(const Particles& particles);
  bool remembers_loads(Span<SurfaceMotion* const> surfaces) const {
    return settings.boundary == BoundaryModel::mirrored ||
           std::any_of(surfaces.begin(), surfaces.end(), [](auto* s) { return friction_follows_host(*s); });
  }
  void finish(Particles& particles, Span<Vec3> velocity);

  const FluidSettings settings;
  std::shared_ptr<Workers> workers;
  StepState state;
  TriangleCells cells;  // of the interval, where they were asked for
  WallGeometry visible_walls{MirrorImage::of_full_reach()};
  std::unique_ptr<PressureModel> model;

  // Of checkpoint()
  double saved_previous_dt = 0;
  PressureModel::Memory saved_model;
  LoadMemory saved_loads;
};

FluidSolver::FluidSolver(const FluidSettings& settings, std::shared_ptr<Workers> workers) {
  OILSKIN_ASSERT(settings.validate().ok());
  impl_ = std::make_unique<Impl>(settings, std::move(workers));
}

FluidSolver::~FluidSolver() = default;

double FluidSolver::particle_mass() const {
  return impl_->model->particle_volume() * impl_->settings.rest_density;
}

double FluidSolver::support_radius() const {
  return impl_->settings.support_ratio * impl_->settings.spacing;
}

void FluidSolver::prepare(Particles& particles, StageSeconds& seconds) {
  const StageTimer timer(seconds.neighbours);
  Neighbours& neighbours = impl_->state.neighbours;
  const auto& order = neighbours.cell_order(particles.position, support_radius(), *impl_->workers);
  if (!is_identity(order)) {
    // Changes of velocity are of the last step: their memory is free.
    particles.permute(order, *impl_->workers, impl_->state.dv);
  }
  neighbours.search(particles.position, *impl_->workers);
  impl_->state.boundary.clear();
  impl_->cells.clear();
  impl_->state.hidden_pairs = 0;
}

std::vector<Box> FluidSolver::boxes(const Particles& particles) const {
  const Neighbours& neighbours = impl_->state.neighbours;
  return neighbours.boxes({particles.position.data(), neighbours.size()}, *impl_->workers);
}

void FluidSolver::apply_surfaces(double passed, double dt, const Vec3& gravity, const Particles& particles,
                                 Span<SurfaceMotion* const> surfaces,
                                 Span<const MeshTopology* const> topologies, Span<const TriangleList> near,
                                 StageSeconds& seconds) {
  StepState& state = impl_->state;
  const FluidSettings& settings = impl_->settings;
  OILSKIN_ASSERT(dt > 0 && particles.size() >= state.size() && topologies.size() == surfaces.size());
  if (surfaces.empty() || state.size() == 0) return;
  const Span<const Vec3> positions(particles.position.data(), state.size());
  const bool mirrored = settings.boundary == BoundaryModel::mirrored;
  if (settings.occlusion || mirrored) {
    const StageTimer timer(mirrored ? seconds.boundary : seconds.occlusion);
    impl_->cells.find(positions, surfaces, topologies, near, support_radius(), state.neighbours,
                      *impl_->workers);
  }
  if (settings.occlusion) {
    const StageTimer timer(seconds.occlusion);
    state.hidden_pairs = remove_hidden_neighbours(positions, surfaces, impl_->cells, support_radius(),
                                                  state.neighbours, *impl_->workers);
  }
  if (mirrored) {
    const StageTimer timer(seconds.boundary);
    state.boundary.find({passed, dt, particle_mass(), support_radius(), unit_or_zero(gravity), positions,
                         surfaces, topologies, impl_->cells},
                        *impl_->workers);
  }
}

const WallGeometry& FluidSolver::find_visible_walls(double reach, double dt, const Vec3& gravity,
                                                    const Particles& particles,
                                                    Span<SurfaceMotion* const> surfaces,
                                                    Span<const MeshTopology* const> topologies,
                                                    Span<const TriangleList> near) {
  StepState& state = impl_->state;
  const WallGeometry& of_boundary = state.boundary.geometry();
  if (impl_->settings.boundary == BoundaryModel::mirrored && reach <= of_boundary.reach(support_radius()))
    return of_boundary;
  const Span<const Vec3> positions(particles.position.data(), state.size());
  if (!impl_->cells.is_found())
    impl_->cells.find(positions, surfaces, topologies, near, support_radius(), state.neighbours,
                      *impl_->workers);
  impl_->visible_walls.find({dt, dt, particle_mass(), support_radius(), unit_or_zero(gravity), positions,
                             surfaces, topologies, impl_->cells},
                            *impl_->workers);
  return impl_->visible_walls;
}

void FluidSolver::record_host_response(double dt, const Vec3& gravity, Span<SurfaceMotion* const> surfaces) {
  if (!impl_->remembers_loads(surfaces)) return;
  LoadMemory& memory = impl_->state.boundary.memory();
  memory.record_host_response(dt, gravity, surfaces);
  memory.prepare(surfaces);
}

void FluidSolver::record_load(double dt, Span<SurfaceMotion* const> surfaces,
                              Span<const std::vector<Vec3>> of_others) {
  if (impl_->remembers_loads(surfaces)) impl_->state.boundary.memory().record_load(dt, surfaces, of_others);
}

const LoadMemory& FluidSolver::load_memory() const {
  return impl_->state.boundary.memory();
}

void FluidSolver::propose(double dt, const Vec3& gravity, Particles& particles,
                          Span<const PredictionContact> contacts, Span<const Vec3> acceleration,
                          Span<Vec3> velocity, FluidReport& report, StageSeconds& seconds) {
  StepState& state = impl_->state;
  OILSKIN_ASSERT(dt > 0 && particles.size() >= state.size() && velocity.size() == particles.size());
  OILSKIN_ASSERT(sorted_by_particle(contacts));
  report = FluidReport{};
  report.hidden_pairs = state.hidden_pairs;
  state.dt = dt;
  state.gravity = gravity;
  state.contacts = impl_->settings.contact_aware ? contacts : Span<const PredictionContact>();
  {
    const StageTimer timer(seconds.other_fluid);
    impl_->load(particles);
    if (!acceleration.empty()) state.for_each([&](std::size_t i) { state.dv[i] += dt * acceleration[i]; });
    impl_->model->explicit_terms(state);
  }
  {
    const StageTimer timer(seconds.pressure);
    impl_->model->pressure_terms(state, particles.pressure, report);
  }
  const StageTimer timer(seconds.other_fluid);
  impl_->finish(particles, velocity);
  state.previous_dt = dt;
}

Span<const std::uint32_t> FluidSolver::neighbours(std::size_t particle) const {
  const Neighbours& n = impl_->state.neighbours;
  return particle < n.size() ? Span<const std::uint32_t>(n.list(particle), n.count(particle))
                             : Span<const std::uint32_t>();
}

void FluidSolver::limit_iterations(int most) {
  impl_->model->limit_iterations(most);
}

void FluidSolver::store_slopes_of(std::size_t particles) {
  impl_->state.most_with_slopes = particles;
}

Span<const WallImpulse> FluidSolver::wall_impulses() const {
  return impl_->state.boundary.wall_impulses();
}

Span<const WallImpulse> FluidSolver::body_impulses() const {
  return impl_->state.boundary.body_impulses();
}

void FluidSolver::checkpoint() {
  impl_->saved_previous_dt = impl_->state.previous_dt;
  impl_->saved_model = impl_->model->memory();
  impl_->saved_loads = impl_->state.boundary.memory();
}

void FluidSolver::roll_back() noexcept {
  impl_->state.previous_dt = impl_->saved_previous_dt;
  impl_->model->set_memory(impl_->saved_model);
  impl_->state.boundary.memory().swap(impl_->saved_loads);
}

void FluidSolver::visit(Archive& archive) {
  StepState& state = impl_->state;
  archive.value(state.previous_dt);
  archive.require(std::isfinite(state.previous_dt) && state.previous_dt >= 0, "the length of the last step");
  impl_->model->visit(archive);
  state.boundary.memory().visit(archive);
}

void FluidSolver::Impl::load(const Particles& particles) {
  const std::size_t n = state.size();
  state.velocity.resize(n + 1);
  state.velocity[n] = Record{0, 0, 0, 0};
  state.relative_density.resize(n);
  state.dv.resize(n);
  state.mass_ratio.clear();
  if (particles.mass_varies) {
    state.mass_ratio.assign(particles.mass_ratio.begin(),
                            particles.mass_ratio.begin() + static_cast<std::ptrdiff_t>(n));
    state.mass_ratio.push_back(0);
  }
  state.for_each([&](std::size_t i) {
    const Eigen::Vector3f v = particles.velocity[i].cast<float>();
    state.velocity[i] = {v[0], v[1], v[2], 0};
    OILSKIN_ASSERT(v.allFinite());
    state.dv[i] = state.dt * state.gravity;
  });
}

void FluidSolver::Impl::finish(Particles& particles, Span<Vec3> velocity) {
  state.for_each([&](std::size_t i) {
    velocity[i] = particles.velocity[i] + state.dv[i];
    particles.density[i] = settings.rest_density * static_cast<double>(state.relative_density[i]);
  });
}

}  // namespace oilskin::fluid
