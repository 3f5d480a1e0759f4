// Hard case 16 at the level of contact and with boundary terms: crumpled cloth that passes through itself.
#include <gtest/gtest-spi.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/closest_point.h"
#include "hard_cases/cloth_scene.h"
#include "hard_cases/hard_case.h"
#include "support/find_boundary.h"
#include "support/random.h"
#include "support/static_mesh.h"
#include "support/surface_of.h"

namespace oilskin::test {
namespace {

// A zigzag of `layers` folds within `height`, crumpled by noise that makes folds pass through each other.
void crumple(std::vector<Vec3>& x, std::uint32_t nu, std::uint32_t nv, int layers, double height,
             double width, double noise) {
  Random random(16);
  for (std::uint32_t j = 0; j < nv; ++j)
    for (std::uint32_t i = 0; i < nu; ++i) {
      const double along = static_cast<double>(i) / (nu - 1) * layers;
      const double fold = std::floor(std::min(along, layers - 1e-9)), part = along - fold;
      const double u = static_cast<int>(fold) % 2 ? 1 - part : part;
      x[i + nu * j] = Vec3(width * (u - 0.5), height * along / layers, width * (j / (nv - 1.0) - 0.5)) +
                      random.in_cube(noise);
    }
}

TEST(HardGeometry, crumpled_cloth_of_twelve_layers_through_each_other_lets_nothing_cross) {
  HardCase c("16", "contact alone: 12 crumpled layers within 10 mm, passing through each other");
  Found all;
  const std::uint32_t nu = 12 * 6 + 1, nv = 9;
  for (const HostKind& host : host_kinds) {
    SCOPED_TRACE(host.name);
    ContactScene scene;
    SurfaceMotion s = make_grid(nu, nv, Vec3::Zero(), Vec3(1, 0, 0), Vec3(0, 0, 1), mass_of_nodes(host),
                                0.001, 2, host.storage);
    crumple(s.x_t0, nu, nv, 12, 0.01, 0.04, 0.0015);
    for (Vec3& x : s.x_t0) x = stored(x, host.storage);
    s.x_t1 = s.x_t0;
    Random random(2);
    scene.surfaces = {s};
    // A hail on it from all sides, and particles that start between the layers where there is space.
    for (int k = 0; k < 120; ++k) {
      const Vec3 out = random.direction();
      scene.particles.add(Vec3(0, 0.005, 0) + 0.06 * out, -random.log_uniform(5, 500) * out, particle_mass);
    }
    for (int k = 0; k < 400; ++k) {
      const Vec3 x(random.uniform(-0.02, 0.02), random.uniform(0, 0.01), random.uniform(-0.02, 0.02));
      double minimum = 1;
      for (const Triangle& t : s.triangles)
        minimum = std::min(minimum, closest_point(x, s.x_t0[t[0]], s.x_t0[t[1]], s.x_t0[t[2]]).distance);
      if (minimum > 2 * s.delta) scene.particles.add(x, random.in_cube(20), particle_mass);
    }
    for (Vec3& v : scene.surfaces[0].velocity) v = host.free ? random.in_cube(5) : Vec3(0, 1, 0);
    CheckedContact check(scene);
    check.run(4);
    all.add(check.found);
  }
  c.note("paths", all.audit.particles);
  c.no_crossings(all);
  c.note("zone rounds", all.total.zone_rounds);
  c.equal("removed", all.total.removed, 0);
}

template <class Scalar>
class CrumpledPool : public WorldScene {
 public:
  CrumpledPool(int threads, double* density) : density_(density) {
    GridShape shape;
    shape.nu = 61, shape.nv = 9;
    shape.areal_density = 2;
    cloth_ = std::make_unique<MockCloth<Scalar>>(shape);
    std::vector<Vec3> x(cloth_->x.size());
    crumple(x, 61, 9, 12, 0.01, 0.05, 0.0008);
    for (std::size_t i = 0; i < x.size(); ++i) {
      cloth_->x[i] = x[i].template cast<Scalar>();
      cloth_->pin(i);
    }
    WorldSettings settings;
    settings.kill_box = {Vec3::Constant(-1), Vec3::Constant(1)};
    settings.threads = threads;
    FluidSettings fluid;
    fluid.boundary = BoundaryModel::mirrored;
    world_ = std::make_unique<World>(settings, fluid);
    EXPECT_TRUE(world_->attach(*cloth_, sheet_settings(), nullptr).ok());
    floor_.add_rectangle(Vec3(-0.2, -0.03, -0.2), Vec3(0.4, 0, 0), Vec3(0, 0, 0.4), 4, 4);
    EXPECT_TRUE(world_->attach(floor_, sheet_settings(), nullptr).ok());
    std::vector<Vec3> start, v;
    for (int i = 0; i < 8; ++i)
      for (int j = 0; j < 10; ++j)
        for (int k = 0; k < 8; ++k) {
          start.push_back(0.005 * Vec3(i - 3.5, j + 3.5, k - 3.5));
          v.push_back(Vec3(0, -1, 0));
        }
    EXPECT_TRUE(world_->add_particles(start, v).ok());
  }
  World& world() override { return *world_; }
  void after_step(int) override {
    for (double d : world_->densities()) *density_ = std::max(*density_, d / 1000);
  }

 private:
  std::unique_ptr<MockCloth<Scalar>> cloth_;
  StaticMesh floor_;
  std::unique_ptr<World> world_;
  double* density_;
};

// The largest λ (share of its density that a particle gets from walls) on a lattice through the crumpled
// cloth.
float max_lambda() {
  StaticMesh mesh;
  mesh.add_rectangle(Vec3::Zero(), Vec3(1, 0, 0), Vec3(0, 0, 1), 60, 8);
  crumple(mesh.nodes, 61, 9, 12, 0.01, 0.05, 0.0008);
  SurfaceMotion surface = surface_of(mesh);
  SurfaceMotion* surfaces[] = {&surface};
  std::vector<Vec3> lattice;
  for (int i = 0; i < 24; ++i)
    for (int j = 0; j < 16; ++j)
      for (int k = 0; k < 24; ++k) lattice.push_back(0.0021 * Vec3(i - 11.5, j - 3.5, k - 11.5));
  fluid::Boundary boundary{2.0};
  find_boundary(boundary, lattice, surfaces, {particle_mass, 0.01}, Workers(1));
  float largest = 0;
  for (const fluid::WallPoint& p : boundary.points()) largest = std::max(largest, p.lambda);
  return largest;
}

TEST(HardGeometry, water_on_crumpled_cloth_never_gets_three_times_as_dense) {
  HardCase c("16", "water with mirrored boundary terms falls on it");
  double density = 0;
  Found all;
  all.add(run_checked([&](int threads) { return std::make_unique<CrumpledPool<float>>(threads, &density); },
                      40, 1e-3));
  all.add(run_checked([&](int threads) { return std::make_unique<CrumpledPool<double>>(threads, &density); },
                      40, 1e-3));
  const float lambda = max_lambda();
  c.note("paths", all.audit.particles);
  c.no_crossings(all);
  c.above("impulse on the cloth [N s]", all.total.impulse_on_prescribed.norm(), 0.05);
  c.below("largest density [ρ0]", density, 3);
  c.above("largest λ", static_cast<double>(lambda), 0.5);
  c.at_most("largest λ", static_cast<double>(lambda), 1);
  c.note("largest speed [m/s]", all.speed);
}

// What checks all of these can fail.
void let_a_particle_cross() {
  ContactScene scene;
  scene.settings.ccd = scene.settings.zones = false;
  scene.surfaces = {square_sheet(host_kinds[2])};
  scene.particles.add(Vec3(0.003, 0.02, 0.004), Vec3(0, -40, 0), particle_mass);
  scene.move();
  resolve_checked(scene);
}

TEST(HardGeometry, the_audit_finds_a_crossing_where_contact_does_not_look_along_paths) {
  EXPECT_NONFATAL_FAILURE(let_a_particle_cross(), "crossings");
}

}  // namespace
}  // namespace oilskin::test
