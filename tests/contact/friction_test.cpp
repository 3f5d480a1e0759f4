// The viscous wall law against its closed form, over how much wall it acts, and the two sides of a surface.
#include <gtest/gtest.h>

#include <cmath>

#include "support/find_contacts.h"
#include "support/particle_arrays.h"
#include "support/random.h"

namespace oilskin {
namespace {

using test::ParticleArrays;
using test::Random;

constexpr double dx = 0.005, mass = 1.25e-4, density = 1000, viscosity = 2e-3;

SurfaceMotion mesh(const std::vector<Vec3>& nodes, const std::vector<Triangle>& triangles,
                   double node_mass = 0, double thickness = 0.001, std::uint64_t id = 1) {
  SurfaceMotion s;
  s.id = id;
  s.x_t0 = s.x_t1 = nodes;
  s.triangles = triangles;
  s.velocity.assign(nodes.size(), Vec3::Zero());
  s.inverse_mass.assign(nodes.size(), node_mass > 0 ? 1 / node_mass : 0);
  s.thickness = thickness;
  s.delta = minimum_separation(thickness, 1, Storage::float64);
  s.slip.model = SlipModel::viscous_wall;
  return s;
}

/// A square of two triangles over ±0.1 m; its normals point to +y.
SurfaceMotion square(double node_mass = 0, double thickness = 0.001, double y = 0, std::uint64_t id = 1) {
  return mesh({{-0.1, y, -0.1}, {-0.1, y, 0.1}, {0.1, y, -0.1}, {0.1, y, 0.1}}, {{0, 1, 2}, {1, 3, 2}},
              node_mass, thickness, id);
}

ContactReport resolve(double dt, ParticleArrays& p, std::vector<SurfaceMotion>& surfaces,
                      const ContactSettings& settings = {}) {
  std::vector<SurfaceMotion*> pointers;
  for (SurfaceMotion& s : surfaces) pointers.push_back(&s);
  ParticleMotion motion = p.motion(dx);
  motion.rest_density = density;
  motion.viscosity = viscosity;
  ContactReport report;
  StageSeconds seconds;
  EXPECT_TRUE(ContactSolver(settings, 1).resolve(dt, motion, pointers, report, seconds).ok());
  return report;
}

/// The area of wall that the drag of one short step on a particle at `x` stands for, in dx².
double area_felt(const Vec3& x, const Vec3& v, std::vector<SurfaceMotion>& surfaces, double distance) {
  const double dt = 1e-7;
  ParticleArrays p;
  p.add(x, v, mass);
  p.move(dt);
  resolve(dt, p, surfaces);
  const double z = std::max(distance, dx / 4);
  const double impulse = mass * (v - p.velocity[0]).dot(v) / v.squaredNorm();
  return impulse / (dt * density * viscosity * dx * dx / z);
}

TEST(ViscousWall, one_particle_decays_by_the_implicit_formula_towards_the_exponential) {
  const double z = 0.6 * dx, rate = density * viscosity * dx * dx / (z * mass), time = 0.02;
  double last_error = 0;
  for (int steps : {20, 40, 80}) {
    const double dt = time / steps;
    std::vector<SurfaceMotion> s{square()};
    ParticleArrays p;
    p.add({0.011, z, 0.003}, {0.3, 0, -0.4}, mass);
    double displacement = 0;
    for (int k = 0; k < steps; ++k) {
      p.move(dt);
      resolve(dt, p, s);
      displacement += dt * p.velocity[0].norm();
      p.x_t0 = p.x_t1;
    }
    EXPECT_NEAR(p.velocity[0].norm(), 0.5 * std::pow(1 + dt * rate, -steps), 1e-12);
    EXPECT_NEAR((p.x_t0[0] - Vec3(0.011, z, 0.003)).norm(), displacement, 1e-12)
        << "it moves by what it keeps";
    const double error = p.velocity[0].norm() - 0.5 * std::exp(-rate * time);
    if (last_error > 0) {
      EXPECT_NEAR(last_error / error, 2, 0.15) << "first order in time";
    }
    last_error = error;
  }
}

TEST(ViscousWall, acts_on_the_first_layer_alone) {
  for (double z : {0.05, 0.3, 0.5, 0.99}) {
    std::vector<SurfaceMotion> s{square()};
    const double felt = area_felt({0.02, z * dx, 0.01}, {0.1, 0, 0}, s, z * dx);
    EXPECT_NEAR(felt, 1, 1e-4) << z;  // implicit: dt = 1e-7 s is finite
  }
  for (const Vec3& v : {Vec3(0.1, 0, 0), Vec3(0.1, -20, 0)}) {  // the second stops at the thickness
    std::vector<SurfaceMotion> s{square()};
    ParticleArrays p;
    p.add({0.02, 1.001 * dx, 0.01}, v, mass);
    p.move(1e-3);
    resolve(1e-3, p, s);
    EXPECT_EQ(p.velocity[0].x(), 0.1);
  }
}

TEST(ViscousWall, slip_length_weakens_it_and_thick_surfaces_keep_a_first_layer) {
  const double dt = 1e-3;
  for (double slip_length : {0.0, 0.003, std::numeric_limits<double>::infinity()})
    for (double thickness : {0.4 * dx, 2 * dx}) {
      std::vector<SurfaceMotion> s{square(0, thickness)};
      s[0].slip.slip_length = slip_length;
      ParticleArrays p;
      p.add({0.02, thickness, 0.01}, {0.1, 0, 0}, mass);
      p.move(dt);
      resolve(dt, p, s);
      // A layer that rests at h > dx/2 is half a spacing from where the water begins.
      const double z = std::min(thickness, dx / 2);
      const double drag = density * viscosity * dx * dx / (z + slip_length);
      EXPECT_NEAR(p.velocity[0].x(), 0.1 / (1 + dt * drag / mass), 1e-14);
    }
}

TEST(ViscousWall, a_free_sheet_gets_what_the_particle_loses) {
  Random random(11);
  const double dt = 1e-3, node_mass = 3e-4;
  for (int k = 0; k < 200; ++k) {
    std::vector<SurfaceMotion> s{square(node_mass)};
    const double z = random.uniform(0.25, 0.9) * dx;
    ParticleArrays p;
    p.add({random.uniform(-0.09, 0.09), z, random.uniform(-0.09, 0.09)},
          {random.uniform(-1, 1), 0, random.uniform(-1, 1)}, mass);
    p.move(dt);
    const Vec3 before = mass * p.velocity[0], v = p.velocity[0];
    ContactSettings settings;
    settings.solver_iterations = 1;
    const ContactReport report = resolve(dt, p, s, settings);
    Vec3 after = mass * p.velocity[0], foot = Vec3::Zero();
    for (const Vec3& u : s[0].velocity) after += node_mass * u;
    EXPECT_LE((after - before).norm(), 1e-15 * mass);
    EXPECT_LE((report.impulse_on_free_nodes - (before - mass * p.velocity[0])).norm(), 1e-15 * mass);
    EXPECT_LT(report.kinetic_energy_change, 0);
    // K = 1/m_p + Σ w²/m_i from the change of the nodes' velocities: v_i = −w_i J/m_i with J along v.
    double k_row = 1 / mass;
    const Vec3 impulse = mass * (p.velocity[0] - v);
    for (const Vec3& u : s[0].velocity) {
      const double w = -u.dot(impulse) * node_mass / impulse.squaredNorm();
      k_row += w * w / node_mass;
      foot += w * u;
    }
    const double drag = dt * density * viscosity * dx * dx / z;
    const Vec3 relative = p.velocity[0] - foot;
    EXPECT_LE((relative - v / (1 + drag * k_row)).norm(), 1e-12);
    EXPECT_LE((impulse + drag * relative).norm(), 1e-12 * impulse.norm()) << "J = −c dt v_t after";
  }
}

TEST(ViscousWall, a_particle_stands_for_the_wall_once_at_inner_edges_and_over_layers) {
  Random random(13);
  for (int k = 0; k < 300; ++k) {
    std::vector<SurfaceMotion> s{
        test::make_grid(6, 6, Vec3::Zero(), {0.05, 0, 0}, {0, 0, 0.05}, 0, 0.001, 1, Storage::float64)};
    if (k % 2 == 1)  // a second sheet just below the first
      s.push_back(test::make_grid(4, 4, Vec3(-0.01, -0.001, -0.01), {0.07, 0, 0}, {0, 0, 0.07}, 0, 0.001, 1,
                                  Storage::float64, 2));
    for (SurfaceMotion& sheet : s) sheet.slip.model = SlipModel::viscous_wall;
    const double grid = k % 3 == 0 ? 0.01 : (k % 3 == 1 ? 0.005 : 0);  // over nodes, edges and faces
    Vec3 x(random.uniform(0.006, 0.044), 0.7 * dx, random.uniform(0.006, 0.044));
    if (grid > 0) x.x() = grid * std::round(x.x() / grid), x.z() = grid * std::round(x.z() / grid);
    EXPECT_NEAR(area_felt(x, {0.06, 0, 0.08}, s, 0.7 * dx), 1, 1e-4) << "at " << x.transpose();
  }
}

TEST(ViscousWall, a_corner_has_two_walls_a_gap_has_two_and_a_border_ends) {
  // floor y = 0 and wall z = 0, one mesh; motion along both
  std::vector<SurfaceMotion> corner{
      mesh({{-0.1, 0, 0}, {0.1, 0, 0}, {0, 0, 0.1}, {0, 0.1, 0}}, {{0, 2, 1}, {0, 1, 3}})};
  EXPECT_NEAR(area_felt({0, 0.4 * dx, 0.4 * dx}, {0.1, 0, 0}, corner, 0.4 * dx), 2, 1e-4);
  std::vector<SurfaceMotion> gap{square(), square(0, 0.001, 0.8 * dx, 2)};
  EXPECT_NEAR(area_felt({0.01, 0.4 * dx, 0.02}, {0.1, 0, 0}, gap, 0.4 * dx), 2, 1e-4);
  std::vector<SurfaceMotion> sheet{square()};
  double last = 1.1;
  for (double angle : {0.0, 0.5, 1.0, 1.5, M_PI / 2}) {  // around the border x = 0.1
    const Vec3 x = Vec3(0.1, 0, 0.01) + 0.5 * dx * Vec3(std::sin(angle), std::cos(angle), 0);
    const double felt = area_felt(x, {0, 0, 0.1}, sheet, 0.5 * dx);
    EXPECT_NEAR(felt, std::cos(angle), 1e-4);
    EXPECT_LT(felt, last);
    last = felt;
  }
}

TEST(ViscousWall, other_laws_have_no_more_candidates_or_contacts_than_free_slip) {
  Random random(17);
  ParticleArrays start;
  for (int k = 0; k < 200; ++k)
    start.add({random.uniform(-0.09, 0.09), random.uniform(0.3, 2) * dx, random.uniform(-0.09, 0.09)},
              random.in_cube(0.1), mass);
  start.move(1e-3);
  std::uint64_t candidates[4];
  for (SlipModel model :
       {SlipModel::free, SlipModel::coulomb, SlipModel::sticking, SlipModel::viscous_wall}) {
    std::vector<SurfaceMotion> s{square()};
    s[0].slip.model = model;
    ParticleArrays p = start;
    candidates[static_cast<int>(model)] = resolve(1e-3, p, s).candidates;
  }
  EXPECT_EQ(candidates[0], candidates[1]);
  EXPECT_EQ(candidates[0], candidates[2]);
  EXPECT_LT(candidates[0], candidates[3]);
}

TEST(TwoSides, each_side_has_its_own_slip) {
  Random random(19);
  for (int turn = 0; turn < 20; ++turn) {
    const Eigen::Matrix3d rotation =
        Eigen::AngleAxisd(random.uniform(0, 6), random.direction()).toRotationMatrix();
    for (bool back : {false, true})
      for (bool flipped : {false, true}) {
        std::vector<SurfaceMotion> s{square()};
        for (Vec3& x : s[0].x_t0) x = rotation * x;
        s[0].x_t1 = s[0].x_t0;
        if (flipped)
          for (Triangle& t : s[0].triangles) std::swap(t[1], t[2]);
        s[0].slip.model = SlipModel::sticking;
        s[0].slip_back.emplace();  // free
        ParticleArrays p;
        const Vec3 along = rotation * Vec3(0.3, 0, 0.4);
        // over a face, over the inner edge, over a corner
        const Vec3 at[] = {{0.02, 0, 0.03}, {0.03, 0, -0.03}, {0.1, 0, 0.1}};
        p.add(rotation * (at[turn % 3] + Vec3(0, back ? -0.001 : 0.001, 0)), along, mass);
        p.move(1e-4);
        resolve(1e-4, p, s);
        if (back == flipped)
          EXPECT_LE(p.velocity[0].norm(), 1e-12) << "front";
        else
          EXPECT_LE((p.velocity[0] - along).norm(), 1e-12) << "back";
      }
  }
}

TEST(TwoSides, a_viscous_wall_on_the_back_alone_leaves_the_front_free) {
  for (double side : {1.0, -1.0}) {
    std::vector<SurfaceMotion> s{square()};
    s[0].slip_back = s[0].slip;
    s[0].slip = SlipSettings{};
    EXPECT_NEAR(area_felt({0.01, side * 0.7 * dx, 0.02}, {0.1, 0, 0}, s, 0.7 * dx), side > 0 ? 0 : 1, 1e-4);
  }
}

// Beyond the crease of a hairpin, one of the two triangles has the particle behind its plane.
TEST(TwoSides, the_outside_of_a_sharp_fold_is_the_front_wherever_one_looks_from) {
  const Vec3 upper(-0.1, 0.01, 0), lower(-0.1, -0.01, 0);
  std::vector<SurfaceMotion> s{
      mesh({{0, 0, -0.1}, {0, 0, 0.1}, upper, lower}, {{0, 2, 1}, {0, 1, 3}})};  // normals outwards
  std::vector<SurfaceMotion*> pointers{&s[0]};
  for (double angle = -1.5; angle <= 1.5; angle += 0.25)
    for (bool inside_out : {false, true}) {
      s[0].triangles = {{0, 2, 1}, {0, 1, 3}};
      if (inside_out)
        for (Triangle& t : s[0].triangles) std::swap(t[0], t[1]);
      s[0].id += 1;  // another mesh
      ParticleArrays p;
      p.add(0.3 * dx * Vec3(std::cos(angle), std::sin(angle), 0.1), Vec3::Zero(), mass);
      const auto contacts = test::find_contacts(p.motion(dx), pointers);
      ASSERT_EQ(contacts.size(), 1u);
      EXPECT_EQ(contacts[0].back, inside_out) << angle;
    }
}

}  // namespace
}  // namespace oilskin
