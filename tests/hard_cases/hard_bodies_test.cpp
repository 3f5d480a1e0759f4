// Hard cases 57 and 58: dynamic rigid bodies.
#include <gtest/gtest.h>

#include "hard_cases/hard_case.h"
#include "hard_cases/water.h"
#include "support/mock_body.h"
#include "support/mock_cloth.h"
#include "support/trace_watch.h"

namespace oilskin::test {
namespace {

using namespace water;

constexpr double block_mass = 6 * 4 * 6 * 1.25e-4;  // of the water between the plates [kg]

struct Closed {
  std::uint64_t findings = 0, removed = 0;
  double momentum_error = 0, speed = 0, energy = 0;
};

/// Two free plates close on a block of water at 2 m/s each, and nothing but the water is between them.
void close_plates(double below, double above, Closed& found) {
  World w(world_of(2, Vec3::Zero()), solver_of(PressureSolver::dfsph, true));
  MockBody plates[2];
  for (int k = 0; k < 2; ++k) {
    plates[k].mass = block_mass * (k == 0 ? below : above);
    plates[k].half = {0.03, 0.01, 0.03};
    plates[k].center.y() = k == 0 ? -0.025 : 0.025;
    plates[k].velocity.y() = k == 0 ? 2 : -2;
    ASSERT_TRUE(w.attach(plates[k], sheet_settings(), nullptr).ok());
  }
  fill(w, lattice(6, 4, 6, Vec3(-0.0125, -0.0075, -0.0125)));
  TraceWatch watch;
  w.set_observer(&watch);
  const double start = plates[0].kinetic_energy() + plates[1].kinetic_energy();
  const double scale = plates[0].momentum().norm() + plates[1].momentum().norm();
  for (int k = 0; k < 60; ++k) {
    const StepReport& r = w.step(0.002);
    ASSERT_TRUE(r.status.ok()) << r.status.message;
    found.removed += r.contact.removed;
    found.momentum_error = std::max(found.momentum_error, r.momentum_residual().norm() / scale);
  }
  found.findings += watch.judge().findings();
  double energy = plates[0].kinetic_energy() + plates[1].kinetic_energy();
  for (const Vec3& v : w.velocities()) energy += 0.5 * w.particle_mass() * v.squaredNorm();
  // A plate that weighs nothing is stopped only after its step, and the water has moved with it until then.
  const double carried_along = 0.5 * block_mass * 2 * 2;
  found.energy = std::max(found.energy, energy / (start + carried_along));
  for (const Vec3& v : w.velocities()) found.speed = std::max(found.speed, v.norm());
  for (const MockBody& plate : plates) found.speed = std::max(found.speed, plate.velocity.norm());
}

TEST(HardMotion, free_plates_of_any_mass_close_on_water_and_nothing_crosses) {
  Closed found;
  for (double below : {1e-6, 1., 1e6})
    for (double above : {1e-6, 1., 1e6}) close_plates(below, above, found);
  HardCase c("57", "two free bodies of 1e-6, 1 and 1e6 times the water's mass close on it at 2 m/s each");
  c.equal("findings of the auditor", found.findings, 0);
  c.at_most("momentum error", found.momentum_error, 1e-10);
  c.at_most("energy at the end, of the bodies' at the start and that of the water at their speed",
            found.energy, 1);
  c.note("particles removed, of 1296", found.removed);
  c.note("largest speed at the end [m/s]", found.speed);
}

/// Water lies on a body that lies on nothing but water and cloth; the body is deleted, then the cloth.
TEST(HardMotion, a_body_and_cloth_that_are_deleted_wet_leave_their_water_to_fall) {
  World w(world_of(2), solver_of(PressureSolver::dfsph, true));
  MockCloth<double> cloth(GridShape{13, 13, Vec3(-0.06, 0, -0.06), Vec3(0.12, 0, 0), Vec3(0, 0, 0.12), 0.5});
  cloth.gravity = Vec3(0, -g, 0);
  for (std::size_t i = 0; i < cloth.x.size(); ++i) cloth.pin(i);
  auto body = std::make_unique<MockBody>();
  body->mass = 0.05;
  body->half = {0.02, 0.01, 0.02};
  body->center = {0, 0.035, 0};
  body->gravity = Vec3(0, -g, 0);
  SurfaceId of_cloth, of_body;
  ASSERT_TRUE(w.attach(cloth, sheet_settings(), &of_cloth).ok());
  ASSERT_TRUE(w.attach(*body, sheet_settings(), &of_body).ok());
  fill(w, lattice(8, 4, 8, Vec3(-0.0175, 0.004, -0.0175)));
  fill(w, lattice(6, 4, 6, Vec3(-0.0125, 0.05, -0.0125)));
  TraceWatch watch;
  w.set_observer(&watch);
  const std::size_t before = w.particle_count();
  double speed = 0, fastest = 0;
  for (int k = 0; k < 90; ++k) {
    if (k == 30) {
      w.detach(of_body);
      body.reset();
    }
    if (k == 60) w.detach(of_cloth);
    const StepReport& r = w.step(0.002);
    ASSERT_TRUE(r.status.ok()) << r.status.message;
    speed = 0;
    for (const Vec3& v : w.velocities()) speed = std::max(speed, v.norm());
    fastest = std::max(fastest, speed);
  }
  HardCase c("58", "water above and below a body on cloth: the body is deleted, then the cloth is detached");
  c.equal("findings of the auditor", watch.judge().findings(), 0);
  c.equal("particles", w.particle_count(), before);
  c.below("largest speed, of free fall from the start", fastest / (g * 0.18), 1.5);
}

}  // namespace
}  // namespace oilskin::test
