// Implicit viscosity at walls: clinging, the reaction on cloth, threads and saved worlds.
#include <gtest/gtest.h>

#include <cmath>

#include "effects/honey_world.h"
#include "effects/viscosity/wall_drag.h"
#include "support/mock_cloth.h"
#include "world/saved_bytes.h"

namespace oilskin {
namespace {

using namespace test;

// The second sum is that of the traction across, three times as large in an isotropic operator.
TEST(ViscousWallDrag, layers_of_a_lattice_feel_the_traction_of_a_linear_profile) {
  for (double ratio : {1.5, 1.6, 2.0, 2.5, 4.0}) {
    const effects::WallDrag drag(ratio);
    double along = 0, across = 0;
    for (int k = 0; k + 0.5 < ratio; ++k) {
      along += 2 / ratio * drag((k + 0.5) / ratio).along;
      across += 2 / ratio * drag((k + 0.5) / ratio).across;
    }
    EXPECT_NEAR(along, 1, 1e-12);
    EXPECT_NEAR(across, 3, 1e-12);
    for (double z = 0; z < 1; z += 0.01) {
      EXPECT_GE(drag(z).along, drag(z + 0.01).along) << ratio;
      EXPECT_GE(drag(z).across, drag(z + 0.01).across) << ratio;
    }
    EXPECT_EQ(drag(1).along, 0);
    EXPECT_EQ(drag(2).across, 0);
  }
}

/// How far a block sinks along a sheet within `seconds` [m]; `tilt` from the vertical, the block on top.
double sinks(SlipModel slip, double nu, double tilt, double seconds, double slip_length = 0) {
  constexpr double dx = 0.005;
  const Vec3 down(-std::sin(tilt), -std::cos(tilt), 0);  // the sheet is the plane x = 0
  World w(world_of(gravity * down), fluid_of(dx));
  ImplicitViscosity viscosity({nu});
  EXPECT_TRUE(w.add_effect(viscosity).ok());
  StaticMesh wall;
  wall.add_rectangle(Vec3(0, -0.5, -0.1), Vec3(0, 0.7, 0), Vec3(0, 0, 0.2), 70, 20);
  SurfaceSettings s = sheet(slip);
  s.slip.slip_length = slip_length;
  EXPECT_TRUE(w.attach(wall, s, nullptr).ok());
  fill(w, lattice(3, 8, 8, dx, Vec3(0, 0, -4 * dx)), at_rest);
  const double start = middle(w).y();
  while (w.time() < seconds - 1e-9) EXPECT_TRUE(w.step(1e-3).status.ok());
  EXPECT_EQ(w.particle_count(), 192u);
  return start - middle(w).y();
}

TEST(ViscousWall, honey_clings_to_a_sheet_without_slip_and_falls_along_one_with) {
  for (double tilt : {0.0, 0.5}) {
    const double clings = sinks(SlipModel::viscous_wall, 0.5, tilt, 0.2);
    const double sticks = sinks(SlipModel::sticking, 0.5, tilt, 0.2);
    const double falls = sinks(SlipModel::free, 0.5, tilt, 0.2);
    record("sinks without slip [m]", clings);
    record("sinks where it sticks [m]", sticks);
    record("sinks with free slip [m]", falls);
    EXPECT_NEAR(falls, 0.5 * gravity * std::cos(tilt) * 0.04, 0.02 * falls) << "free fall";
    EXPECT_LT(clings, falls / 40) << tilt;
    EXPECT_LT(sticks, falls / 40) << tilt;
  }
}

// The drag of a thin film is that of its slip length: μ v/ℓ carries its weight.
TEST(ViscousWall, the_slip_length_sets_the_speed_of_a_film) {
  constexpr double nu = 1, length = 0.1, depth = 0.015;
  const double exact = gravity * depth * length / nu;  // [m/s], the profile within the film apart
  const double later = sinks(SlipModel::viscous_wall, nu, 0, 0.2, length);
  const double earlier = sinks(SlipModel::viscous_wall, nu, 0, 0.1, length);
  record("speed over that of the slip length", (later - earlier) / 0.1 / exact);
  EXPECT_NEAR((later - earlier) / 0.1, exact, 0.15 * exact);
}

struct Sinking {
  double distance = 0, speed = 0;  ///< after 0.2 s [m, m/s]
};

/// A block of 10 kg/m² on a light sheet that hangs from its upper edge.
Sinking sinks_on_hanging_cloth(SlipModel slip, double areal_density) {
  constexpr double dx = 0.005;
  constexpr std::uint32_t n = 17;
  World w(world_of(Vec3(0, -gravity, 0)), fluid_of(dx));
  ImplicitViscosity viscosity({0.5});
  EXPECT_TRUE(w.add_effect(viscosity).ok());
  MockCloth<double> cloth(
      GridShape{n, n, Vec3(0, 0.03, -0.04), Vec3(0, -0.08, 0), Vec3(0, 0, 0.08), areal_density});
  cloth.gravity = Vec3(0, -gravity, 0);
  cloth.stiffness = 2000;
  cloth.damping = 0.01;
  for (std::size_t k = 0; k < n; ++k) cloth.pin(k * n);
  EXPECT_TRUE(w.attach(cloth, sheet(slip), nullptr).ok());
  fill(w, lattice(2, 6, 6, dx, Vec3(0, -0.005, -3 * dx)), at_rest);
  const double start = middle(w).y();
  while (w.time() < 0.2 - 1e-9) {
    const StepReport& r = w.step(1e-3);
    EXPECT_TRUE(r.status.ok());
    EXPECT_LE(r.momentum_residual().norm(), 1e-14);
  }
  EXPECT_EQ(w.particle_count(), 72u);
  return {start - middle(w).y(), -fluid_momentum(w).y() / (72 * w.particle_mass())};
}

// The host of light cloth holds it within each step: what it holds is learned, or the liquid would slip at 50
// cm/s.
TEST(ViscousWall, honey_clings_to_hanging_cloth) {
  const Sinking falls = sinks_on_hanging_cloth(SlipModel::free, 0.5);
  const Sinking clings = sinks_on_hanging_cloth(SlipModel::viscous_wall, 0.2);
  record("sinks, of free fall", clings.distance / falls.distance);
  record("speed, of free fall", clings.speed / falls.speed);
  EXPECT_LT(clings.distance, 0.15 * falls.distance);
  EXPECT_LT(std::abs(clings.speed), 0.05 * falls.speed);
  EXPECT_GT(falls.distance, 0.15);
}

// Drag across and along the walls carries a part of the weight, pressure the rest.
TEST(ViscousWall, a_column_stands_and_presses_with_its_weight) {
  constexpr double dx = 0.005;
  World w(world_of(Vec3(0, -gravity, 0)), fluid_of(dx));
  ImplicitViscosity viscosity({0.1});
  ASSERT_TRUE(w.add_effect(viscosity).ok());
  StaticMesh box;
  box.add_box({Vec3::Zero(), Vec3(6 * dx, 16 * dx, 6 * dx)}, 4 * dx);
  SurfaceId id;
  ASSERT_TRUE(w.attach(box, sheet(SlipModel::viscous_wall), &id).ok());
  fill(w, lattice(6, 10, 6, dx, Vec3::Zero()), at_rest);
  const double start = middle(w).y();
  double force = 0, speed = 0;
  for (int k = 0; k < 300; ++k) {
    ASSERT_TRUE(w.step(1e-3).status.ok());
    if (k < 200) continue;
    for (const Vec3& impulse : w.surface(id)->impulse) force -= impulse.y() / 0.1;
    speed = std::max(speed, fastest(w));
  }
  double deepest = 0, count = 0;
  for (std::size_t i = 0; i < w.particle_count(); ++i)
    if (w.positions()[i].y() < dx) deepest += w.pressures()[i], ++count;
  const double weight = static_cast<double>(w.particle_count()) * w.particle_mass() * gravity;
  record("force over weight", force / weight);
  record("sinks [dx]", (start - middle(w).y()) / dx);
  record("speed [m/s]", speed);
  record("pressure of the lowest layer over that of its depth",
         deepest / count / (9.5 * dx * 1000 * gravity));
  EXPECT_NEAR(force, weight, 0.01 * weight);
  EXPECT_LT(start - middle(w).y(), 0.1 * dx);
  EXPECT_LT(speed, 0.01);
}

/// Of a film of depth D from rest on a sheet without slip, by implicit Euler, (B.38).
double film(double y, double depth, double gx, double nu, double dt, int steps) {
  double v = gx * y * (depth - 0.5 * y) / nu;
  for (int n = 0; n < 400; ++n) {
    const double k = (2 * n + 1) * M_PI / (2 * depth);
    v -= 2 * gx / (nu * depth * k * k * k) * std::sin(k * y) * std::pow(1 + nu * k * k * dt, -steps);
  }
  return v;
}

TEST(ViscousWall, a_film_on_an_incline_has_the_profile_of_implicit_euler) {
  constexpr double dx = 0.005, nu = 0.1, dt = 1e-3;
  constexpr int layers = 5, steps = 12;
  const double gx = 3, depth = layers * dx;
  World w(world_of(Vec3(gx, -gravity, 0)), fluid_of(dx));
  ImplicitViscosity viscosity({nu});
  ASSERT_TRUE(w.add_effect(viscosity).ok());
  StaticMesh floor;
  floor.add_rectangle(Vec3(-0.2, 0, -0.2), Vec3(0.4, 0, 0), Vec3(0, 0, 0.4), 40, 40);
  ASSERT_TRUE(w.attach(floor, sheet(SlipModel::viscous_wall), nullptr).ok());
  fill(w, lattice(26, layers, 12, dx, Vec3(-13 * dx, 0, -6 * dx)), at_rest);
  for (int k = 0; k < steps; ++k) ASSERT_TRUE(w.step(dt).status.ok());
  // Means over a layer's middle: the film flattens, too, to both sides alike.
  std::vector<double> speed(layers, 0), count(layers, 0);
  for (std::size_t i = 0; i < w.particle_count(); ++i) {
    const Vec3& x = w.positions()[i];
    const auto layer = static_cast<std::size_t>(x.y() / dx);
    if (layer >= speed.size() || std::abs(x.x()) > 3 * dx || std::abs(x.z()) > 3 * dx) continue;
    speed[layer] += w.velocities()[i].x();
    ++count[layer];
  }
  double worst = 0;
  for (std::size_t k = 0; k < speed.size(); ++k)
    worst = std::max(worst, std::abs(speed[k] / count[k] -
                                     film((static_cast<double>(k) + 0.5) * dx, depth, gx, nu, dt, steps)));
  const double peak = gx * depth * depth / (2 * nu);
  record("largest deviation over the steady peak", worst / peak);
  EXPECT_LT(worst, 0.06 * peak);
}

/// A block slides along a free sheet of light cloth.
struct Slide {
  World world;
  MockCloth<double> cloth;
  ImplicitViscosity viscosity;
  SurfaceId id;

  explicit Slide(int threads = 1, double areal_density = 0.01, double nu = 1,
                 const FluidSettings& fluid = fluid_of())
      : world(world_of(Vec3::Zero(), threads), fluid),
        cloth(GridShape{17, 17, Vec3(-0.04, 0, -0.04), Vec3(0.08, 0, 0), Vec3(0, 0, 0.08), areal_density}),
        viscosity({nu}) {
    cloth.stiffness = 2e4 * areal_density;  // explicit: as soft as the mass allows
    cloth.damping = 0.2 * areal_density;
    EXPECT_TRUE(world.add_effect(viscosity).ok());
    EXPECT_TRUE(world.attach(cloth, sheet(SlipModel::viscous_wall), &id).ok());
  }
  void add_block() {
    fill(world, lattice(6, 4, 6, 0.00505, Vec3(-0.015, 0.0002, -0.015)),
         [](const Vec3&) { return Vec3(0.5, 0, 0); });
  }
  double energy() const {
    double sum = kinetic_energy(world);
    for (std::size_t i = 0; i < cloth.x.size(); ++i)
      sum += 0.5 * cloth.v[i].squaredNorm() / cloth.inverse_mass[i];
    return sum;
  }
  double fastest_node() const {
    double speed = 0;
    for (const Vec3& v : cloth.v) speed = std::max(speed, v.norm());
    return speed;
  }
};

void expect_taken_along(double areal_density, const FluidSettings& fluid, int substeps) {
  Slide s(1, areal_density, 1, fluid);
  s.add_block();
  const Vec3 momentum = fluid_momentum(s.world);
  double speed = 0;
  const double start = s.energy();
  for (int k = 0; k < 40; ++k) {
    const StepReport& r = s.world.step(1e-3);
    ASSERT_TRUE(r.status.ok());
    if (k == 0) EXPECT_EQ(r.substeps, substeps);
    ASSERT_LE(r.momentum_residual().norm(), 1e-14);
    ASSERT_LE(r.momentum_effects.norm(), 1e-14);
    ASSERT_LE((fluid_momentum(s.world) + s.cloth.momentum() - momentum).norm(), 1e-13);
    ASSERT_LE(s.energy(), start);
    speed = std::max(speed, s.fastest_node());
  }
  record("fastest node at " + std::to_string(areal_density) + " kg/m², " + std::to_string(substeps) +
             " sub-steps [m/s]",
         speed);
  EXPECT_LE(speed, 1) << "waves of its springs reach 0.7 m/s";
  EXPECT_GT(s.cloth.momentum().x(), 0);
}

TEST(ViscousWall, light_cloth_is_taken_along_and_never_flung) {
  for (double areal_density : {1e-4, 0.01, 1.0}) expect_taken_along(areal_density, fluid_of(), 1);
}

// The host moves its cloth in a straight line through a step, so the motion does not show what the sub-steps
// before gave it. Each of them would give it all anew.
TEST(ViscousWall, fluid_substeps_take_light_cloth_along_once) {
  FluidSettings fluid = fluid_of();
  fluid.cfl = 0.02;
  fluid.max_substeps = 5;
  for (double areal_density : {0.01, 1.0}) expect_taken_along(areal_density, fluid, 5);
}

TEST(ViscousWall, threads_and_saving_change_no_bit) {
  Slide one(1), two(2), other(2, 0.01, 0.5);
  one.add_block(), two.add_block();
  const auto step = [](Slide& s) { ASSERT_TRUE(s.world.step(1e-3).status.ok()); };
  for (int k = 0; k < 10; ++k) {
    step(one), step(two);
    ASSERT_EQ(one.world.state_hash(), two.world.state_hash()) << k;
  }
  const Bytes bytes = save(one.world);
  const Status status = other.world.restore(bytes);
  ASSERT_TRUE(status.ok()) << status.message;
  other.cloth.x = one.cloth.x, other.cloth.v = one.cloth.v;
  EXPECT_EQ(other.viscosity.settings().coefficient, 1);
  EXPECT_EQ(save(other.world), bytes);
  for (int k = 0; k < 10; ++k) {
    step(one), step(other);
    ASSERT_EQ(one.world.state_hash(), other.world.state_hash()) << k;
  }
  EXPECT_EQ(save(one.world), save(other.world));
}

TEST(ViscousWall, saved_settings_that_make_no_sense_are_refused) {
  ImplicitViscosity viscosity({0.5, 1e-3, 7}), other;
  std::vector<std::uint8_t> bytes = viscosity.save();
  ASSERT_TRUE(other.restore(bytes).ok());
  EXPECT_EQ(other.settings().coefficient, 0.5);
  EXPECT_EQ(other.settings().tolerance, 1e-3);
  EXPECT_EQ(other.settings().max_iterations, 7);
  std::vector<std::uint8_t> longer = bytes, negative = bytes;
  longer.push_back(0);
  EXPECT_FALSE(other.restore(longer).ok());
  bytes.pop_back();
  EXPECT_FALSE(other.restore(bytes).ok());
  negative[7] ^= 0x80;  // the sign of the coefficient
  EXPECT_FALSE(other.restore(negative).ok());
  EXPECT_EQ(other.settings().coefficient, 0.5);
}

}  // namespace
}  // namespace oilskin
