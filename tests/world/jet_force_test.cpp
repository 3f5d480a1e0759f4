// The force of a round jet on a flat sheet (F.53): all momentum that comes in across the sheet is
// taken, none of what comes in along it.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "support/record.h"
#include "support/static_mesh.h"
#include "support/world_helpers.h"

namespace oilskin {
namespace {

constexpr double spacing = 0.005, radius = 0.0125, speed = 2.5;  // [m], [m], [m/s]
constexpr double half = 0.1;    // of the sheet, in the jet's frame: four jet diameters [m]
constexpr double above = 0.04;  // of the nozzle, at first [m]

/// A flat sheet that its host moves with one velocity.
class MovingSheet : public test::StaticMesh {
 public:
  Vec3 velocity = Vec3::Zero();

  Gathered gather(double dt, SurfaceMotion& m) override {
    for (Vec3& x : nodes) x += dt * velocity;
    Gathered gathered = StaticMesh::gather(dt, m);
    m.velocity.assign(nodes.size(), velocity);
    return gathered;
  }
};

struct Case {
  FluidSettings fluid;
  SlipSettings slip;
  double away = 0;    ///< speed of the sheet along the jet [m/s]
  double angle = 90;  ///< between jet and sheet [degrees]
  double dt = 5e-4;   ///< [s]
};

/// Means over the window, as shares of what the theory says.
struct Force {
  double normal = 0;      ///< over ρ A (v − u)² sin φ, with ρ A v the mass flow that was emitted
  double tangential = 0;  ///< over the measured normal one
  double bounced = 0;     ///< momentum across the sheet of the water that left, over what came
  double flow = 0;        ///< emitted over ρ π r² v
};

Force measure(const Case& c) {
  const double phi = c.angle * M_PI / 180, u = c.away;
  const Vec3 jet(0, -1, 0), along(std::sin(phi), -std::cos(phi), 0), normal(std::cos(phi), std::sin(phi), 0);
  // Long enough for the slowest way: down to the sheet, three diameters of jet, and out to its border.
  const double begin = above / (speed - u) + 6 * radius / (speed - u) + 1.5 * half / (speed - u);
  const double end = begin + 0.3, dt = c.dt;

  // The border of the box is that of the sheet: water is taken away while the sheet still carries it.
  WorldSettings settings;
  settings.gravity = Vec3::Zero();
  const double deep = half * std::abs(along.y()) + u * (end + dt);
  settings.kill_box = {Vec3(-half * along.x(), -deep - 0.02, -half),
                       Vec3(half * along.x(), half * std::abs(along.y()) + above + 0.02, half)};
  World w(settings, c.fluid);
  MovingSheet sheet;
  sheet.add_rectangle(-half * along - Vec3(0, 0, half), Vec3(0, 0, 2 * half), 2 * half * along, 15, 15);
  sheet.velocity = u * jet;
  SurfaceSettings surface = test::sheet_settings();
  surface.slip = c.slip;
  SurfaceId id;
  EXPECT_TRUE(w.attach(sheet, surface, &id).ok());
  DiscEmitter nozzle;
  nozzle.center = -above * jet;
  nozzle.direction = jet;
  nozzle.radius = radius;
  nozzle.speed = speed;
  EXPECT_TRUE(w.add_emitter(nozzle).ok());

  Vec3 impulse = Vec3::Zero(), removed = Vec3::Zero();
  double mass = 0, mass_removed = 0, time = 0;
  while (w.time() < end - 0.5 * dt) {
    const StepReport& r = w.step(dt);
    EXPECT_TRUE(r.status.ok());
    EXPECT_LT(r.momentum_residual().norm(), 1e-12);
    if (w.time() < begin) continue;
    time += dt;
    impulse += r.contact.impulse_on_prescribed;
    mass += r.mass_emitted;
    mass_removed += r.mass_removed;
    removed += r.momentum_removed;
  }
  // What went past the sheet would be in the far half of the box.
  for (const Vec3& x : w.positions()) EXPECT_GT(normal.dot(x - u * w.time() * jet), 0);
  // Water that moves with the sheet and water that lies on it say nothing about a jet.
  EXPECT_NEAR(mass_removed, mass * (1 - u / speed), 0.05 * mass) << "steady: what comes leaves";

  const Vec3 force = impulse / time;
  const double flow = mass / time, hits = flow * (1 - u / speed);
  Force f;
  f.normal = -force.dot(normal) / (hits * (speed - u) * std::sin(phi));
  f.tangential = (force - force.dot(normal) * normal).norm() / force.norm();
  f.bounced = (removed - mass_removed * u * jet).dot(normal) / time / (hits * (speed - u) * std::sin(phi));
  f.flow = flow / (1000 * M_PI * radius * radius * speed);
  test::record("force over theory", f.normal);
  test::record("tangential over normal force", f.tangential);
  test::record("momentum of the water that left, over that which came", f.bounced);
  return f;
}

FluidSettings fluid(PressureSolver solver, BoundaryModel boundary) {
  FluidSettings s;
  s.spacing = spacing;
  s.solver = solver;
  s.boundary = boundary;
  return s;
}

class JetForce : public ::testing::TestWithParam<BoundaryModel> {
 protected:
  Case c;

  void SetUp() override { c.fluid = fluid(PressureSolver::pcisph, GetParam()); }

  /// With boundary terms the wall's pressure stops the water, not contact, and throws some of it back.
  double thrown_back() const { return GetParam() == BoundaryModel::mirrored ? 0.03 : 0.01; }

  void expect_theory(const Force& f) const {
    EXPECT_NEAR(f.flow, 1, 0.01);
    EXPECT_NEAR(f.normal, 1, 0.03) << "(F.53)";
    EXPECT_NEAR(f.normal - f.bounced, 1, 0.03) << "what is not thrown back";
    EXPECT_LT(f.bounced, thrown_back());
    EXPECT_LT(f.tangential, 0.01) << "(F.53)";
  }
};

TEST_P(JetForce, of_a_normal_jet_is_its_momentum_flow) {
  expect_theory(measure(c));
}

TEST_P(JetForce, does_not_grow_with_shorter_steps) {
  c.dt = 1.25e-4;
  expect_theory(measure(c));
}

TEST_P(JetForce, on_a_sheet_that_moves_away_goes_with_the_square_of_the_relative_speed) {
  c.away = speed / 2;
  expect_theory(measure(c));
}

TEST_P(JetForce, on_an_inclined_sheet_without_friction_is_normal_to_it) {
  c.angle = 40;
  expect_theory(measure(c));
}

TEST_P(JetForce, dfsph_is_the_same) {
  c.fluid.solver = PressureSolver::dfsph;
  expect_theory(measure(c));
}

INSTANTIATE_TEST_SUITE_P(boundary, JetForce,
                         ::testing::Values(BoundaryModel::contact_only, BoundaryModel::mirrored),
                         [](const auto& made) {
                           return made.param == BoundaryModel::mirrored ? "mirrored" : "contact_only";
                         });

/// Force on a plate whose border is in the open, over the momentum of the jet.
double force_on_plate(const test::StaticMesh& mesh) {
  constexpr double dt = 5e-4, begin = 0.1, end = 0.24;
  WorldSettings settings;
  settings.gravity = Vec3::Zero();
  settings.kill_box = {Vec3(-0.12, -0.04, -0.12), Vec3(0.12, 0.09, 0.12)};
  World w(settings, fluid(PressureSolver::pcisph, BoundaryModel::mirrored));
  test::StaticMesh plate = mesh;
  SurfaceId id;
  EXPECT_TRUE(w.attach(plate, test::sheet_settings(), &id).ok());
  DiscEmitter nozzle;
  nozzle.center = Vec3(0, above, 0);
  nozzle.direction = Vec3(0, -1, 0);
  nozzle.radius = radius;
  nozzle.speed = speed;
  EXPECT_TRUE(w.add_emitter(nozzle).ok());
  double impulse = 0, mass = 0;
  while (w.time() < end - 0.5 * dt) {
    const StepReport& r = w.step(dt);
    EXPECT_TRUE(r.status.ok());
    if (w.time() < begin) continue;
    impulse -= r.contact.impulse_on_prescribed.y();
    mass += r.mass_emitted;
  }
  return impulse / (mass * speed);
}

TEST(JetForceOf, a_box_is_that_on_a_sheet_of_its_size) {
  constexpr double side = 0.07;  // half of it [m]
  test::StaticMesh sheet, box;
  sheet.add_rectangle(Vec3(-side, 0, -side), Vec3(0, 0, 2 * side), Vec3(2 * side, 0, 0));
  for (int k = 0; k < 8; ++k)  // one mesh of 8 nodes, as Bullet's boxes are
    box.nodes.push_back(Vec3(k & 1 ? side : -side, k & 2 ? 0 : -0.02, k & 4 ? side : -side));
  for (const auto& [a, b, c, d] : std::vector<std::array<std::uint32_t, 4>>{
           {0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}}) {
    box.triangles.push_back({a, b, c});
    box.triangles.push_back({a, c, d});
  }
  const double on_box = force_on_plate(box), on_sheet = force_on_plate(sheet);
  EXPECT_NEAR(on_box, on_sheet, 0.01) << "0.05 with sides that count above the top";
  EXPECT_NEAR(on_box, 1, 0.03);
  test::record("force on a box", on_box);
  test::record("force on a sheet", on_sheet);
}

TEST(JetForceOf, an_inclined_jet_on_a_rough_sheet_is_not_normal_to_it) {
  Case c;
  c.fluid = fluid(PressureSolver::pcisph, BoundaryModel::contact_only);
  c.angle = 40;
  c.slip.model = SlipModel::coulomb;
  c.slip.friction = 0.2;
  const Force f = measure(c);
  EXPECT_NEAR(f.normal, 1, 0.03) << "friction acts along the sheet alone";
  EXPECT_GT(f.tangential, 0.03) << "the test of free slip can fail";
  EXPECT_LE(f.tangential, 0.2 * (1 + 1e-9)) << "Coulomb's bound holds for the sum, too";
}

}  // namespace
}  // namespace oilskin
