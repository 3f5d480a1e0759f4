// The slip laws on water that boundary terms carry: Coulomb blocks on an incline and on a belt, films against
// their series, and what free cloth gets.
#include <gtest/gtest.h>

#include <cmath>

#include "support/mock_cloth.h"
#include "support/record.h"
#include "support/static_mesh.h"
#include "support/world_helpers.h"

namespace oilskin {
namespace {

constexpr double g = 9.81;

struct Mode {
  const char* name;
  PressureSolver solver;
};
std::string name_of(const ::testing::TestParamInfo<Mode>& mode) {
  return mode.param.name;
}

struct Block {
  double dx = 0.004, thickness = 0.0008, dt = 1e-3, angle = 0.6;
  int long_ = 8, layers = 4, wide = 8;
  double viscosity = 1e-6, xsph_rate = 15;
  double belt = 0;   // speed of the floor [m/s]
  double cells = 0;  // size of the floor's triangles [m], 0 = two of them
  SlipSettings slip{SlipModel::coulomb, 0.4, 0};
  std::optional<SlipSettings> slip_back;
  PressureSolver solver = PressureSolver::pcisph;
};

/// Water on a plane, between free-slip sides. Gravity has the angle, so the plane is y = 0.
class OnPlane {
 public:
  explicit OnPlane(const Block& b) : block_(b), world_(world_settings(), fluid_settings()) {
    const double depth = b.wide * b.dx, around = 5 * b.dx, length = 2.4;
    const auto cells = [&](double size) {
      return b.cells > 0 ? static_cast<std::uint32_t>(std::ceil(size / b.cells)) : 1u;
    };
    floor_.speed = b.belt;
    floor_.add_rectangle({-0.4, 0, -around}, {0, 0, depth + 2 * around}, {length, 0, 0},
                         cells(depth + 2 * around), cells(length));
    for (double z : {0.0, depth}) sides_.add_rectangle({-0.4, -0.1, z}, {length, 0, 0}, {0, 0.3, 0});
    SurfaceSettings s = test::sheet_settings(b.thickness);
    EXPECT_TRUE(world_.attach(sides_, s, nullptr).ok());
    s.slip = b.slip;
    s.slip_back = b.slip_back;
    EXPECT_TRUE(world_.attach(floor_, s, nullptr).ok());
    std::vector<Vec3> x;
    for (int i = 0; i < b.long_; ++i)
      for (int j = 0; j < b.layers; ++j)
        for (int k = 0; k < b.wide; ++k)
          x.push_back(b.dx * Vec3(i + 0.5 - 0.5 * b.long_, j + 0.525, k + 0.5));
    EXPECT_TRUE(world_.add_particles(x, std::vector<Vec3>(x.size(), Vec3::Zero()), nullptr).ok());
  }

  /// Until `time`; impulses on the floor are summed from `from` on.
  void run(double time, double from = 0) {
    while (world_.time() < time - 0.5 * block_.dt) {
      if (world_.time() < from + 0.5 * block_.dt) {
        on_floor_.setZero();
        from_ = world_.time();
        start_speed_ = mean(world_.velocities()).x();
      }
      const StepReport r = world_.step(block_.dt);
      on_floor_ += r.contact.impulse_on_prescribed;
      EXPECT_LT(r.momentum_residual().norm(), 1e-13);
    }
  }
  static Vec3 mean(Span<const Vec3> values) {
    Vec3 sum = Vec3::Zero();
    for (const Vec3& v : values) sum += v;
    return sum / static_cast<double>(values.size());
  }
  double acceleration() const {
    return (mean(world_.velocities()).x() - start_speed_) / (world_.time() - from_);
  }
  /// Tangential over normal impulse on the floor.
  double ratio() const { return on_floor_.x() / -on_floor_.y(); }
  World& world() { return world_; }

 private:
  WorldSettings world_settings() const {
    WorldSettings s;
    s.gravity = g * Vec3(std::sin(block_.angle), -std::cos(block_.angle), 0);
    s.kill_box = {Vec3(-1, -1, -1), Vec3(2, 1, 1)};
    s.threads = 1;
    return s;
  }
  FluidSettings fluid_settings() const {
    FluidSettings s;
    s.spacing = block_.dx;
    s.solver = block_.solver;
    s.boundary = BoundaryModel::mirrored;
    s.viscosity = block_.viscosity;
    s.xsph_rate = block_.xsph_rate;
    return s;
  }

  Block block_;
  test::SlidingMesh floor_;
  test::StaticMesh sides_;
  World world_;
  Vec3 on_floor_ = Vec3::Zero();
  double from_ = 0, start_speed_ = 0;
};

class WallFriction : public ::testing::TestWithParam<Mode> {
 protected:
  static Block block(int layers) {
    Block b;
    b.solver = GetParam().solver;
    b.layers = layers;
    return b;
  }
};

TEST_P(WallFriction, coulomb_blocks_slide_with_the_acceleration_and_the_ratio_of_dry_friction) {
  for (int layers : {1, 4})
    for (double thickness : {0.0008, 0.002}) {
      Block b = block(layers);
      b.thickness = thickness;
      b.cells = layers == 1 ? 0.007 : 0;
      OnPlane water(b);
      water.run(0.35, 0.12);
      const double expected = g * (std::sin(b.angle) - b.slip.friction * std::cos(b.angle));
      test::record("acceleration over dry friction's, " + std::to_string(layers),
                   water.acceleration() / expected);
      test::record("ratio over friction, " + std::to_string(layers), water.ratio() / b.slip.friction);
      EXPECT_NEAR(water.acceleration(), expected, 0.03 * expected) << layers << " layers, " << thickness;
      EXPECT_NEAR(water.ratio(), b.slip.friction, 0.03 * b.slip.friction) << layers << " layers";
    }
}

TEST_P(WallFriction, one_layer_stays_where_friction_exceeds_the_slope) {
  for (double thickness : {0.0005, 0.002}) {
    Block b = block(1);
    b.thickness = thickness;
    b.slip.friction = 1;
    OnPlane water(b);
    water.run(0.2);  // it sinks to where the wall carries it
    const double start = OnPlane::mean(water.world().positions()).x();
    water.run(0.7);
    test::record("creep", (OnPlane::mean(water.world().positions()).x() - start) / b.dx);
    EXPECT_NEAR(OnPlane::mean(water.world().positions()).x(), start, 0.1 * b.dx) << thickness;
  }
}

TEST_P(WallFriction, free_slip_is_exact) {
  Block b = block(3);
  b.slip.model = SlipModel::free;
  OnPlane water(b);
  water.run(0.1, 0.02);
  EXPECT_NEAR(water.acceleration(), g * std::sin(b.angle), 1e-9);
  EXPECT_NEAR(water.ratio(), 0, 1e-12);
}

TEST_P(WallFriction, a_belt_takes_the_water_to_its_speed) {
  for (SlipModel model : {SlipModel::coulomb, SlipModel::sticking}) {
    Block b = block(2);
    b.angle = 0;
    b.belt = 0.4;
    b.slip.model = model;
    OnPlane water(b);
    water.run(0.4);
    EXPECT_NEAR(OnPlane::mean(water.world().velocities()).x(), b.belt, 0.02 * b.belt);
  }
}

TEST_P(WallFriction, each_side_has_its_own_law) {
  Block b = block(1);
  b.slip_back = b.slip;
  b.slip.model = SlipModel::free;
  for (bool swapped : {false, true}) {
    if (swapped) std::swap(b.slip, *b.slip_back);
    OnPlane water(b);
    water.run(0.2, 0.12);
    const bool is_free = swapped == false;  // the floor's front is up
    EXPECT_NEAR(water.ratio(), is_free ? 0 : b.slip.friction, 1e-3);
  }
}

/// The film of depth D down an incline from rest: (F.51) of a channel of twice the depth.
double film(double y, double t, double depth, double viscosity, double along) {
  double v = along / viscosity * y * (depth - 0.5 * y);
  for (int n = 0; n < 100; ++n) {
    const double k = (2 * n + 1) * M_PI / (2 * depth);
    v -= 2 * along / (viscosity * depth * k * k * k) * std::sin(k * y) * std::exp(-viscosity * k * k * t);
  }
  return v;
}

TEST_P(WallFriction, a_thick_film_that_sticks_follows_its_series) {
  for (double thickness : {0.001, 0.002}) {
    Block b = block(4);
    b.thickness = thickness;
    b.long_ = 40;
    b.wide = 5;
    b.viscosity = 3e-3;
    b.xsph_rate = 0;
    b.dt = 5e-4;
    b.slip.model = SlipModel::sticking;
    OnPlane water(b);
    water.run(0.06);
    const double middle = OnPlane::mean(water.world().positions()).x(), depth = b.layers * b.dx;
    double speed = 0, expected = 0;
    for (std::size_t i = 0; i < water.world().positions().size(); ++i) {
      const Vec3& x = water.world().positions()[i];
      if (std::abs(x.x() - middle) > 6 * b.dx || x.y() < depth - b.dx) continue;
      speed += water.world().velocities()[i].x();
      expected += film(x.y(), water.world().time(), depth, b.viscosity, g * std::sin(b.angle));
    }
    test::record("speed of the top over the series'", speed / expected);
    EXPECT_NEAR(speed / expected, 1, 0.1) << thickness;
  }
}

// A particle in front of an inner edge may have a contact with each triangle there: they are one wall.
TEST_P(WallFriction, a_film_sticks_alike_in_front_of_edges_and_of_faces) {
  Block b = block(2);
  b.thickness = 0.002;
  b.viscosity = 3e-3;
  b.xsph_rate = 0;
  b.slip.model = SlipModel::sticking;
  std::vector<Vec3> speed[2];
  for (int in_front_of_edges : {0, 1}) {
    b.cells = in_front_of_edges ? b.dx : 0;  // each particle is in front of a diagonal
    OnPlane water(b);
    water.run(2 * b.dt);
    const Span<const Vec3> v = water.world().velocities(), x = water.world().positions();
    for (std::size_t i = 0; i < v.size(); ++i)
      if (x[i].y() < b.dx) speed[in_front_of_edges].push_back(v[i]);
  }
  ASSERT_EQ(speed[0].size(), static_cast<std::size_t>(b.long_ * b.wide));
  ASSERT_EQ(speed[1].size(), speed[0].size());
  for (std::size_t i = 0; i < speed[0].size(); ++i) {
    EXPECT_GT(speed[0][i].x(), 1e-3);
    EXPECT_NEAR(speed[1][i].x(), speed[0][i].x(), 0.02 * speed[0][i].x());
  }
}

// Lanes side by side, whose floors lie in one plane: the water of one lane must not lean on the floor of the
// next.
TEST_P(WallFriction, floors_side_by_side_keep_their_laws) {
  constexpr double dx = 0.008, wide = 4 * dx, angle = M_PI / 6, friction[] = {0.3, 1};
  WorldSettings ws;
  ws.gravity = g * Vec3(std::sin(angle), -std::cos(angle), 0);
  ws.threads = 1;
  FluidSettings fs;
  fs.spacing = dx;
  fs.solver = GetParam().solver;
  World w(ws, fs);
  test::StaticMesh sides, floor[2];
  for (int k : {0, 1, 2}) sides.add_rectangle({-0.2, -0.1, k * wide}, {1.2, 0, 0}, {0, 0.3, 0});
  SurfaceSettings s = test::sheet_settings();
  ASSERT_TRUE(w.attach(sides, s, nullptr).ok());
  SurfaceId id[2];
  for (int k : {0, 1}) {
    floor[k].add_rectangle({-0.2, 0, k * wide}, {0, 0, wide}, {1.2, 0, 0});
    s.slip = {SlipModel::coulomb, friction[k], 0};
    ASSERT_TRUE(w.attach(floor[k], s, &id[k]).ok());
    BoxEmitter box;  // two layers that slide, one that stays
    box.box = {Vec3(0, 0, k * wide), Vec3(4 * dx, (2 - k) * dx, (k + 1) * wide)};
    ASSERT_TRUE(w.add_emitter(box).ok());
  }
  Vec3 on_floor[2] = {Vec3::Zero(), Vec3::Zero()};
  while (w.time() < 0.35) {
    w.step(0.2 * dx);
    for (int k : {0, 1})
      if (w.time() > 0.12)
        for (const Vec3& impulse : w.surface(id[k])->impulse) on_floor[k] += impulse;
  }
  const double slope = std::tan(angle);
  EXPECT_NEAR(on_floor[0].x() / -on_floor[0].y(), friction[0], 0.03 * friction[0]);
  EXPECT_NEAR(on_floor[1].x() / -on_floor[1].y(), slope, 0.03 * slope);
}

TEST_P(WallFriction, thin_water_that_sticks_stays) {
  Block b = block(1);
  b.slip.model = SlipModel::sticking;
  OnPlane water(b);
  water.run(0.2);
  const double start = OnPlane::mean(water.world().positions()).x();
  water.run(0.5);
  EXPECT_NEAR(OnPlane::mean(water.world().positions()).x(), start, 0.01 * b.dx);
}

TEST_P(WallFriction, free_cloth_gets_the_opposite_momentum_and_energy_falls) {
  for (double areal_density : {0.02, 0.2, 5.0}) {
    WorldSettings ws;
    ws.gravity = Vec3::Zero();
    ws.threads = 1;
    FluidSettings fs;
    fs.solver = GetParam().solver;
    fs.boundary = BoundaryModel::mirrored;
    World w(ws, fs);
    test::GridShape shape;
    shape.origin = Vec3(-0.05, 0, -0.05);
    shape.areal_density = areal_density;
    test::MockCloth<double> cloth(shape);
    SurfaceSettings s = test::sheet_settings();
    s.slip.model = SlipModel::coulomb;
    s.slip.friction = 0.6;
    ASSERT_TRUE(w.attach(cloth, s, nullptr).ok());
    test::add_block(w, 6, {-0.015, 0.0027, -0.015}, {1, -1, 0.3});
    const Vec3 before = test::fluid_momentum(w);
    double tangential = 0;
    for (int k = 0; k < 60; ++k) {
      const StepReport r = w.step(1e-3);
      tangential += r.contact.impulse_on_free_nodes.x();
      EXPECT_LE(r.contact.kinetic_energy_change, 1e-16);
      EXPECT_LT(r.momentum_residual().norm(), 1e-14);
    }
    EXPECT_LT((test::fluid_momentum(w) + cloth.momentum() - before).norm(), 1e-13);
    EXPECT_GT(tangential, 0) << areal_density;
  }
}

TEST_P(WallFriction, a_restored_world_goes_on_bit_for_bit) {
  Block b = block(2);
  b.slip.friction = 1;
  OnPlane first(b), second(b);
  first.run(0.1);
  std::vector<std::uint8_t> saved;
  ASSERT_TRUE(first.world().save(&saved).ok());
  ASSERT_TRUE(second.world().restore(saved).ok());
  first.run(0.13);
  second.run(0.13);
  EXPECT_EQ(first.world().state_hash(), second.world().state_hash());
}

INSTANTIATE_TEST_SUITE_P(Modes, WallFriction,
                         ::testing::Values(Mode{"pcisph", PressureSolver::pcisph},
                                           Mode{"dfsph", PressureSolver::dfsph}),
                         name_of);

/// A half pipe of `facets` facets that opens upwards.
test::StaticMesh bowl(int facets, double radius) {
  test::StaticMesh mesh;
  for (int k = 0; k <= facets; ++k)
    for (double z : {-0.02, 0.02})
      mesh.nodes.push_back({-radius * std::cos(M_PI * k / facets), -radius * std::sin(M_PI * k / facets), z});
  for (std::uint32_t a = 0; a + 2 < mesh.nodes.size(); a += 2) {
    mesh.triangles.push_back({a, a + 3, a + 1});
    mesh.triangles.push_back({a, a + 2, a + 3});
  }
  return mesh;
}

TEST(SmoothBowl, what_slides_to_and_fro_gains_no_energy_and_loses_little) {
  for (int facets : {6, 13, 24}) {
    const double radius = 0.06, start = 1.2, at = radius * std::cos(M_PI / 2 / facets) - 0.0012;
    WorldSettings ws;
    ws.threads = 1;
    FluidSettings fs;
    fs.viscosity = 0, fs.xsph_rate = 0;
    fs.boundary = BoundaryModel::contact_only;
    World w(ws, fs);
    test::StaticMesh mesh = bowl(facets, radius);
    SurfaceSettings s = test::sheet_settings();
    s.smooth = true;
    ASSERT_TRUE(w.attach(mesh, s, nullptr).ok());
    const Vec3 x[] = {{-at * std::sin(start), -at * std::cos(start), 0}}, v[] = {Vec3::Zero()};
    ASSERT_TRUE(w.add_particles(x, v, nullptr).ok());
    const auto energy = [&] { return 0.5 * w.velocities()[0].squaredNorm() + g * w.positions()[0].y(); };
    const double before = energy();
    double highest = before;
    for (int k = 0; k < 700; ++k) {
      w.step(7e-4);
      highest = std::max(highest, energy());
    }
    test::record("energy lost, " + std::to_string(facets), (before - energy()) / (g * radius));
    EXPECT_LT(highest - before, 1e-3 * g * radius) << facets << " facets";
    EXPECT_LT(before - energy(), 0.08 * g * radius) << facets << " facets";
  }
}

}  // namespace
}  // namespace oilskin
