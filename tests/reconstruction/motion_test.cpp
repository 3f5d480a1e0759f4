// Meshes in motion: vertex velocities carry a mesh to the next frame, and the place of the grid hardly
// matters.
#include <gtest/gtest.h>

#include <cmath>

#include "oilskin/emitter.h"
#include "oilskin/presets.h"
#include "oilskin/world.h"
#include "reconstruction/promise.h"
#include "support/record.h"
#include "support/static_mesh.h"

namespace oilskin {
namespace {

using test::WaterScene;

/// The surface of a mesh, for distances from points.
class Surface {
 public:
  explicit Surface(const WaterMesh& mesh) : triangles_(mesh.triangles) {
    for (const auto& p : mesh.positions) vertices_.emplace_back(p[0], p[1], p[2]);
    tree_.update(triangles_, vertices_, vertices_, Workers(1));
  }
  double distance(const Vec3& x, double limit) const {
    Box box;
    box.add(x);
    std::vector<std::uint32_t> near;
    tree_.query(box.inflated(limit), near);
    double least = limit;
    for (const std::uint32_t t : near) {
      const Triangle& i = triangles_[t];
      least = std::min(least, closest_point(x, vertices_[i[0]], vertices_[i[1]], vertices_[i[2]]).distance);
    }
    return least;
  }

 private:
  std::vector<Vec3> vertices_;
  std::vector<Triangle> triangles_;
  proximity::SurfaceTree tree_;
};

/// How far the vertices are from the other mesh after a time [m], ascending.
std::vector<double> errors_of_carrying(const WaterMesh& mesh, double time, const WaterMesh& next,
                                       double limit) {
  const Surface surface(next);
  std::vector<double> errors;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const auto &x = mesh.positions[v], &u = mesh.velocities[v];
    const Vec3 carried = Vec3(x[0], x[1], x[2]) + time * Vec3(u[0], u[1], u[2]);
    errors.push_back(surface.distance(carried, limit));
  }
  std::sort(errors.begin(), errors.end());
  return errors;
}

double share_within(const std::vector<double>& ascending, double limit) {
  const auto n = std::lower_bound(ascending.begin(), ascending.end(), limit) - ascending.begin();
  return double(n) / double(ascending.size());
}

struct Frame {
  std::vector<Vec3> positions, velocities;
};

WaterMesh mesh_of(const Frame& frame, const ReconstructionOptions& options,
                  const std::vector<ObstacleMesh>& obstacles = {}) {
  ReconstructionInput input;
  input.positions = frame.positions;
  input.velocities = frame.velocities;
  input.obstacles = obstacles;
  return test::reconstruct(input, options);
}

ReconstructionOptions options_for(double spacing, double cell) {
  ReconstructionOptions options;
  options.spacing = spacing;
  options.cell = cell;
  options.threads = 2;
  return options;
}

class Motion : public testing::TestWithParam<double> {
 protected:
  /// Particles that move by `field` for a unit of time, forwards and backwards. At sharp edges the mesh
  /// itself depends on the place of the grid by more than half a cell, so a few vertices may be farther away.
  void expect_carried(const std::vector<Vec3>& particles, double spacing, const VectorField& field) {
    Frame first, second;
    for (const Vec3& p : particles) {
      const Vec3 u = field(p);
      first.positions.push_back(p);
      second.positions.push_back(p + u);
      first.velocities.push_back(u);
      second.velocities.push_back(u);
    }
    const ReconstructionOptions options = options_for(spacing, GetParam());
    const WaterMesh a = mesh_of(first, options), b = mesh_of(second, options);
    const double cell = GetParam() * spacing;
    const auto expect_near = [&](const char* name, const std::vector<double>& errors) {
      const double share = share_within(errors, 0.5 * cell);
      test::record(std::string(name) + ", share within half a cell", share);
      test::record(std::string(name) + ", largest [cells]", errors.back() / cell);
      EXPECT_GT(share, 0.99);
      EXPECT_LT(errors.back(), cell);
    };
    expect_near("forwards", errors_of_carrying(a, 1, b, 4 * cell));
    expect_near("backwards", errors_of_carrying(b, -1, a, 4 * cell));
    Frame still = first;
    still.velocities.assign(particles.size(), Vec3::Zero());
    EXPECT_GT(errors_of_carrying(mesh_of(still, options), 1, b, 4 * cell).back(), 0.6 * cell)
        << "hardly a motion";
  }
};

WaterScene body() {
  WaterScene s;
  s.add_water({Vec3::Constant(-0.025), Vec3::Constant(0.025)}, 0.1, 1);
  return s;
}

TEST_P(Motion, of_a_body_that_moves_carries_its_mesh) {
  const WaterScene s = body();
  expect_carried(s.particles, s.spacing,
                 [&](const Vec3&) -> Vec3 { return s.spacing * Vec3(1.7, -0.9, 2.3); });
}

TEST_P(Motion, of_a_body_that_rotates_carries_its_mesh) {
  const WaterScene s = body();
  expect_carried(s.particles, s.spacing, rotation_field(Vec3::Zero(), Vec3(1, 2, 3), 0.15));
}

TEST_P(Motion, of_a_drop_that_stretches_carries_its_mesh) {
  WaterScene s;
  s.add_water({Vec3::Constant(-0.025), Vec3::Constant(0.025)}, 0.1, 2,
              [](const Vec3& p) { return p.norm() < 0.02; });
  Eigen::Matrix3d strain = Eigen::Vector3d(-0.1, -0.1, 0.2).asDiagonal();
  expect_carried(s.particles, s.spacing, linear_field(Vec3::Zero(), strain));
}

INSTANTIATE_TEST_SUITE_P(Cells, Motion, testing::Values(0.5, 0.8, 1.0));

/// A small jet on a plate. Drops form and merge from one frame to the next, so a few vertices have no
/// counterpart.
TEST(MotionOfAJet, carries_most_of_its_mesh_to_the_next_step) {
  const double spacing = 0.006;
  const Preset preset = game_preset(spacing);
  WorldSettings settings;
  settings.gravity = Vec3(0, 0, -9.81);
  settings.threads = 2;
  World world(settings, preset.fluid, preset.contact);
  test::StaticMesh plate;
  plate.add_rectangle(Vec3(-0.15, -0.15, 0), 0.3 * Vec3::UnitX(), 0.3 * Vec3::UnitY(), 8, 8);
  SurfaceSettings surface;
  surface.thickness = 0.001;
  ASSERT_TRUE(world.attach(plate, surface, nullptr).ok());
  DiscEmitter nozzle;
  nozzle.center = Vec3(0, 0, 0.06);
  nozzle.direction = Vec3(0, 0, -1);
  nozzle.radius = 0.018;
  ASSERT_TRUE(world.add_emitter(nozzle).ok());
  const double dt = 0.002;
  while (world.time() < 0.15) ASSERT_TRUE(world.step(dt).status.ok());
  // What the nozzle adds in the step has no counterpart.
  const std::size_t count = world.particle_count();
  const std::uint64_t last = *std::max_element(world.ids().begin(), world.ids().end());
  const auto frame = [&] {
    Frame f;
    for (std::size_t i = 0; i < world.particle_count(); ++i) {
      if (world.ids()[i] > last) continue;
      f.positions.push_back(world.positions()[i]);
      f.velocities.push_back(world.motions()[i]);
    }
    return f;
  };
  const Frame first = frame();
  ASSERT_TRUE(world.step(dt).status.ok());
  const Frame second = frame();
  ASSERT_EQ(first.positions.size(), second.positions.size());
  ReconstructionOptions options = options_for(spacing, 0.8);
  options.contact = ObstacleMode::touch;
  options.gap = 0.1 * spacing;
  const std::vector<ObstacleMesh> obstacles = {{plate.nodes, plate.triangles}};
  const WaterMesh a = mesh_of(first, options, obstacles), b = mesh_of(second, options, obstacles);
  const double cell = options.cell * spacing;
  const double forwards = share_within(errors_of_carrying(a, dt, b, 4 * cell), 0.5 * cell),
               backwards = share_within(errors_of_carrying(b, -dt, a, 4 * cell), 0.5 * cell);
  test::record("particles", double(count));
  test::record("forwards", forwards);
  test::record("backwards", backwards);
  EXPECT_GT(count, 500u);
  EXPECT_GT(forwards, 0.9);
  EXPECT_GT(backwards, 0.9);
}

/// The area of a mesh.
double area(const WaterMesh& mesh) {
  double sum = 0;
  for (const Triangle& t : mesh.triangles) {
    Vec3 c[3];
    for (std::size_t k = 0; k < 3; ++k) c[k] = test::position(mesh, t[k]);
    sum += 0.5 * (c[1] - c[0]).cross(c[2] - c[0]).norm();
  }
  return sum;
}

/// A film of particles `distance` spacings apart on a wavy sheet, and drops on and above it.
WaterScene film_and_drops(double distance, std::uint64_t seed = 3) {
  WaterScene s;
  const auto height = [](double x, double y) { return test::waves(x, y, 0.004, 0.08); };
  s.add_sheet(24, [&](double u, double v) { return Vec3(0.12 * u, 0.12 * v, height(0.12 * u, 0.12 * v)); });
  test::Random random(seed);
  const double step = distance * s.spacing;
  for (double y = 0.02; y < 0.07; y += step)
    for (double x = 0.02; x < 0.1; x += step) {
      const Vec3 at(x + random.uniform(-0.2, 0.2) * step, y + random.uniform(-0.2, 0.2) * step, 0);
      s.particles.push_back(at + Vec3(0, 0, height(at.x(), at.y()) + random.uniform(0.2, 0.45) * s.spacing));
    }
  for (int n = 0; n < 30; ++n) {
    const double x = 0.02 + 0.02 * (n % 5), y = 0.088 + 0.012 * (n / 15);
    s.particles.push_back(Vec3(x, y, height(x, y) + s.spacing * (0.3 + 2.5 * (n / 5 % 3))));
  }
  s.push_off(0.2);
  return s;
}

class Place : public testing::TestWithParam<double> {};

/// Bounds of the change of the area, over all cases.
struct AreaBounds {
  double rms, most;
};

/// With large cells the area of a film changes by more: a row of cells at its rim.
AreaBounds area_bounds(double cell) {
  if (cell < 0.6) return {0.004, 0.01};
  return cell < 1 ? AreaBounds{0.018, 0.035} : AreaBounds{0.035, 0.065};
}

TEST_P(Place, of_the_grid_hardly_changes_films_and_drops_at_cloth) {
  double squares = 0, most = 0;
  int cases = 0;
  for (const std::uint64_t seed : {3, 4, 5})
    for (const double distance : {1.0, 2.0})
      for (const ObstacleMode mode : {ObstacleMode::touch, ObstacleMode::gap}) {
        const WaterScene s = film_and_drops(distance, seed);
        const ReconstructionOptions options = test::options_for(s, GetParam(), 0.1, mode);
        const WaterMesh mesh = test::reconstruct(s.input(), options);
        const double volume = check_mesh(mesh, {}, 0).volume;
        for (const Vec3& direction : {Vec3(1, 1, 1), Vec3(1, 0, 0), Vec3(0, 0, 1)}) {
          WaterScene moved = s;
          const Vec3 by = 0.37 * GetParam() * s.spacing * direction;
          for (Vec3& p : moved.particles) p += by;
          for (Vec3& v : moved.vertices) v += by;
          const WaterMesh other = test::reconstruct(moved.input(), options);
          EXPECT_NEAR(check_mesh(other, {}, 0).volume / volume, 1, 0.005) << distance << ' ' << int(mode);
          const double area_error = area(other) / area(mesh) - 1;
          squares += area_error * area_error;
          most = std::max(most, std::abs(area_error));
          ++cases;
        }
      }
  const double rms = std::sqrt(squares / cases);
  test::record("area, rms", rms);
  test::record("area, largest", most);
  EXPECT_LT(rms, area_bounds(GetParam()).rms);
  EXPECT_LT(most, area_bounds(GetParam()).most);
}

INSTANTIATE_TEST_SUITE_P(Cells, Place, testing::Values(0.5, 0.8, 1.0));

/// The fit and the touch move vertices out of the kernel radius of all particles.
TEST(MotionOfVertices, that_no_particle_reaches_is_that_of_the_nearest) {
  const Vec3 motion(1, -2, 0.5);
  std::size_t beyond = 0;
  for (const double distance : {1.0, 2.0, 2.9})
    for (const double cell : {0.5, 1.0}) {
      WaterScene s = film_and_drops(distance);
      s.add_water({Vec3(0.02, 0.02, 0.02), Vec3(0.05, 0.05, 0.03)}, 0.2, 5);
      ReconstructionOptions options = test::options_for(s, cell, 0.1, ObstacleMode::touch);
      options.kernel_radius = 1.5;
      options.touch_range = 1.5;
      options.nearest = true;
      const std::vector<double> volumes(s.particles.size(), 3 * std::pow(s.spacing, 3));
      const std::vector<Vec3> velocities(s.particles.size(), motion);
      ReconstructionInput input = s.input();
      input.volumes = volumes;
      input.velocities = velocities;
      const WaterMesh mesh = test::reconstruct(input, options);
      for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
        const auto& u = mesh.velocities[v];
        ASSERT_LT((Vec3(u[0], u[1], u[2]) - motion).norm(), 1e-4) << v;
        ASSERT_LT(mesh.nearest[v], s.particles.size());
        const double away = (test::position(mesh, v) - s.particles[mesh.nearest[v]]).norm();
        beyond += away > options.kernel_radius * s.spacing;
      }
    }
  EXPECT_GT(beyond, 10u) << "the case tests nothing";
}

}  // namespace
}  // namespace oilskin
