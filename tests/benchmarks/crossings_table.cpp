// Crossings per step over the length of the step, on the scene `jet`: repulsion alone, repulsion with the
// continuous test, and both with impact zones. Counted by `verify`, which looks by an independent route.
// Bullet's own sub-steps keep their length, so that the cloth is the same in every row.
//
// use: crossings_table [simulated seconds = 0.15] [threads = 0, all]
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <stdexcept>

#include "checks/totals.h"
#include "hosts/bullet_simulation.h"
#include "scene/scene_library.h"

using namespace oilskin;
using namespace oilskin::demo;

namespace {

struct Stages {
  const char* name;
  bool ccd, zones;
};

constexpr Stages stages[] = {
    {"repulsion", false, false}, {"and cubic", true, false}, {"and zones", true, true}};

Totals run(const Stages& used, double dt, double duration, int threads) {
  RunOptions options;
  options.scene = "jet";
  Scene scene = load_scene(options);
  const double sub_dt = scene.dt / scene.cloth[0].substeps;
  scene.dt = dt;
  scene.duration = duration;
  scene.cloth[0].substeps = std::max(1, static_cast<int>(std::lround(dt / sub_dt)));
  scene.contact.ccd = used.ccd;
  scene.contact.zones = used.zones;
  scene.contact.verify = true;
  SimulationOptions simulation_options;
  simulation_options.threads = threads;
  const auto simulation = make_simulation(scene, simulation_options);
  const StepPlan plan(scene);
  Totals totals;
  while (!plan.done(simulation->time())) {
    const StepReport& r = simulation->step(dt);
    if (!r.status.ok()) throw std::runtime_error(std::string(used.name) + ": " + r.status.message);
    totals.add(r);
  }
  return totals;
}

int print_table(double duration, int threads) {
  std::printf("jet, %.3f s simulated\n   dt [s]  steps", duration);
  for (const Stages& s : stages) std::printf("  %-22s", s.name);
  std::printf("\n                ");
  for (std::size_t i = 0; i < std::size(stages); ++i) std::printf("  %10s %11s", "crossings", "per step");
  std::printf("\n");
  for (const double dt : {1e-4, 1e-3, 4e-3, 1.0 / 60}) {
    for (const Stages& s : stages) {
      const Totals totals = run(s, dt, duration, threads);
      const auto crossings = static_cast<unsigned long long>(totals.contact.crossings_found_by_verify);
      if (&s == stages) std::printf("%9.5f %6llu", dt, static_cast<unsigned long long>(totals.steps));
      std::printf("  %10llu %11.4g", crossings,
                  static_cast<double>(crossings) / static_cast<double>(totals.steps));
      std::fflush(stdout);
    }
    std::printf("\n");
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return print_table(argc > 1 ? std::atof(argv[1]) : 0.15, argc > 2 ? std::atoi(argv[2]) : 0);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 2;
  }
}
