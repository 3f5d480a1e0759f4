// Water of 4 cm on a ground whose triangles are as large as its particles, or much smaller: 1,024 particles
// run together in a bowl, smooth or rough. Prints milliseconds per step of 1/120 s, the mean of the second
// half of the steps.
//
// use: fine_walls_benchmark [edge of a triangle [spacings] = 0.5] [roughness [edges] = 0.3] [steps = 40]
//                           [threads = 2]
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "oilskin/world.h"
#include "support/random.h"
#include "support/static_mesh.h"

using namespace oilskin;

namespace {

constexpr double spacing = 0.04, size = 1.6;

test::StaticMesh bowl(double edge, double roughness) {
  test::StaticMesh ground;
  const auto cells = static_cast<std::uint32_t>(std::ceil(size / edge));
  ground.add_rectangle(Vec3(-size / 2, 0, -size / 2), Vec3(0, 0, size), Vec3(size, 0, 0), cells, cells);
  test::Random random(3);
  for (Vec3& x : ground.nodes) {
    const double r2 = x.x() * x.x() + x.z() * x.z();
    x.y() = 0.6 * r2 + roughness * size / cells * random.uniform(-0.5, 0.5);
  }
  ground.changes = test::StaticMesh::Changes::never;
  return ground;
}

}  // namespace

int main(int argc, char** argv) {
  const double edge = argc > 1 ? std::atof(argv[1]) : 0.5, roughness = argc > 2 ? std::atof(argv[2]) : 0.3;
  const int steps = argc > 3 ? std::atoi(argv[3]) : 40;
  if (!(edge >= 0.05) || !(roughness >= 0) || steps < 2)
    return std::fprintf(stderr, "edge >= 0.05, roughness >= 0, steps >= 2\n"), 2;
  WorldSettings settings;
  settings.threads = argc > 4 ? std::atoi(argv[4]) : 2;
  settings.kill_box = {Vec3::Constant(-3), Vec3::Constant(3)};
  FluidSettings fluid;
  fluid.spacing = spacing;
  fluid.boundary = BoundaryModel::mirrored;
  World world(settings, fluid);
  test::StaticMesh ground = bowl(edge * spacing, roughness);
  std::vector<Vec3> x;
  for (int i = 0; i < 16; ++i)
    for (int j = 0; j < 4; ++j)
      for (int k = 0; k < 16; ++k) x.push_back(Vec3(-0.31, 0.12, -0.31) + spacing * Vec3(i, j, k));
  if (!world.attach(ground, {}, nullptr).ok() ||
      !world.add_particles(x, std::vector<Vec3>(x.size(), Vec3::Zero())).ok())
    return 2;
  StageSeconds stages;
  const int counted = steps - steps / 2;
  for (int k = 0; k < steps; ++k) {
    const StepReport& r = world.step(1.0 / 120);
    if (!r.status.ok()) return std::fprintf(stderr, "%s\n", r.status.message.c_str()), 2;
    if (k >= steps / 2) stages += r.seconds;
  }
  const auto ms = [&](double s) { return 1e3 * s / counted; };
  std::printf(
      "%zu triangles: boundary %.1f, hidden neighbours %.2f, pressure %.1f, proximity %.2f ms a step\n",
      ground.triangles.size(), ms(stages.boundary), ms(stages.occlusion), ms(stages.pressure),
      ms(stages.proximity));
  return 0;
}
