// The balance of energies on cases with a known result: what is made is zero, or the loss of an inelastic
// impact.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "oilskin/force_fields.h"
#include "support/busy_scene.h"
#include "support/mock_body.h"
#include "world/driven_sheet.h"

namespace oilskin::test {
namespace {

FluidSettings plain() {
  FluidSettings s;
  s.xsph_rate = 0;
  s.viscosity = 0;
  s.boundary = BoundaryModel::contact_only;
  s.max_substeps = 1;
  return s;
}

/// Particles too far from each other to interact.
void add_apart(World& w, int count, const Vec3& at, const Vec3& velocity) {
  std::vector<Vec3> x, v;
  for (int k = 0; k < count; ++k) {
    x.push_back(at + Vec3(0.02 * k, 0.003 * k, 0));
    v.push_back(velocity + Vec3(0, 0.1 * k, 0));
  }
  std::uint64_t blocked = 0;
  ASSERT_TRUE(w.add_particles(x, v, &blocked).ok());
  ASSERT_EQ(blocked, 0u);
}

double total(const EnergyReport& e) {
  return e.water_kinetic + e.water_potential + e.node_kinetic + e.node_potential;
}

/// Made, from the other fields.
double made_by_balance(const EnergyReport& e) {
  return total(e) + e.transfer + e.left_kinetic + e.left_potential - e.entered_kinetic - e.entered_potential -
         e.work_prescribed - e.work_host - e.work_outside;
}

TEST(Energy, free_fall_makes_none_at_any_step) {
  for (const double dt : {1e-3, 1.0 / 60}) {
    World w(box(100, Vec3(0.3, -9.81, 0)), plain());
    add_apart(w, 5, Vec3(-0.1, 50, 0), Vec3(1, 2, 0));
    const int steps = static_cast<int>(1 / dt);
    for (int k = 0; k < steps; ++k) w.step(dt);
    const EnergyReport& e = w.report().energy;
    EXPECT_GT(e.released_potential, 4 * e.entered_kinetic);
    EXPECT_NEAR(e.made, 0, 1e-12 * e.scale);
    EXPECT_NEAR(made_by_balance(e), 0, 1e-11 * e.scale);
    EXPECT_EQ(e.work_prescribed, 0);
    EXPECT_EQ(e.work_host, 0);
    EXPECT_NEAR(e.scale, e.released_potential, 1e-12 * e.scale);
    for (std::size_t i = 0; i < w.particle_count(); ++i)
      EXPECT_LT((w.motions()[i] - w.velocities()[i]).norm(), 1e-11);
  }
}

TEST(Energy, the_speed_of_free_fall_in_substeps_is_that_of_their_number) {
  World w(box(10, Vec3(0, -9.81, 0)), cut_into(64));
  add_apart(w, 1, Vec3(0, 5, 0), Vec3::Zero());
  for (int k = 0; k < 60; ++k) w.step(0.01);
  const EnergyReport& e = w.report().energy;
  EXPECT_GT(w.report().substeps, 20);
  // Symplectic Euler: each change of the interval's length by Δ changes the energy by Δ g·u/2, a loss in
  // fall.
  EXPECT_LT(e.made, 0);
  EXPECT_GT(e.made, -0.02 * e.scale);
}

TEST(Energy, an_inelastic_stop_at_a_rigid_sheet_loses_the_kinetic_energy) {
  for (const int substeps : {1, 16}) {
    FluidSettings fluid = plain();
    fluid.max_substeps = substeps;
    World w(box(1), fluid);
    StaticMesh plate;
    plate.add_rectangle(Vec3(-0.1, 0, -0.1), Vec3(0.2, 0, 0), Vec3(0, 0, 0.2));
    ASSERT_TRUE(w.attach(plate, sheet_settings(), nullptr).ok());
    add_apart(w, 1, Vec3(0.02, 0.0123, 0.01), Vec3(0, -2, 0));
    for (int k = 0; k < 20; ++k) w.step(1e-3);
    const EnergyReport& e = w.report().energy;
    const double kinetic = 0.5 * w.particle_mass() * 4;
    EXPECT_NEAR(e.entered_kinetic, kinetic, 1e-12 * kinetic);
    EXPECT_NEAR(e.water_kinetic, 0, 1e-12 * kinetic);
    EXPECT_NEAR(e.made, -kinetic, 1e-12 * kinetic);
    EXPECT_EQ(e.work_prescribed, 0);
    EXPECT_NEAR(e.risen, 0, 1e-12 * kinetic);
  }
}

TEST(Energy, a_moving_plate_does_twice_the_work_that_a_particle_at_rest_keeps) {
  for (const int substeps : {1, 4}) {
    FluidSettings fluid = plain();
    fluid.max_substeps = substeps;
    World w(box(1), fluid);
    Driven plate(0.1);
    plate.storage = Storage::float64;
    ASSERT_TRUE(w.attach(plate, sheet_settings(), nullptr).ok());
    add_apart(w, 1, Vec3(0.02, 0.0123, 0.01), Vec3::Zero());
    const double speed = 3;
    for (int k = 0; k < 20; ++k) {
      plate.move(Vec3(0, speed * 1e-3, 0));
      w.step(1e-3);
    }
    const EnergyReport& e = w.report().energy;
    const double kinetic = 0.5 * w.particle_mass() * speed * speed;
    EXPECT_NEAR(e.water_kinetic, kinetic, 1e-9 * kinetic);
    EXPECT_NEAR(e.work_prescribed, 2 * kinetic, 1e-9 * kinetic);
    EXPECT_NEAR(e.made, -kinetic, 1e-9 * kinetic);
    EXPECT_NEAR(e.scale, 2 * kinetic, 1e-9 * kinetic);
    EXPECT_NEAR(made_by_balance(e), e.made, 1e-12 * kinetic);
  }
}

/// A particle rests on the plate, which falls faster and faster, by a part of g, and then stops.
TEST(Energy, a_plate_that_slows_down_or_falls_faster_makes_none) {
  const double g = 9.81, dt = 1e-3;
  FluidSettings fluid = plain();
  fluid.max_substeps = 1;
  World w(box(10, Vec3(0, -g, 0)), fluid);
  Driven plate(0.1);
  plate.storage = Storage::float64;
  ASSERT_TRUE(w.attach(plate, sheet_settings(), nullptr).ok());
  add_apart(w, 1, Vec3(0.02, 0.0123, 0.01), Vec3::Zero());
  double speed = 0, start = 0;
  for (int k = 0; k < 700; ++k) {
    if (k == 200) start = w.report().energy.made;  // it has landed
    if (k >= 200 && k < 400) speed += 0.5 * g * dt;
    if (k >= 500 && speed > 0) speed = std::max(0.0, speed - 0.5 * g * dt);
    plate.move(Vec3(0, -speed * dt, 0));
    w.step(dt);
  }
  const EnergyReport& e = w.report().energy;
  ASSERT_EQ(w.particle_count(), 1u);
  EXPECT_LT(e.work_prescribed, -0.5 * w.particle_mass() * g * 0.1) << "the plate took its energy";
  EXPECT_LT(e.made - start, 1e-9 * e.scale);
  EXPECT_LT(e.risen, 1e-9 * e.scale);
}

TEST(Energy, emitters_bring_theirs_and_removal_takes_it_away) {
  const Vec3 gravity(0, -9.81, 0);
  World w(box(0.5, gravity), plain());
  RainEmitter rain;
  rain.corner = Vec3(-0.4, 0.4, -0.4);
  rain.edge_u = Vec3(0.8, 0, 0);
  rain.edge_v = Vec3(0, 0, 0.8);
  rain.drops_per_second = 300;
  rain.velocity = Vec3(0.5, -1, 0);
  ASSERT_TRUE(w.add_emitter(rain).ok());
  double emitted = 0, removed = 0;
  for (int k = 0; k < 400; ++k) {
    w.step(2e-3);
    emitted += w.report().mass_emitted;
    removed += w.report().mass_removed;
  }
  const EnergyReport& e = w.report().energy;
  ASSERT_GT(removed, 0.2 * emitted);
  EXPECT_NEAR(e.entered_kinetic, 0.5 * emitted * 1.25, 1e-12 * e.entered_kinetic);
  EXPECT_NEAR(made_by_balance(e), e.made, 1e-10 * e.scale);
  // A start within an interval of dt is off by r (dt − r) g²/2 at most.
  EXPECT_NEAR(e.made, 0, emitted * 9.81 * 9.81 * 2e-3 * 2e-3 / 8);
  EXPECT_LT(std::abs(e.made_fraction()), 1e-4);
  EXPECT_GT(e.left_kinetic, 5 * removed);
  EXPECT_EQ(w.report().removed_too_fast, 0u);
}

TEST(Energy, what_a_force_field_does_explains_the_speed_of_what_leaves) {
  WorldSettings settings;
  settings.gravity.setZero();
  settings.kill_box = {Vec3::Constant(-0.5), Vec3::Constant(0.5)};
  World w(settings);
  ForceFields fields;
  ASSERT_TRUE(w.add_effect(fields).ok());
  UniformForce force;
  force.acceleration = Vec3(10, 0, 0);
  ASSERT_TRUE(fields.add(force).ok());
  ASSERT_TRUE(w.add_particles(std::vector<Vec3>{Vec3(-0.1, 0, 0)}, std::vector<Vec3>{Vec3::Zero()}).ok());
  for (int k = 0; k < 200 && w.particle_count() > 0; ++k) w.step(2e-3);
  EXPECT_EQ(w.particle_count(), 0u);
  EXPECT_EQ(w.report().removed, 1u);
  EXPECT_EQ(w.report().removed_too_fast, 0u);
}

/// Splashes rise above where the water came from: a few particles have the energy of many.
TEST(Energy, a_splash_that_leaves_is_not_too_fast) {
  for (const auto& [speed, is_too_fast] : {std::pair<double, bool>{5, false}, {12, true}}) {
    WorldSettings settings = under_gravity();
    settings.kill_box = {Vec3::Constant(-0.5), Vec3::Constant(0.5)};
    World w(settings);
    ASSERT_TRUE(w.add_particles(std::vector<Vec3>{Vec3(0, 0.4, 0), Vec3(0.2, -0.45, 0)},
                                std::vector<Vec3>(2, Vec3::Zero()))
                    .ok());
    w.step(1e-3);
    std::vector<Vec3> push(2, Vec3::Zero());
    push[w.positions()[0].y() > 0 ? 0 : 1].y() = speed;
    ASSERT_TRUE(w.add_velocities(push).ok());
    std::uint64_t too_fast = 0;
    for (int k = 0; k < 30; ++k) too_fast += w.step(1e-3).removed_too_fast;
    EXPECT_EQ(w.particle_count(), 1u);
    EXPECT_EQ(too_fast, is_too_fast ? 1u : 0u) << speed;
  }
}

TEST(Energy, made_by_a_thick_surface_is_not_blamed_on_the_step) {
  World w(box(1, Vec3(0, -9.81, 0)), of_spacing(0.01));
  StaticMesh tank;
  tank.add_box({Vec3(-0.04, 0, -0.04), Vec3(0.04, 0.2, 0.04)}, 1);
  ASSERT_TRUE(w.attach(tank, sheet_settings(0.009), nullptr).ok());
  add_block(w, 6, Vec3(-0.025, 0.01, -0.025), Vec3::Zero());
  std::string message;
  for (int k = 0; k < 500 && message.empty(); ++k)
    for (const std::string& m : w.step(2e-3).messages)
      if (m.find("energy made") != std::string::npos) message = m;
  EXPECT_NE(message.find("9 mm thick"), std::string::npos) << message;
  EXPECT_NE(message.find("5 mm"), std::string::npos) << message;
}

/// A body brings its energy when it is attached, wherever the origin is.
TEST(Energy, of_a_body_that_is_attached_enters) {
  for (const double height : {-1.0, 0.0, 3.0}) {
    WorldSettings settings;
    settings.kill_box = {Vec3::Constant(-5), Vec3::Constant(5)};
    World w(settings);
    MockBody body;
    body.mass = 2;
    body.gravity = settings.gravity;
    body.center.y() = height;
    body.velocity = Vec3(0.5, 0, 0);
    SurfaceId id;
    ASSERT_TRUE(w.attach(body, sheet_settings(), &id).ok());
    for (int k = 0; k < 10; ++k) w.step(1e-3);
    const EnergyReport& e = w.report().energy;
    EXPECT_NEAR(e.work_host, 0, 0.02) << "J: it falls by 0.5 mm";
    EXPECT_NEAR(e.entered_potential, 2 * (9.81 * height + 0.125), 0.02);
    EXPECT_LT(e.scale, 0.1);
  }
}

/// Nodes that fly straight on, unless their owner pushes them.
class Loose : public SurfaceHost {
 public:
  std::vector<Vec3> x = {Vec3(0, 0, 0), Vec3(5, 0, 0), Vec3(0, 0, 5)}, v = std::vector<Vec3>(3, Vec3::Zero());
  Vec3 force = Vec3::Zero();  ///< on each node [N]
  double mass = 1e-4;         ///< [kg]

  Gathered gather(double dt, SurfaceMotion& m) override {
    const bool is_new = m.triangles.empty();
    m.triangles = {{0, 2, 1}};
    m.storage = Storage::float64;
    m.nodes_movable = false;
    for (std::size_t j = 0; j < x.size(); ++j) {
      v[j] += dt / mass * force;
      x[j] += dt * v[j];
    }
    m.x_t1 = x;
    m.velocity = v;
    m.inverse_mass.assign(3, 1 / mass);
    m.holdable.assign(3, 0);
    return {Status{}, is_new};
  }
  void scatter(SurfaceMotion& m) override {
    for (std::size_t j = 0; j < x.size(); ++j) {
      v[j] += m.impulse[j] / mass;
      if (m.moved[j]) x[j] = m.x_t1[j];
      m.x_t1[j] = x[j];
    }
  }
};

TEST(Energy, the_work_of_a_host_is_force_times_way) {
  World w(box(10), plain());
  Loose sheet;
  sheet.force = Vec3(0, 1e-3, 0);
  ASSERT_TRUE(w.attach(sheet, sheet_settings(), nullptr).ok());
  const double dt = 1e-3;
  for (int k = 0; k < 200; ++k) w.step(dt);
  const EnergyReport& e = w.report().energy;
  // The speeds are those in the middle of a step: the way is that to the middle of the last one.
  const double way = sheet.x[0].y() - 0.5 * dt * sheet.v[0].y();
  EXPECT_NEAR(e.work_host, 3 * 1e-3 * way, 1e-12 * e.work_host);
  EXPECT_NEAR(e.node_kinetic, 3 * 0.5 * sheet.mass * sheet.v[0].squaredNorm(), 1e-12 * e.work_host);
  EXPECT_EQ(e.made, 0);
}

TEST(Energy, an_impact_on_a_free_node_loses_what_the_reduced_mass_has) {
  for (const double mass : {1e-6, 1e-4, 1e-2}) {
    World w(box(10), plain());
    Loose sheet;
    sheet.mass = mass;
    ASSERT_TRUE(w.attach(sheet, sheet_settings(), nullptr).ok());
    add_apart(w, 1, Vec3(1e-9, 0.0123, 1e-9), Vec3(0, -2, 0));
    for (int k = 0; k < 10; ++k) w.step(1e-3);
    const EnergyReport& e = w.report().energy;
    const double m = w.particle_mass(), loss = 0.5 * 4 / (1 / m + 1 / mass);
    // The sheet turns by 1e-3, and the particle slides on it.
    EXPECT_NEAR(e.made, -loss, 1e-5 * e.scale) << mass;
    EXPECT_NEAR(e.work_host, 0, 1e-12 * e.scale) << mass;
    EXPECT_NEAR(total(e), 0.5 * 4 * m - loss, 1e-5 * e.scale) << mass;
    EXPECT_LT(e.risen, 1e-4 * e.scale) << mass;
  }
}

TEST(Energy, a_change_of_gravity_and_of_velocities_is_work_from_outside) {
  World w(box(10, Vec3(0, -9.81, 0)), plain());
  add_apart(w, 3, Vec3(0.3, 5, 0), Vec3(1, 0, 0));
  for (int k = 0; k < 50; ++k) w.step(2e-3);
  ASSERT_TRUE(w.set_gravity(Vec3(4, 0, 1)).ok());
  for (int k = 0; k < 50; ++k) w.step(2e-3);
  ASSERT_TRUE(w.add_velocities(std::vector<Vec3>(3, Vec3(0, 0, 7))).ok());
  const double before = w.report().energy.work_outside;
  w.step(2e-3);
  const EnergyReport& e = w.report().energy;
  EXPECT_GT(e.work_outside - before, 20 * 3 * w.particle_mass());
  EXPECT_NEAR(e.made, 0, 1e-12 * std::abs(e.work_outside));
}

TEST(Energy, motions_are_displacements_where_stored_velocities_are_not) {
  BusyScene<double> scene(busy_world(1), cut_into(1));
  scene.add_emitters();
  const World& w = scene.world;
  double different = 0;
  for (int k = 0; k < 40; ++k) {
    std::map<std::uint64_t, Vec3> before;
    for (std::size_t i = 0; i < w.particle_count(); ++i) before[w.ids()[i]] = w.positions()[i];
    const double dt = scene.step(k).dt;
    for (std::size_t i = 0; i < w.particle_count(); ++i) {
      const auto start = before.find(w.ids()[i]);
      if (start == before.end()) continue;
      EXPECT_LT((w.positions()[i] - start->second - dt * w.motions()[i]).norm(), 1e-15);
      different = std::max(different, (w.motions()[i] - w.velocities()[i]).norm());
    }
  }
  EXPECT_GT(different, 0.1);
}

/// Everything at once: the balance closes, with any number of threads, after a save, and in sub-steps.
TEST(Energy, closes_in_a_busy_world_bit_for_bit_with_any_number_of_threads) {
  for (const int substeps : {1, 3}) {
    FluidSettings fluid;
    fluid.max_substeps = substeps;
    BusyScene<float> one(busy_world(1), fluid), three(busy_world(3), fluid);
    for (auto* scene : {&one, &three}) scene->add_emitters();
    for (int k = 0; k < 40; ++k) {
      const EnergyReport a = one.step(k).energy, b = three.step(k).energy;
      EXPECT_EQ(a.made, b.made);
      EXPECT_EQ(a.work_host, b.work_host);
      EXPECT_EQ(a.node_kinetic, b.node_kinetic);
      EXPECT_EQ(a.risen, b.risen);
      EXPECT_NEAR(made_by_balance(a), a.made, 1e-9 * (a.scale + std::abs(a.work_host) + total(a)));
    }
    std::vector<std::uint8_t> bytes;
    ASSERT_TRUE(one.world.save(&bytes).ok());
    const auto hosts = one.host_state();
    ASSERT_TRUE(three.world.restore(bytes).ok());
    three.set_host_state(hosts);
    EXPECT_EQ(one.step(40).energy.made, three.step(40).energy.made);
    EXPECT_EQ(one.world.report().energy.risen, three.world.report().energy.risen);
    EXPECT_EQ(one.world.motions().size(), three.world.motions().size());
    EXPECT_EQ(one.world.motions()[5], three.world.motions()[5]);
  }
}

/// The advice on energy made when a block of water hits a free cloth with the speed given, if there was any.
std::string advice_after_impact(double areal_density, double speed) {
  FluidSettings fluid = plain();
  fluid.spacing = 0.01;
  World w(box(10, Vec3(0, -9.81, 0)), fluid);
  GridShape grid;
  grid.areal_density = areal_density;
  MockCloth<double> cloth(grid);
  for (const std::size_t corner : {0u, 8u, 72u, 80u}) cloth.pin(corner);
  EXPECT_TRUE(w.attach(cloth, sheet_settings(), nullptr).ok());
  std::vector<Vec3> x;
  for (int n = 0; n < 5 * 5 * 5; ++n) x.push_back(0.01 * Vec3(2.5 + n % 5, 1 + n / 5 % 5, 2.5 + n / 25));
  EXPECT_TRUE(w.add_particles(x, std::vector<Vec3>(x.size(), Vec3(0, -speed, 0))).ok());
  for (int k = 0; k < 20; ++k) {
    const StepReport& r = w.step(1.0 / 60);
    for (const std::string& m : r.messages)
      if (m.find("energy made: the cloth") != std::string::npos) return m;
  }
  return "";
}

TEST(Energy, advice_names_steps_only_where_a_program_could_take_them) {
  const std::string light = advice_after_impact(0.02, 1), fast = advice_after_impact(0.2, 30);
  EXPECT_NE(light.find(" steps a frame of 1/60 s, or ≥ "), std::string::npos) << light;
  EXPECT_EQ(fast.find("steps a frame"), std::string::npos) << fast;
  EXPECT_NE(fast.find("impact"), std::string::npos) << fast;
  EXPECT_EQ(fast.find("e+"), std::string::npos) << fast;
}

}  // namespace
}  // namespace oilskin::test
