#include "study/comparators/leak_table.h"

#include <cmath>

#include "study/comparators/run_clock.h"

namespace oilskin::study {
namespace {

/// Off the symmetry of the mesh, so that no particle is aimed at an edge.
const Vec3 aim(0.0013, 0, 0.0007);
constexpr double radius = 5.05;  // [dx]

std::vector<Vec3> jet(int layers, double spacing) {
  std::vector<Vec3> points;
  for (int j = 0; j < layers; ++j)
    for (int i = -5; i < 5; ++i)
      for (int k = -5; k < 5; ++k)
        if (std::hypot(i + 0.5, k + 0.5) < radius)
          points.push_back(aim + spacing * Vec3(i + 0.5, j + 1.5, k + 0.5));
  return points;
}

}  // namespace

LeakResult run(const LeakCase& setup) {
  MethodSettings settings;
  settings.max_substeps = setup.max_substeps;
  SheetSettings shape;
  shape.held = setup.held;
  shape.areal_density = setup.areal_density;
  Sheet sheet(shape);
  const std::unique_ptr<CouplingMethod> method = make_method(setup.method, settings);
  LeakResult result;
  result.setup = setup;
  RunClock clock(*method);
  Status status = method->attach(sheet.host());
  const std::vector<Vec3> x = jet(setup.layers, settings.spacing);
  result.particles = x.size();
  if (status.ok()) status = method->add_particles(x, std::vector<Vec3>(x.size(), Vec3(0, -setup.speed, 0)));
  const int steps = static_cast<int>(std::ceil(setup.duration / setup.dt - 1e-9));
  for (int k = 0; k < steps && status.ok(); ++k) {
    sheet.advance(setup.dt, settings.gravity);
    status = clock.step(setup.dt);
  }
  result.remaining = method->positions().size();
  result.leaks = clock.leaks();
  result.seconds_per_second = clock.seconds_per_second();
  result.intervals = clock.intervals();
  result.refused = status.message;
  return result;
}

std::vector<LeakCase> leak_cases() {
  std::vector<LeakCase> cases;
  for (Method method : all_methods)
    for (Held held : {Held::all, Held::border, Held::none})
      for (double speed : {3.0, 10.0, 50.0, 500.0})
        for (double dt : {0.25e-3, 0.5e-3, 1e-3, 2e-3, 4e-3, 8e-3, 1.0 / 60}) {
          LeakCase c;
          c.method = method, c.held = held, c.speed = speed, c.dt = dt;
          cases.push_back(c);
        }
  return cases;
}

}  // namespace oilskin::study
