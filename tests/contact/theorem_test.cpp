// The theorem of docs/theory/contact.md under random squeezing: if no live pair is too close at x0, the loop
// ends, no paths intersect, and no live pair is too close at x1, whatever the host's rounding, masses, dt.
#include <gtest/gtest.h>

#include <cstdlib>

#include "contact/predicates.h"
#include "support/particle_arrays.h"
#include "support/random.h"
#include "support/record.h"

namespace oilskin {
namespace {

using test::ParticleArrays;
using test::Random;

struct Case {
  const char* name;
  Storage storage;
  double at;  // |x| [m]
  int steps;
  double pins;      // fraction of prescribed nodes
  bool pins_agree;  // all prescribed nodes move alike
  bool movable;
  Infeasible policy;
  bool floor = false;  // the lowest layer stands still and may not be held
};

void PrintTo(const Case& c, std::ostream* out) {
  *out << c.name;
}

class Squeezing : public ::testing::TestWithParam<Case> {};

struct Scene {
  std::vector<SurfaceMotion> layers;
  ParticleArrays particles;
  std::vector<SurfaceMotion*> surfaces;
};

constexpr double edge = 0.02;

Scene make_scene(Random& random, const Case& c) {
  Scene scene;
  const Vec3 at = Vec3(1, -0.6, 0.8) * c.at;
  const double r = 1.5 * c.at + 2;
  const int layers = 2 + static_cast<int>(random.below(3));
  const double h = c.at > 50 ? 0.01 : 0.002;
  const double gap = 8 * minimum_separation(h, r, c.storage) + 0.3 * h;
  for (int l = 0; l < layers; ++l) {
    const double mass = random.log_uniform(1e-6, 1e-3);
    SurfaceMotion s =
        test::make_grid(6, 6, at + Vec3(0, l * gap, 0), Vec3(5 * edge, 0, 0), Vec3(0, 0, 5 * edge), mass, h,
                        r, c.storage, static_cast<std::uint64_t>(l + 1));
    s.nodes_movable = c.movable;
    for (std::size_t i = 0; i < s.x_t0.size(); ++i)
      if (random.uniform() < c.pins) {
        s.inverse_mass[i] = 0;
        s.holdable[i] = 1;
      }
    if (c.floor && l == 0) {
      s.inverse_mass.assign(s.x_t0.size(), 0);
      s.holdable.assign(s.x_t0.size(), 0);
    }
    scene.layers.push_back(s);
  }
  for (SurfaceMotion& s : scene.layers) scene.surfaces.push_back(&s);
  for (int k = 0; k < 40; ++k) {
    const double layer = random.below(static_cast<std::uint32_t>(layers)) - 0.5;
    const Vec3 x = at + Vec3(random.uniform(-0.1, 5.1) * edge, layer * gap, random.uniform(-0.1, 5.1) * edge);
    scene.particles.add(x, Vec3::Zero(), random.log_uniform(1e-6, 1e-3));
  }
  return scene;
}

// Proposes anything: each node and particle somewhere up to `size` away, with a pull towards the middle that
// closes the layers on the particles.
void propose(Random& random, const Case& c, Scene& scene, double dt) {
  const double size = edge * random.log_uniform(0.01, 100);
  const Vec3 pin_motion = random.in_cube(size);
  Vec3 centre = Vec3::Zero();
  for (const Vec3& x : scene.particles.x_t0) centre += x / static_cast<double>(scene.particles.x_t0.size());
  const bool closing = random.uniform() < 0.5;
  for (SurfaceMotion& s : scene.layers)
    for (std::size_t i = 0; i < s.x_t0.size(); ++i) {
      Vec3 d = random.uniform() < 0.2 ? Vec3(Vec3::Zero()) : random.in_cube(size);
      if (closing) d.y() = 1.5 * (centre.y() - s.x_t0[i].y());
      // A leash keeps the scene where δ was chosen for.
      d += 0.2 * (centre - s.x_t0[i]) * (size > edge ? 1 : 0);
      if (s.inverse_mass[i] == 0) d = c.pins_agree ? pin_motion : Vec3(random.in_cube(0.1 * edge));
      if (c.floor && &s == &scene.layers.front()) d.setZero();
      const Vec3 target = s.x_t0[i] + d;
      s.x_t1[i] = (target - Vec3(1, -0.6, 0.8) * c.at).norm() < 1.0 ? stored(target, s.storage) : s.x_t0[i];
      s.velocity[i] = (s.x_t1[i] - s.x_t0[i]) / dt;
    }
  for (std::size_t p = 0; p < scene.particles.id.size(); ++p) {
    const Vec3 d = random.in_cube(size);
    Vec3 target = scene.particles.x_t0[p] + d;
    if ((target - Vec3(1, -0.6, 0.8) * c.at).norm() > 1.0) target = scene.particles.x_t0[p];
    scene.particles.velocity[p] = (target - scene.particles.x_t0[p]) / dt;
    scene.particles.x_t1[p] = target;
  }
}

Vec3 momentum(const Scene& scene) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t p = 0; p < scene.particles.id.size(); ++p)
    if (!scene.particles.removed[p]) sum += scene.particles.velocity[p] / scene.particles.inverse_mass[p];
  for (const SurfaceMotion& s : scene.layers)
    for (std::size_t i = 0; i < s.velocity.size(); ++i)
      if (s.inverse_mass[i] > 0) sum += s.velocity[i] / s.inverse_mass[i];
  return sum;
}

double momentum_scale(const Scene& scene) {
  double sum = 0;
  for (std::size_t p = 0; p < scene.particles.id.size(); ++p)
    sum += scene.particles.velocity[p].norm() / scene.particles.inverse_mass[p];
  for (const SurfaceMotion& s : scene.layers)
    for (std::size_t i = 0; i < s.velocity.size(); ++i)
      if (s.inverse_mass[i] > 0) sum += s.velocity[i].norm() / s.inverse_mass[i];
  return sum;
}

// Every pair, without candidates: the brute-force twin of the certificate.
void expect_certified(const Scene& scene, int step) {
  for (std::size_t p = 0; p < scene.particles.id.size(); ++p) {
    if (scene.particles.removed[p]) continue;
    for (const SurfaceMotion& s : scene.layers)
      for (const Triangle& t : s.triangles) {
        const contact::PointTriangle x0{scene.particles.x_t0[p], s.x_t0[t[0]], s.x_t0[t[1]], s.x_t0[t[2]]};
        const contact::PointTriangle x1{scene.particles.x_t1[p], s.x_t1[t[0]], s.x_t1[t[1]], s.x_t1[t[2]]};
        ASSERT_FALSE(contact::end_distance(x1, s.delta).too_close) << "step " << step;
        ASSERT_FALSE(contact::paths_intersect(x0, x1).hit) << "step " << step;
      }
  }
  for (const SurfaceMotion& s : scene.layers)
    for (const Vec3& x : s.x_t1) ASSERT_EQ(x, stored(x, s.storage));
}

TEST_P(Squeezing, no_paths_intersect_and_no_pair_is_too_close_at_the_end) {
  Case c = GetParam();
  if (const char* steps = std::getenv("OILSKIN_SQUEEZING_STEPS")) c.steps = std::atoi(steps);
  Random random(static_cast<std::uint64_t>(c.at * 7 + c.pins * 100 + c.steps));
  ContactSettings settings;
  settings.infeasible = c.policy;
  std::uint64_t max_zone_rounds = 0, zone_steps = 0, removed = 0, carried_along = 0, stalled = 0,
                steps_run = 0;
  double minimum = std::numeric_limits<double>::infinity();
  int step = 0;
  while (step < c.steps) {
    Scene scene = make_scene(random, c);
    ContactSolver solver(settings, 1);
    for (int k = 0; k < 50 && step < c.steps; ++k, ++step) {
      const double dt = random.log_uniform(1e-4, 1e-1);
      propose(random, c, scene, dt);
      const Vec3 before = momentum(scene);
      const double scale = momentum_scale(scene);
      ParticleMotion motion = scene.particles.motion();
      ContactReport report;
      StageSeconds seconds;
      const Status status = solver.resolve(dt, motion, scene.surfaces, report, seconds);
      ASSERT_TRUE(status.ok()) << status.message;
      ASSERT_NO_FATAL_FAILURE(expect_certified(scene, step));
      ++steps_run;
      max_zone_rounds = std::max(max_zone_rounds, report.zone_rounds);
      zone_steps += report.zone_rounds > 0;
      removed += report.removed;
      carried_along += report.carried_along;
      stalled += report.stalled;
      for (const SurfaceMotion& s : scene.layers) minimum = std::min(minimum, report.min_distance / s.delta);
      const Vec3 gained = momentum(scene) - before + report.momentum_removed + report.impulse_on_prescribed;
      ASSERT_LE(gained.norm(), 1e-12 * scale + 1e-300) << "step " << step;
      if (c.pins == 0 && step % 10 == 0) {
        ASSERT_EQ(ContactSolver::count_crossings(motion, scene.surfaces), 0u) << "step " << step;
      }
      scene.particles.drop_removed();
      scene.particles.x_t0 = scene.particles.x_t1;
      for (SurfaceMotion& s : scene.layers) s.x_t0 = s.x_t1;
    }
  }
  if (c.policy == Infeasible::stall) {
    EXPECT_EQ(removed, 0u);
    EXPECT_EQ(carried_along, 0u) << "nothing needs giving up where everything that moves may be held";
  }
  EXPECT_GT(zone_steps, 0u) << "the squeezing is too soft to test zones";
  EXPECT_GE(minimum, 1 - 1e-9);
  test::record("steps", steps_run);
  test::record("steps with zones", zone_steps);
  test::record("most zone rounds", max_zone_rounds);
  test::record("smallest distance [δ]", minimum);
  test::record("stalled", stalled);
  test::record("removed", removed);
}

INSTANTIATE_TEST_SUITE_P(
    Hosts, Squeezing,
    ::testing::Values(
        Case{"float_at_1m", Storage::float32, 1, 1500, 0, true, true, Infeasible::stall},
        Case{"float_at_10m", Storage::float32, 10, 1500, 0, true, false, Infeasible::stall},
        Case{"float_at_100m", Storage::float32, 100, 1500, 0, true, true, Infeasible::stall},
        Case{"double_at_10m", Storage::float64, 10, 1000, 0, true, false, Infeasible::stall},
        Case{"float_pins_agree", Storage::float32, 10, 1500, 0.05, true, true, Infeasible::stall},
        Case{"float_pins_differ", Storage::float32, 10, 1500, 0.05, false, false, Infeasible::stall},
        Case{"float_pins_differ_remove", Storage::float32, 10, 500, 0.05, false, false, Infeasible::remove},
        Case{"double_half_pinned", Storage::float64, 1, 1000, 0.5, false, true, Infeasible::stall},
        Case{"float_pins_over_a_floor", Storage::float32, 10, 1500, 0.2, false, false, Infeasible::stall,
             true}),
    [](const ::testing::TestParamInfo<Case>& instance) { return instance.param.name; });

}  // namespace
}  // namespace oilskin
