// Hard case 45b: a nozzle that is teleported.
#include <gtest/gtest.h>

#include <cmath>

#include "hard_cases/hard_case.h"
#include "hard_cases/water.h"
#include "support/mock_cloth.h"
#include "support/random.h"
#include "support/trace_watch.h"

namespace oilskin::test {
namespace {

using namespace water;

/// Above, below and within a pinned cloth.
TEST(HardFluid, a_nozzle_is_teleported_through_cloth_in_every_step) {
  World w(world_of(0.3), solver_of(PressureSolver::dfsph));
  MockCloth<float> cloth(GridShape{13, 13, Vec3(-0.15, 0, -0.15), Vec3(0.3, 0, 0), Vec3(0, 0, 0.3), 0.5});
  cloth.gravity = Vec3(0, -g, 0);
  for (std::size_t i = 0; i < cloth.x.size(); ++i)
    if (i % 13 == 0 || i % 13 == 12 || i < 13 || i >= 156) cloth.pin(i);
  ASSERT_TRUE(w.attach(cloth, sheet_settings(), nullptr).ok());
  TraceWatch watch;
  w.set_observer(&watch);
  DiscEmitter nozzle;
  nozzle.radius = 0.0121;
  nozzle.speed = 3;
  EmitterId id;
  ASSERT_TRUE(w.add_emitter(nozzle, &id).ok());
  Random random(11);
  double momentum_error = 0, speed = 0;
  std::uint64_t emitted = 0, blocked = 0, findings = 0;
  for (int k = 0; k < 150; ++k) {
    const double height = k % 3 == 0 ? 0 : random.uniform(-0.08, 0.08);
    const Vec3 place(random.uniform(-0.1, 0.1), height, random.uniform(-0.1, 0.1));
    ASSERT_TRUE(w.place_emitter(id, place, random.direction()).ok());
    const StepReport& r = w.step(0.004);
    emitted += r.emitted;
    blocked += r.blocked_starts;
    momentum_error = std::max(momentum_error, r.momentum_residual().norm() / (w.fluid_mass() * 3));
    speed = std::max(speed, fastest(w));
    if (k % 20 == 19 || k == 149) findings += watch.judge().findings();
  }
  const double asked = w.time() * 3 * 3.14159265358979323846 * nozzle.radius * nozzle.radius;
  const double lost = static_cast<double>(blocked) * w.particle_mass() / 1000;
  HardCase c("45b",
             "a nozzle is teleported above, below and into a pinned cloth, in each of 150 steps of 4 ms");
  c.equal("findings of the auditor", findings, 0);
  c.note("starts blocked by the cloth", blocked);
  c.equal("particles that the emitter counts, less those of the reports", w.emitter(id)->particles - emitted,
          0);
  c.at_most("flow, error", std::abs((w.emitter(id)->volume + lost) / asked - 1), 0.005);
  c.at_most("momentum error", momentum_error, 1e-11);
  c.note("largest speed, of water that starts within water [m/s]", speed);
}

}  // namespace
}  // namespace oilskin::test
