// Heavy water on light cloth at a game's step (docs/theory/contact.md, "Loaded nodes of light cloth").
#include <gtest/gtest.h>

#include <map>
#include <tuple>

#include "bullet_adapter/soft_body_host.h"
#include "bullet_world.h"
#include "oilskin/bullet.h"
#include "support/record.h"

namespace oilskin::bullet {
namespace {

using namespace test;

constexpr double g = 9.81, fall = 0.02;

/// Pins of a sheet of n × n nodes.
void pin_border(btSoftBody& cloth, int n) {
  for (int k = 0; k < n; ++k)
    for (int i : {k, k + n * (n - 1), n * k, n * k + n - 1}) cloth.setMass(i, 0);
}

struct Drop {
  int nodes = 24;
  double size = 0.3, spacing = 0.01;
  int layers = 8, across = 10;
  double mass_ratio = 0.07;  // of the cloth to the water
  int substeps = 1;
  PressureSolver solver = PressureSolver::dfsph;
  BoundaryModel boundary = BoundaryModel::contact_only;
  bool carries = true;
  bool pinned = true;
  double gravity = g;
};

FluidSettings fluid_of(const Drop& drop) {
  FluidSettings fluid;
  fluid.spacing = drop.spacing;
  fluid.solver = drop.solver;
  fluid.boundary = drop.boundary;
  return fluid;
}

/// Water above a sheet, driven like a game: so many of Bullet's sub-steps a frame of 1/60 s.
class WetSheet {
 public:
  explicit WetSheet(const Drop& drop)
      : dt_(1.0 / 60 / drop.substeps),
        water(fluid_of(drop), small_world(), verified()),
        bullet(btVector3(0, bt(-drop.gravity), 0), &solver) {
    std::vector<Vec3> x, v;
    for (int j = 0; j < drop.layers; ++j)
      for (int i = 0; i < drop.across; ++i)
        for (int k = 0; k < drop.across; ++k) {
          const double middle = 0.5 * (drop.across - 1);
          x.push_back(drop.spacing * Vec3(i - middle, j + 0.5, k - middle) + Vec3(0, fall, 0));
          v.push_back(drop.gravity > 0 ? Vec3::Zero() : Vec3(0, -1, 0));
        }
    World& w = water.getWorld();
    EXPECT_TRUE(w.set_gravity(Vec3(0, -drop.gravity, 0)).ok());
    cloth = bullet.patch(drop.nodes, drop.size, 0, 0,
                         drop.mass_ratio * w.particle_mass() * static_cast<double>(x.size()));
    cloth->m_cfg.piterations = 4;
    if (drop.pinned) pin_border(*cloth, drop.nodes);
    solver.setCarriesWater(drop.carries);
    EXPECT_TRUE(solver.addFluid(&water).ok());
    EXPECT_TRUE(solver.addCloth(cloth, bt(0.001)).ok());
    EXPECT_TRUE(w.add_particles(x, v).ok());
    start_ = potential();
    remember();
  }
  ~WetSheet() {
    solver.removeCloth(cloth);
    solver.removeFluid(&water);
  }

  void step() {
    bullet.step(dt_);
    const StepReport& r = solver.getReport();
    ASSERT_TRUE(r.status.ok()) << r.status.message;
    ASSERT_EQ(r.contact.crossings_found_by_verify, 0u);
    ASSERT_LE(r.momentum_residual().norm(), 1e-9);
    density_error += r.fluid.density_error_mean;
    ++steps;
    for (int i = 0; i < cloth->m_nodes.size(); ++i)
      sag = std::max(sag, -static_cast<double>(cloth->m_nodes[i].m_x.y()));
    const double now = potential();
    double kinetic = 0;
    const World& w = water.getWorld();
    for (std::size_t i = 0; i < w.particle_count(); ++i)
      kinetic += 0.5 * ((w.positions()[i] - before_[w.ids()[i]]) / dt_).squaredNorm();
    risen = std::max(risen, now + kinetic / static_cast<double>(w.particle_count()) - start_);
    remember();
  }

  /// The most that kinetic (of displacements) and potential energy rose above that of the start, per m g
  /// (fall + sag).
  double energy_made() const { return risen / (g * (fall + sag)); }

 private:
  double potential() const {
    double sum = 0;
    for (const Vec3& x : water.getWorld().positions()) sum += g * x.y();
    return sum / static_cast<double>(water.getWorld().particle_count());
  }
  void remember() {
    const World& w = water.getWorld();
    for (std::size_t i = 0; i < w.particle_count(); ++i) before_[w.ids()[i]] = w.positions()[i];
  }

  double dt_, start_ = 0;
  std::map<std::uint64_t, Vec3> before_;

 public:
  btFluidSoftBodySolver solver;
  btFluid water;
  SoftWorld bullet;
  btSoftBody* cloth = nullptr;
  double sag = 0, risen = -1e30;  // [m], [J/kg]
  double density_error = 0;       // sum of the means of all steps
  int steps = 0;
};

/// Mass of the cloth over that of the water; Bullet's sub-steps a frame; particles across; pressure solver.
using Case = std::tuple<double, int, int, PressureSolver, BoundaryModel>;

class LightClothDrop : public ::testing::TestWithParam<Case> {};

TEST_P(LightClothDrop, makes_no_energy_at_a_games_step) {
  Drop drop;
  std::tie(drop.mass_ratio, drop.substeps, drop.across, drop.solver, drop.boundary) = GetParam();
  drop.size = 0.03 * drop.across;
  drop.nodes = 2 * drop.across + 4;
  WetSheet sheet(drop);
  const int before = sheet.water.getNumParticles();
  for (int k = 0; k < 40 * drop.substeps; ++k) sheet.step();
  EXPECT_LE(sheet.energy_made(), 0.02);
  EXPECT_GE(sheet.water.getNumParticles(), before - before / 100) << "nothing is thrown out";
  // With contact alone particles share the space next to the sheet.
  if (drop.boundary == BoundaryModel::mirrored) {
    EXPECT_LE(sheet.density_error / sheet.steps, 0.2);
  }
  oilskin::test::record("energy_made", sheet.energy_made());
  oilskin::test::record("density_error", sheet.density_error / sheet.steps);
}

constexpr auto dfsph = PressureSolver::dfsph, pcisph = PressureSolver::pcisph;
constexpr auto contact_only = BoundaryModel::contact_only, mirrored = BoundaryModel::mirrored;

INSTANTIATE_TEST_SUITE_P(Short, LightClothDrop,
                         ::testing::Values(Case{0.01, 1, 10, dfsph, contact_only},
                                           Case{0.2, 1, 10, pcisph, contact_only},
                                           Case{0.001, 2, 10, dfsph, mirrored},
                                           Case{0.07, 4, 8, dfsph, mirrored}));
INSTANTIATE_TEST_SUITE_P(Long, LightClothDrop,
                         ::testing::Combine(::testing::Values(0.01, 0.07, 0.2, 1.0),
                                            ::testing::Values(1, 2, 4), ::testing::Values(12, 18, 27, 35),
                                            ::testing::Values(dfsph),
                                            ::testing::Values(contact_only, mirrored)));

TEST(LightCloth, is_left_alone_where_a_load_moves_it_little_or_nothing_supports_it) {
  Drop small_steps;
  small_steps.mass_ratio = 1;
  small_steps.substeps = 16;
  small_steps.gravity = 0;
  Drop free;
  free.pinned = false;
  free.gravity = 0;
  for (Drop drop : {small_steps, free}) {
    std::uint64_t hash[2];
    for (bool carries : {false, true}) {
      drop.carries = carries;
      WetSheet sheet(drop);
      for (int k = 0; k < 3 * drop.substeps + 10; ++k) {
        sheet.step();
        ASSERT_EQ(sheet.solver.getReport().momentum_owed, Vec3::Zero());
      }
      EXPECT_GT(sheet.solver.getReport().load_speed, 0);
      hash[carries] = sheet.water.getWorld().state_hash();
    }
    EXPECT_EQ(hash[0], hash[1]);
  }
}

/// One scatter of random impulses: what the nodes get, and what is owed, is what was given.
void expect_momentum(btSoftBody& cloth, double carried) {
  SoftBodyHost host(&cloth, {});
  SurfaceMotion motion;
  ASSERT_TRUE(gather_step(host, 0.01, motion).status.ok());
  motion.carried_mass.assign(motion.x_t1.size(), carried);
  ASSERT_TRUE(gather_step(host, 0.01, motion).status.ok());
  ASSERT_EQ(motion.added_mass.size(), motion.x_t1.size());
  const Vec3 before = momentum(cloth);
  Vec3 given = Vec3::Zero(), owed = Vec3::Zero();
  for (std::size_t i = 0; i < motion.x_t1.size(); ++i) {
    if (motion.inverse_mass[i] == 0) continue;
    motion.impulse[i] = Vec3(0.01 * static_cast<double>(i % 7), -0.1, 0.003 * static_cast<double>(i % 5));
    given += motion.impulse[i];
    owed += motion.added_mass[i] * motion.inverse_mass[i] * motion.impulse[i];
    EXPECT_EQ(motion.added_mass[i], carried);
  }
  host.scatter(motion);
  Vec3 of_nodes = Vec3::Zero();
  for (const Vec3& j : host.node_impulses()) of_nodes += j;
  const double tolerance = (is_double ? 1e-12 : 1e-4) * given.norm();
  EXPECT_LE((momentum(cloth) - before + owed - given).norm(), tolerance);
  EXPECT_LE((of_nodes - given).norm(), tolerance) << "getNodeImpulses() has the whole load";
  EXPECT_GT(owed.norm(), 0.5 * given.norm());
}

TEST(LightCloth, momentum_of_nodes_and_what_is_owed_is_what_the_water_gave) {
  SoftWorld bullet;
  btSoftBody* cloth = bullet.patch(9, 0.4, 0, 15);
  expect_momentum(*cloth, 0.01);
  // Copies of nodes, of unequal masses, at one position.
  btSoftBody* welded = bullet.patch(9, 0.4, 0.2, 15);
  for (int i = 20; i < 30; ++i) {
    welded->appendNode(welded->m_nodes[i].m_x, bt(0.002));
    welded->appendFace(welded->m_nodes.size() - 1, i + 1, i + 9);
  }
  expect_momentum(*welded, 0.02);
}

TEST(LightCloth, masses_of_the_body_are_never_touched_and_changes_of_them_are_followed) {
  const Drop drop;
  WetSheet sheet(drop);
  std::vector<btScalar> im;
  for (int i = 0; i < sheet.cloth->m_nodes.size(); ++i) im.push_back(sheet.cloth->m_nodes[i].m_im);
  const int middle = 24 * 12 + 12;
  for (int k = 0; k < 30; ++k) {
    if (k == 20) im[middle] = sheet.cloth->m_nodes[middle].m_im = bt(20);  // as a callback would
    sheet.step();
    for (int i = 0; i < sheet.cloth->m_nodes.size(); ++i)
      ASSERT_EQ(sheet.cloth->m_nodes[i].m_im, im[static_cast<std::size_t>(i)]);
  }
  const SurfaceMotion& s = *sheet.solver.getCoupling().getSurface(sheet.cloth);
  ASSERT_FALSE(s.added_mass.empty());
  EXPECT_NEAR(1 / s.inverse_mass[middle], 0.05 + s.added_mass[middle], 1e-9);
}

TEST(LightCloth, a_cut_or_a_teleport_leaves_the_load_behind) {
  Drop drop;
  WetSheet sheet(drop);
  for (int k = 0; k < 20; ++k) sheet.step();
  const auto surface = [&] { return sheet.solver.getCoupling().getSurface(sheet.cloth); };
  ASSERT_FALSE(surface()->added_mass.empty());
  sheet.cloth->appendNode(sheet.cloth->m_nodes[0].m_x, bt(0.001));
  sheet.step();
  EXPECT_TRUE(surface()->added_mass.empty());
  for (int k = 0; k < 15; ++k) sheet.step();
  ASSERT_FALSE(surface()->added_mass.empty());
  sheet.solver.resetMotion(sheet.cloth);
  sheet.step();
  EXPECT_TRUE(surface()->added_mass.empty());
}

}  // namespace
}  // namespace oilskin::bullet
