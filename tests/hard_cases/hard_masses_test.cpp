// Hard cases 12, 19, 20, 23: extreme masses.
#include <gtest/gtest.h>

#include <cmath>

#include "hard_cases/hard_case.h"
#include "support/random.h"

namespace oilskin::test {
namespace {

constexpr double impact_speed = 5;  // [m/s]

// Particles that hit a sheet from both sides at up to impact_speed, `ratio` times as heavy as its nodes.
ContactScene hail(double ratio, Storage storage) {
  ContactScene scene;
  scene.surfaces = {make_grid(5, 5, Vec3(-0.02, 0, -0.02), Vec3(0.04, 0, 0), Vec3(0, 0, 0.04),
                              particle_mass / ratio, 0.001, 2, storage)};
  Random random(5);
  for (int k = 0; k < 24; ++k) {
    const double side = k % 3 ? 1 : -1;
    scene.particles.add(
        Vec3(random.uniform(-0.02, 0.02), side * random.uniform(0.0005, 0.004), random.uniform(-0.02, 0.02)),
        Vec3(0, -impact_speed * side, 0) + random.in_cube(1), particle_mass);
  }
  scene.move();
  return scene;
}

// How fast contacts still approach, of the speed of the impact.
struct Approach {
  std::uint64_t contacts = 0, faster = 0;  ///< all, and those above 1e-3
  double largest = 0;

  void look_at(const ContactScene& scene, const std::vector<Contact>& list) {
    for (const Contact& contact : list) {
      const double approach = -normal_speed(scene, contact) / impact_speed;
      ++contacts;
      faster += approach > 1e-3;
      largest = std::max(largest, approach);
    }
  }
};

// Solves the contacts of the start alone, without continuous test and zones.
void solve_contacts(ContactScene scene, Approach& approach) {
  scene.settings.ccd = scene.settings.zones = false;
  ContactSolver solver(scene.settings, 1);
  ParticleMotion motion = scene.particles.motion(scene.spacing);
  const std::vector<SurfaceMotion*> list = scene.surface_list();
  ContactReport report;
  StageSeconds seconds;
  ASSERT_TRUE(solver.resolve(scene.dt, motion, list, report, seconds).ok());
  approach.look_at(scene, solver.contacts());
}

TEST(HardMotion, mass_ratios_of_1e_minus_12_to_1e12_keep_momentum_and_energy) {
  HardCase c("12", "particles on free nodes, mass ratios 1e-12 to 1e12");
  Found all;
  Approach solved, light, heavy;
  for (Storage storage : {Storage::float32, Storage::float64})
    for (double ratio : {1e-12, 1e-6, 1e-3, 1.0, 1e3, 1e6, 1e12}) {
      SCOPED_TRACE("m_p/m_i " + shown(ratio));
      solve_contacts(hail(ratio, storage), solved);
      CheckedContact check(hail(ratio, storage));
      check.resolve();
      (ratio <= 1 ? light : heavy).look_at(check.scene, check.contacts);
      check.advance();
      check.run(4);
      all.add(check.found);
    }
  c.at_most("momentum error", all.momentum_error, max_momentum_error);
  c.at_most("energy gain", all.energy_gain, max_energy_gain);
  c.no_crossings(all);
  c.above("contacts at the start", static_cast<double>(solved.contacts), 50);
  c.at_most("fastest approach after 5 iterations, of the impact", solved.largest, 1e-3);
  // Later impacts and zones change the velocities of nodes that earlier contacts share.
  c.at_most("after all impacts, particles not heavier than nodes", light.largest, 0.01);
  c.note("after all impacts, heavier particles", heavy.largest);
  c.note("of their contacts", heavy.contacts);
  c.note("approaching faster than 1e-3", heavy.faster);
}

TEST(HardMotion, all_pinned_all_free_and_one_pin_balance_momentum_with_reactions) {
  HardCase c("19", "40 particles on a sheet all pinned, all free, one pin");
  Found all;
  double least_k = std::numeric_limits<double>::infinity();
  Vec3 reaction[3];
  for (Storage storage : {Storage::float32, Storage::float64})
    for (int mode : {0, 1, 2}) {
      SCOPED_TRACE(mode == 0 ? "all pinned" : mode == 1 ? "all free" : "one pin");
      ContactScene scene;
      scene.surfaces = {square_sheet({"", storage, mode != 0})};
      if (mode == 2) scene.surfaces[0].inverse_mass[12] = 0;
      Random random(6);
      for (int k = 0; k < 40; ++k)
        scene.particles.add(
            Vec3(random.uniform(-0.018, 0.018), random.uniform(0.0005, 0.004), random.uniform(-0.018, 0.018)),
            Vec3(0, -4, 0), particle_mass);
      CheckedContact check(scene);
      check.scene.move();
      check.resolve();
      for (const Contact& r : check.contacts) {
        double k = 1 / particle_mass;
        for (int i = 0; i < 3; ++i)
          k += r.weights[i] * r.weights[i] * check.scene.surfaces[0].inverse_mass[r.nodes[i]];
        least_k = std::min(least_k, k * particle_mass);
      }
      reaction[mode] = check.report.impulse_on_prescribed;
      check.advance();
      check.run(5);
      all.add(check.found);
    }
  c.at_most("momentum error with reactions", all.momentum_error, max_momentum_error);
  c.at_least("K m_p", least_k, 1);
  c.above("reaction, all pinned, over that of one pin", reaction[0].y() / reaction[2].y(), 1);
  c.above("reaction, one pin [N s]", -reaction[2].y(), 0);
  c.at_most("reaction, all free [N s]", reaction[1].norm(), 0);
}

TEST(HardMotion, particles_of_infinite_mass_are_never_moved_and_nothing_is_divided_by_zero) {
  HardCase c("20", "particles of infinite mass at rest on, and driven through, pinned and free sheets");
  Found all;
  std::uint64_t stalled = 0, removed = 0, removed_at_free = 0, moved = 0;
  for (const HostKind& host : host_kinds)
    for (bool holdable : {false, true}) {
      SCOPED_TRACE(std::string(host.name) + (holdable ? ", holdable" : ""));
      ContactScene scene;
      scene.surfaces = {square_sheet(host)};
      scene.surfaces[0].holdable.assign(scene.surfaces[0].x_t0.size(), holdable ? 1 : 0);
      scene.particles.add(Vec3(0.003, 0.0006, 0.004), Vec3::Zero(), 0);      // at rest within the thickness
      scene.particles.add(Vec3(-0.011, 0.02, 0.004), Vec3(0, -40, 0), 0);    // driven through
      scene.particles.add(Vec3(0.011, 0.002, -0.004), Vec3(0, -1.5, 0), 0);  // driven into the thickness
      CheckedContact check(scene);
      check.scene.move();
      const std::vector<Vec3> proposed = check.scene.particles.x_t1;
      const std::vector<Vec3> velocity = check.scene.particles.velocity;
      check.resolve();
      moved += check.scene.particles.x_t1 != proposed || check.scene.particles.velocity != velocity;
      stalled += check.report.stalled;
      (host.free ? removed_at_free : removed) += check.report.removed;
      check.advance();
      check.run(3);
      all.add(check.found);
    }
  c.equal("moved or accelerated", moved, 0);
  c.note("removed at pins", removed);
  c.equal("removed at free sheets", removed_at_free, 0);
  c.note("pins stalled", stalled);
  c.no_crossings(all);
}

TEST(HardMotion, denormal_velocities_and_masses_give_no_nan_and_masses_beyond_range_are_refused) {
  HardCase c("23", "masses of 1e-300 kg, velocities of 1e-310 m/s; masses whose inverse overflows");
  Found all;
  std::uint64_t refused = 0;
  for (Storage storage : {Storage::float32, Storage::float64})
    for (double mass : {1e-300, 1e-150, particle_mass})
      for (double sheet_mass : {0.0, 1e-300, 1e-4})
        for (double speed : {1e-310, 1e-160, 3.0}) {
          SCOPED_TRACE("m " + shown(mass) + ", node " + shown(sheet_mass) + ", v " + shown(speed));
          ContactScene scene;
          scene.surfaces = {make_grid(3, 3, Vec3(-0.02, 0, -0.02), Vec3(0.04, 0, 0), Vec3(0, 0, 0.04),
                                      sheet_mass, 0.001, 2, storage)};
          for (double y : {0.0006, 0.001, 0.002})
            scene.particles.add(Vec3(0.003, y, 0.004), Vec3(0, -speed, speed), mass);
          CheckedContact check(scene);
          check.run(3);
          all.add(check.found);
        }
  for (double bad : {5e-324, 1e-310}) {  // 1/m overflows
    ContactScene scene;
    scene.surfaces = {square_sheet(host_kinds[2])};
    scene.particles.add(Vec3(0, 0.002, 0), Vec3::Zero(), bad);
    ContactReport report;
    StageSeconds seconds;
    ParticleMotion motion = scene.particles.motion();
    const std::vector<SurfaceMotion*> list = scene.surface_list();
    const Status s = ContactSolver().resolve(1e-3, motion, list, report, seconds);
    EXPECT_NE(s.message.find("inverse_mass[0] is inf"), std::string::npos) << s.message;
    ++refused;
  }
  c.note("intervals without NaN", all.intervals);
  c.equal("masses out of range that are refused", refused, 2);
}

}  // namespace
}  // namespace oilskin::test
