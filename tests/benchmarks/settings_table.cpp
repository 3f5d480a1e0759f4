// What each accurate setting costs and gives, alone and together, against the plain ones. All runs advance in
// turn, one step each, so that whatever else the machine does slows them alike and ratios are fair. Seconds
// of wall time over the whole run, without the cloth's own and without `verify`.
//
// The density error is measured on the positions at the start of each step, the same way for every solver.
// Crossings are counted by `verify`, which looks by an independent route.
//
// use: settings_table [scene = jet] [simulated seconds = 0.3] [threads = 0, all]
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <functional>
#include <stdexcept>

#include "checks/totals.h"
#include "hosts/bullet_simulation.h"
#include "hosts/step_plan.h"
#include "scene/scene_library.h"

using namespace oilskin;
using namespace oilskin::demo;

namespace {

constexpr double fast = 5;  // [m/s]; nothing in the scenes falls or is thrown so far that it should be faster

using Change = std::function<void(Scene*)>;

void plain(Scene* s) {
  s->fluid.occlusion = false;
  s->fluid.boundary = BoundaryModel::contact_only;
  s->fluid.solver = PressureSolver::pcisph;
  s->fluid.max_substeps = 1;
  s->contact.verify = true;
}

void occlusion(Scene* s) {
  s->fluid.occlusion = true;
}

void mirrored(Scene* s) {
  s->fluid.boundary = BoundaryModel::mirrored;
}

void both(Scene* s) {
  occlusion(s);
  mirrored(s);
}

void viscous_wall(Scene* s) {
  SlipSettings slip;
  slip.model = SlipModel::viscous_wall;
  for (Cloth& c : s->cloth) c.surface.slip = slip;
  for (Body& b : s->bodies) b.surface.slip = slip;
}

void dfsph(Scene* s) {
  s->fluid.solver = PressureSolver::dfsph;
}

void four_substeps(Scene* s) {
  s->fluid.max_substeps = 4;
}

void all(Scene* s) {
  for (const auto change : {both, viscous_wall, dfsph, four_substeps}) change(s);
}

/// One row: a simulation and what it adds up.
class Row {
 public:
  Row(const char* name, Scene scene, const SimulationOptions& options)
      : name_(name), scene_(std::move(scene)), plan_(scene_), simulation_(make_simulation(scene_, options)) {}

  /// One step; false at the end.
  bool advance() {
    const SimulatedTime& time = simulation_->time();
    if (plan_.done(time)) return false;
    World& world = simulation_->world();
    const double suggested = plan_.adaptive() ? world.suggested_dt(scene_.dt) : scene_.dt;
    const StepReport& r = simulation_->step(plan_.next(time.value(), suggested));
    if (!r.status.ok()) throw std::runtime_error(std::string(name_) + ": " + r.status.message);
    totals_.add(r);
    divergence_iterations_ += static_cast<std::uint64_t>(r.fluid.divergence_iterations);
    measure_density(world);
    std::uint64_t fast_now = 0;
    for (const Vec3& v : world.velocities()) fast_now += v.squaredNorm() > fast * fast;
    max_fast_ = std::max(max_fast_, fast_now);
    return true;
  }

  void print() const {
    const StageSeconds& s = totals_.seconds;
    const double contact = s.gather + s.proximity + s.impulses + s.ccd + s.zones;
    const double sum = s.neighbours + s.occlusion + s.boundary + s.pressure + s.other_fluid + contact;
    const double substeps = static_cast<double>(totals_.substeps);
    std::printf(
        "%-16s %7.2f %10.2f %9.2f %8.2f %8.2f %6.2f %7.2f %9.2f %6.2f %6.2f %9.4f %8.2f %6llu %9llu "
        "%9zu\n",
        name_, sum, s.neighbours, s.occlusion, s.boundary, s.pressure, s.other_fluid, contact,
        substeps / static_cast<double>(totals_.steps),
        static_cast<double>(totals_.pressure_iterations) / substeps,
        static_cast<double>(divergence_iterations_) / substeps,
        100 * density_error_sum_ / static_cast<double>(totals_.steps), 100 * density_error_max_,
        static_cast<unsigned long long>(max_fast_),
        static_cast<unsigned long long>(totals_.contact.crossings_found_by_verify),
        simulation_->world().particle_count());
  }

 private:
  void measure_density(const World& world) {
    if (world.particle_count() == 0) return;
    double sum = 0;
    for (double density : world.densities()) {
      const double error = std::max(0.0, density / scene_.fluid.rest_density - 1);
      sum += error;
      density_error_max_ = std::max(density_error_max_, error);
    }
    density_error_sum_ += sum / static_cast<double>(world.particle_count());
  }

  const char* name_;
  Scene scene_;
  StepPlan plan_;
  std::unique_ptr<Simulation> simulation_;
  Totals totals_;
  std::uint64_t divergence_iterations_ = 0, max_fast_ = 0;
  double density_error_sum_ = 0, density_error_max_ = 0;
};

int print_table(const RunOptions& options) {
  SimulationOptions simulation_options;
  simulation_options.threads = options.threads;
  std::vector<Row> rows;
  const auto add = [&](const char* name, const Change& change) {
    Scene scene = load_scene(options);
    plain(&scene);
    change(&scene);
    rows.emplace_back(name, std::move(scene), simulation_options);
  };
  add("base", [](Scene*) {});
  add("occlusion", occlusion);
  add("mirrored", mirrored);
  add("both", both);
  add("viscous_wall", viscous_wall);
  add("dfsph", dfsph);
  add("max_substeps 4", four_substeps);
  add("all", all);
  for (bool more = true; more;) {
    more = false;
    for (Row& row : rows) more = row.advance() || more;
  }
  std::printf("%s, %.2f s simulated; seconds of wall time; iterations per interval; density error in %%\n",
              options.scene.c_str(), *options.duration);
  std::printf(
      "                     sum neighbours occlusion boundary pressure  other contact intervals/step  iter   "
      "div "
      "mean err  max err >%g m/s crossings particles\n",
      fast);
  for (const Row& row : rows) row.print();
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  RunOptions options;
  options.scene = argc > 1 ? argv[1] : "jet";
  options.duration = argc > 2 ? std::atof(argv[2]) : 0.3;
  options.threads = argc > 3 ? std::atoi(argv[3]) : 0;
  try {
    return print_table(options);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 2;
  }
}
