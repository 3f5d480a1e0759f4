// Hard cases 17, 18, 33, 34: layers that close on particles, stiff repulsion, friction.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "hard_cases/hard_case.h"
#include "support/random.h"

namespace oilskin::test {
namespace {

TEST(HardMotion, particles_pinched_between_two_free_layers_stop_them_or_escape_and_never_cross) {
  HardCase c("17", "1 and 30 particles between two free layers that close at 1 to 1,000 m/s, 20 steps");
  Found all;
  std::uint64_t inside = 0, number = 0, lost = 0;
  for (Storage storage : {Storage::float32, Storage::float64})
    for (double speed : {0.5, 20.0, 500.0})
      for (int particles : {1, 30})
        for (bool movable : {true, false}) {
          SCOPED_TRACE("at " + shown(speed) + " m/s, " + count(static_cast<std::uint64_t>(particles)));
          ContactScene scene;
          for (int l : {0, 1}) {
            SurfaceMotion s = square_sheet({"", storage, true});
            s.id = static_cast<std::uint64_t>(l + 1);
            s.nodes_movable = movable;
            lift(s, l ? 0.008 : -0.008);
            for (Vec3& v : s.velocity) v = Vec3(0, l ? -speed : speed, 0);
            scene.surfaces.push_back(s);
          }
          Random random(17);
          for (int k = 0; k < particles; ++k)
            scene.particles.add(Vec3(random.uniform(-0.015, 0.015), random.uniform(-0.002, 0.002),
                                     random.uniform(-0.015, 0.015)),
                                Vec3::Zero(), particle_mass);
          CheckedContact check(scene);
          check.run(20);
          all.add(check.found);
          number += static_cast<std::uint64_t>(particles);
          for (const Vec3& x : check.scene.particles.x_t0)
            inside += std::max(std::abs(x.x()), std::abs(x.z())) < 0.02;
          lost += static_cast<std::uint64_t>(particles) - check.scene.particles.id.size();
        }
  c.no_crossings(all);
  c.equal("particles lost", lost, 0);
  c.note("particles", number);
  c.note("of these still between the layers", inside);
  c.at_most("momentum error", all.momentum_error, max_momentum_error);
}

TEST(HardMotion, prescribed_layers_that_close_to_zero_gap_follow_the_policy_and_are_counted) {
  HardCase c("18", "prescribed layers close to zero gap on 40 particles, by policy");
  for (const auto& [policy, holdable, name] :
       {std::tuple<Infeasible, bool, const char*>{Infeasible::stall, true, "stall, pins"},
        {Infeasible::stall, false, "stall, not holdable"},
        {Infeasible::remove, true, "remove"},
        {Infeasible::allow, false, "allow"}}) {
    Found all;
    std::uint64_t alive = 0;
    double gap = 0;
    for (Storage storage : {Storage::float32, Storage::float64}) {
      SCOPED_TRACE(name);
      ContactScene scene;
      scene.settings.infeasible = policy;
      for (int l : {0, 1}) {
        SurfaceMotion s = square_sheet({"", storage, false});
        s.id = static_cast<std::uint64_t>(l + 1);
        s.holdable.assign(s.x_t0.size(), holdable ? 1 : 0);
        lift(s, l ? 0.01 : 0);
        scene.surfaces.push_back(s);
      }
      Random random(18);
      for (int k = 0; k < 20; ++k)
        scene.particles.add(
            Vec3(random.uniform(-0.015, 0.015), random.uniform(0.003, 0.007), random.uniform(-0.015, 0.015)),
            Vec3::Zero(), particle_mass);
      CheckedContact check(scene);
      for (int k = 1; k <= 12 && !HasFatalFailure(); ++k) {
        ContactScene& now = check.scene;
        now.particles.move(now.dt);
        SurfaceMotion& upper = now.surfaces[1];
        for (std::size_t i = 0; i < upper.x_t0.size(); ++i) {  // the user wants it there, held or not
          upper.x_t1[i] =
              stored(Vec3(upper.x_t0[i].x(), 0.001 * std::max(0, 10 - k), upper.x_t0[i].z()), storage);
          upper.velocity[i] = (upper.x_t1[i] - upper.x_t0[i]) / now.dt;
        }
        check.resolve();
        check.advance();
      }
      all.add(check.found);
      alive += check.scene.particles.id.size();
      gap = std::max(gap, check.scene.surfaces[1].x_t0[12].y());
      EXPECT_EQ(check.found.total.removed + check.scene.particles.id.size(), 20u) << "all are accounted for";
    }
    const std::string policy_name = std::string(name) + ", ";
    const bool stalls = policy == Infeasible::stall && holdable,
               keeps = stalls || policy == Infeasible::allow;
    c.note(policy_name + "removed", all.total.removed);
    if (keeps) {
      c.equal(policy_name + "alive of 40", alive, 40);
    } else {
      c.note(policy_name + "alive of 40", alive);
    }
    if (stalls) {
      c.above(policy_name + "stalled", static_cast<double>(all.total.stalled), 0);
      c.above(policy_name + "gap [m]", gap, 0);
    } else {
      c.equal(policy_name + "stalled", all.total.stalled, 0);
      c.at_most(policy_name + "gap [m]", gap, 0);
    }
    if (policy == Infeasible::allow)
      c.above(policy_name + "crossings allowed", static_cast<double>(all.total.allowed), 0);
  }
}

TEST(HardMotion, repulsion_of_1e9_newtons_per_metre_separates_no_faster_than_a_tenth_of_the_overlap_a_step) {
  HardCase c("33", "spring repulsion with k = 1e9 N/m, dt = 1e-4 to 1e-2 s, one particle and 50");
  Found all;
  double ratio = 0, crowd = 0;
  for (const HostKind& host : host_kinds)
    for (double dt : {1e-4, 1e-3, 1e-2})
      for (int particles : {1, 50}) {
        SCOPED_TRACE(std::string(host.name) + ", dt " + shown(dt));
        Random random(33);
        for (int k = 0; k < (particles == 1 ? 30 : 1); ++k) {
          ContactScene scene;
          scene.dt = dt;
          scene.settings.repulsion = Repulsion::bridson;
          scene.settings.stiffness = 1e9;
          scene.surfaces = {square_sheet(host)};
          for (int i = 0; i < particles; ++i)
            scene.particles.add(Vec3(random.uniform(-0.018, 0.018), random.uniform(0.0001, 0.0009),
                                     random.uniform(-0.018, 0.018)),
                                Vec3(0, random.uniform(-2, 0), 0), particle_mass);
          CheckedContact check(scene);
          check.scene.move();
          check.resolve();
          all.add(check.found);
          for (const Contact& r : check.contacts) {
            const double capped = 0.1 * (0.001 - r.distance) / dt;
            if (!(capped > 0)) continue;
            double& maximum = particles == 1 ? ratio : crowd;
            maximum = std::max(maximum, normal_speed(check.scene, r) / capped);
          }
        }
      }
  c.at_most("separation, of 0.1 d/dt, one particle", ratio, 1 + 1e-9);
  c.note("separation, of 0.1 d/dt, 50 that share a light sheet", crowd);
  c.no_crossings(all);
}

TEST(HardMotion, friction_of_0_1_1e9_and_infinity_gains_no_energy_and_infinity_sticks) {
  HardCase c("34", "Coulomb friction 0, 1, 1e9 and infinity on pinned and free sheets");
  Found all;
  double slides = 0, sticks = 0;
  const double inf = std::numeric_limits<double>::infinity();
  for (const HostKind& host : host_kinds)
    for (double friction : {0.0, 1.0, 1e9, inf}) {
      SCOPED_TRACE(std::string(host.name) + ", friction " + shown(friction));
      ContactScene scene;
      scene.surfaces = {square_sheet(host, 0.08, 9)};
      scene.surfaces[0].slip.model = SlipModel::coulomb;
      scene.surfaces[0].slip.friction = friction;
      Random random(34);
      for (int k = 0; k < 40; ++k)
        scene.particles.add(
            Vec3(random.uniform(-0.03, 0.0), random.uniform(0.0004, 0.003), random.uniform(-0.03, 0.03)),
            Vec3(random.uniform(1, 3), -2, 0), particle_mass);
      CheckedContact check(scene);
      for (int k = 0; k < 8; ++k) {
        for (Vec3& v : check.scene.particles.velocity) v.y() -= 0.05;  // pressed on
        check.run(1);
      }
      all.add(check.found);
      if (host.free) continue;
      double& maximum = friction == 0 ? slides : sticks;
      if (friction == 0 || friction == inf)
        for (const Vec3& v : check.scene.particles.velocity)
          maximum = std::max(maximum, std::hypot(v.x(), v.z()));
    }
  c.at_most("energy gain", all.energy_gain, max_energy_gain);
  c.above("speed on pins, friction 0 [m/s]", slides, 0.99);
  c.below("speed on pins, friction infinity [m/s]", sticks, 1e-9);
}

}  // namespace
}  // namespace oilskin::test
