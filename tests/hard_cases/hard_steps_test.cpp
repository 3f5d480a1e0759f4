// Hard cases 9, 9b, 10, 11, 48: steps far too long and far too short, ten thousand of them, gravity.
#include <gtest/gtest.h>

#include <cmath>

#include "hard_cases/cloth_scene.h"
#include "hard_cases/hard_case.h"
#include "support/random.h"

namespace oilskin::test {
namespace {

TEST(HardMotion, between_layers_nearer_than_the_thickness_particles_come_to_rest_without_jitter) {
  HardCase c("9", "h = 5 mm, layers 3 mm apart, triangles of 2 mm, dx = 1 mm; 120 steps");
  Found all;
  double start_speed = 0, end_speed = 0, late_jitter = 0;
  for (const HostKind& host : host_kinds) {
    SCOPED_TRACE(host.name);
    ContactScene scene;  // h = 5 mm ≫ dx = 1 mm, triangles of 2 mm, layers 3 mm apart
    scene.spacing = 0.001;
    for (int k = 0; k < 3; ++k) {
      scene.surfaces.push_back(make_grid(11, 11, Vec3(-0.01, 0.003 * k, -0.01), Vec3(0.02, 0, 0),
                                         Vec3(0, 0, 0.02), host.free ? 1e-2 : 0, 0.005, 2, host.storage,
                                         static_cast<std::uint64_t>(k + 1)));
    }
    Random random(9);
    for (int k = 0; k < 40; ++k)
      scene.particles.add(
          Vec3(random.uniform(-0.008, 0.008), 0.003 * (k % 2) + random.uniform(0.0002, 0.0028),
               random.uniform(-0.008, 0.008)),
          Vec3(0, random.uniform(-0.5, 0.5), 0), 1e-6);
    start_speed = std::max(start_speed, max_speed(scene.particles.velocity));
    CheckedContact check(scene);
    double early = 0, late = 0;
    for (int k = 0; k < 120; ++k) {
      const std::vector<Vec3> before = check.scene.particles.x_t0;
      check.run(1);
      double displacement = 0;
      for (std::size_t i = 0; i < before.size(); ++i)
        displacement = std::max(displacement, std::abs((check.scene.particles.x_t0[i] - before[i]).y()));
      if (k >= 5 && k < 25) early = std::max(early, displacement);
      if (k >= 100) late = std::max(late, displacement);
    }
    all.add(check.found);
    EXPECT_EQ(check.scene.particles.id.size(), 40u);
    late_jitter = std::max(late_jitter, late / early);
    end_speed = std::max(end_speed, max_speed(check.scene.particles.velocity));
  }
  c.note("speed at the start [m/s]", start_speed);
  c.below("speed at the end [m/s]", end_speed, 0.02 * start_speed);
  c.at_most("displacement a step at the end, of that at the start", late_jitter, 1);
  c.no_crossings(all);
}

TEST(HardMotion, sliding_ten_thousand_steps_at_delta_keeps_the_tangential_velocity) {
  HardCase c("9b", "10,000 steps along a sheet from 1.01 δ on, free slip");
  double worst = 0, minimum = 1;
  Found all;
  for (const HostKind& host : {host_kinds[0], host_kinds[2]})
    for (Repulsion repulsion : {Repulsion::none, Repulsion::split}) {
      SCOPED_TRACE(std::string(host.name) + (repulsion == Repulsion::none ? ", no repulsion" : ", split"));
      ContactScene scene;
      scene.surfaces = {
          make_grid(41, 3, Vec3(-1, 0, -0.05), Vec3(2, 0, 0), Vec3(0, 0, 0.1), 0, 0.002, 2, host.storage)};
      scene.settings.repulsion = repulsion;
      const double delta = scene.surfaces[0].delta;
      const Vec3 v(0.17, 0, 0.0031);
      scene.particles.add(Vec3(-0.9, 1.01 * delta, -0.02), v, particle_mass);
      CheckedContact check(scene);
      for (int k = 0; k < 10000 && !HasFatalFailure(); ++k) {
        check.run(1);
        worst = std::max(worst, (check.scene.particles.velocity[0] - v).norm() / v.norm());
        minimum = std::min(minimum, check.scene.particles.x_t0[0].y() / delta);
      }
      EXPECT_NEAR(check.scene.particles.x_t0[0].x(), -0.9 + 1.7, 1e-6);
      all.add(check.found);
    }
  c.at_most("relative change of the velocity", worst, 1e-6);
  c.note("smallest distance [δ]", minimum);
  c.no_crossings(all);
}

struct Dropped {
  Found found;
  double energy_gain = -1;      ///< above the start's, relative
  double faster_than_fall = 0;  ///< largest kinetic energy over that of free fall since the start
  double contact_gain = -1;     ///< of contact in a step, over the kinetic energy after it
};

// A block of water falls on a sheet. Energy is kinetic and potential (of the water, from 2 m below on),
// without the springs of the cloth, which begin at rest.
template <class Scalar>
Dropped drop_block(bool pinned, double dt, int steps, double g) {
  ClothSetup setup;
  setup.pinned = pinned;
  setup.world.gravity = Vec3(0, -g, 0);
  if (dt > 1)
    setup.stiffness = 1e-3;  // so that the mock's own steps are few; without damping they are stable
  Dropped dropped;
  double start = 0, mass = 0;
  const auto measure = [&](ClothScene<Scalar>& s, int k) {
    World& w = s.world();
    double kinetic = 0, potential = 0;
    for (std::size_t i = 0; i < w.particle_count(); ++i) {
      kinetic += 0.5 * w.particle_mass() * w.velocities()[i].squaredNorm();
      potential += w.particle_mass() * g * (w.positions()[i].y() + 2);
    }
    for (const auto& cloth : s.cloths)
      for (std::size_t i = 0; i < cloth->x.size(); ++i)
        if (cloth->inverse_mass[i] > 0)
          kinetic += 0.5 * cloth->v[i].template cast<double>().squaredNorm() /
                     static_cast<double>(cloth->inverse_mass[i]);
    if (k == 0) {
      start = potential;
      mass = w.particle_mass() * static_cast<double>(w.particle_count());
    }
    if (k == 0 || g == 0) return;
    dropped.energy_gain = std::max(dropped.energy_gain, (kinetic + potential) / start - 1);
    dropped.faster_than_fall =
        std::max(dropped.faster_than_fall, kinetic / (0.5 * mass * std::pow(g * dt * k, 2)));
    dropped.contact_gain = std::max(dropped.contact_gain, w.report().contact.kinetic_energy_change / kinetic);
    EXPECT_LE(w.report().contact.kinetic_energy_change, max_energy_gain * kinetic);
  };
  const auto make = [&](int threads) {
    return std::make_unique<ClothScene<Scalar>>(
        setup, threads,
        [dt](ClothScene<Scalar>& s) {
          if (dt > 1) s.cloths[0]->damping = 0;
          add_block(s.world(), 8, Vec3(-0.02, 0.004, -0.02), Vec3::Zero());
        },
        measure);
  };
  dropped.found = run_checked(make, steps, dt);
  return dropped;
}

TEST(HardMotion,
     steps_a_hundred_and_ten_thousand_times_too_long_let_nothing_cross_and_contact_gains_no_energy) {
  HardCase c("10", "a block of water on pinned and free sheets, dt = 0.1 s and 10 s");
  Found all;
  double gain = -1, on_pins = 0, on_free = 0, contact_gain = -1;
  for (bool pinned : {true, false})
    for (double dt : {0.1, 10.0}) {
      SCOPED_TRACE(std::string(pinned ? "pinned" : "free") + ", dt " + shown(dt));
      const int steps = dt > 1 ? 3 : 8;
      for (const Dropped& d :
           {drop_block<float>(pinned, dt, steps, 9.81), drop_block<double>(pinned, dt, steps, 9.81)}) {
        all.add(d.found);
        contact_gain = std::max(contact_gain, d.contact_gain);
        double& faster = pinned ? on_pins : on_free;
        faster = std::max(faster, d.faster_than_fall);
        if (pinned) gain = std::max(gain, d.energy_gain);
      }
    }
  // On pins the impulse of the weight in so long a step is turned sideways by the pressure: the energy grows,
  // but stays below that of free fall. Free nodes that contact moves by centimetres stretch the springs of
  // the mock.
  c.note("paths", all.audit.particles);
  c.no_crossings(all);
  c.at_most("contact's energy gain in a step, relative", contact_gain, max_energy_gain);
  c.at_most("kinetic energy on pins, of free fall's", on_pins, 1);
  c.note("kinetic energy on free sheets, of free fall's", on_free);
  c.note("energy on pins, relative to the start's", 1 + gain);
}

TEST(HardMotion, gravity_of_zero_moves_nothing_and_a_thousand_g_crushes_nothing_through) {
  HardCase c("48", "gravity 0 and 1,000 g on a block over pinned and free sheets");
  double speed = 0, gain = -1;
  Found all;
  for (bool pinned : {true, false}) {
    SCOPED_TRACE(pinned ? "pinned" : "free");
    for (const Dropped& d : {drop_block<float>(pinned, 1e-3, 15, 0), drop_block<double>(pinned, 1e-3, 15, 0)})
      speed = std::max(speed, d.found.speed);
    for (const Dropped& d :
         {drop_block<float>(pinned, 1e-3, 15, 9810), drop_block<double>(pinned, 1e-3, 15, 9810)}) {
      all.add(d.found);
      if (pinned) gain = std::max(gain, d.energy_gain);
    }
  }
  // Steps are a hundred times too long for the pressure solver here: its energy has no limit.
  c.below("speed at 0 g [m/s]", speed, 0.05);
  c.note("paths at 1,000 g", all.audit.particles);
  c.no_crossings(all);
  c.at_most("momentum error", all.momentum_error, max_momentum_error);
  c.note("energy at 1,000 g on pins, relative to the start's", 1 + gain);
}

TEST(HardMotion, a_step_of_a_nanosecond_ejects_nothing_and_steps_of_zero_or_less_are_refused) {
  HardCase c("11", "dt = 1e-9 and 1e-12 s with particles from 2 δ to h of a sheet; dt = 0, dt < 0");
  double speed = 0, displacement = 0;
  std::uint64_t accepted = 0;
  Found all;
  for (const HostKind& host : host_kinds)
    for (double dt : {1e-9, 1e-12}) {
      SCOPED_TRACE(host.name);
      ContactScene scene;
      scene.dt = dt;
      scene.surfaces = {square_sheet(host)};
      Random random(3);
      for (int k = 0; k < 100; ++k) {
        const double d = random.log_uniform(2 * scene.surfaces[0].delta, 0.001);
        scene.particles.add(Vec3(random.uniform(-0.02, 0.02), k % 2 ? d : -d, random.uniform(-0.02, 0.02)),
                            Vec3::Zero(), particle_mass);
      }
      const std::vector<Vec3> start = scene.particles.x_t0;
      CheckedContact check(scene);
      check.run(1);
      all.add(check.found);
      speed = std::max(speed, max_speed(check.scene.particles.velocity));
      for (std::size_t i = 0; i < start.size(); ++i)
        displacement = std::max(displacement, (check.scene.particles.x_t0[i] - start[i]).norm());
      for (double bad : {0.0, -1e-3}) {
        ContactReport report;
        StageSeconds seconds;
        ParticleMotion motion = scene.particles.motion();
        const std::vector<SurfaceMotion*> list = scene.surface_list();
        accepted += ContactSolver().resolve(bad, motion, list, report, seconds).ok();
      }
    }
  c.at_most("speed [m/s]", speed, 1);
  c.note("moved out by [m]", displacement);
  c.equal("steps of zero or less that are accepted", accepted, 0);
}

}  // namespace
}  // namespace oilskin::test
