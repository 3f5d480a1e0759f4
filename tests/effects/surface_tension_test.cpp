// Surface tension: its forces, and what a world makes of them. Drops of water: drops_test.cpp.
#include "oilskin/surface_tension.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <memory>

#include "core/closest_point.h"
#include "effects/drop.h"
#include "effects/tension/tension_model.h"
#include "support/random.h"

namespace oilskin {
namespace {

using test::Drop;

/// Particles without a world, so that forces can be compared with energies.
class Cloud : public EffectForces {
 public:
  Cloud(std::vector<Vec3> x, std::vector<float> ratios)
      : x_(std::move(x)), ratios_(std::move(ratios)), ids_(x_.size()), sum_(x_.size(), Vec3::Zero()) {
    spacing = 0.001;
    support_radius = 2 * spacing;
    rest_density = 1000;
    particle_mass = rest_density * std::pow(spacing, 3);
    position = x_;
    mass_ratio = ratios_;
    id = ids_;
    acceleration = sum_;
    for (std::size_t i = 0; i < x_.size(); ++i) {
      lists_.emplace_back();
      for (std::size_t j = 0; j < x_.size(); ++j)
        if (j != i && (x_[i] - x_[j]).norm() < support_radius)
          lists_.back().push_back(static_cast<std::uint32_t>(j));
    }
    walls_.resize(x_.size());
  }
  Span<double> of_particles(std::size_t) override { return {}; }
  Span<double> of_nodes(std::size_t, std::size_t) override { return {}; }
  void for_each(std::size_t n, const std::function<void(std::size_t)>& f) const override {
    for (std::size_t i = 0; i < n; ++i) f(i);
  }
  Span<const std::uint32_t> neighbours(std::size_t i) const override { return lists_[i]; }
  Span<const VisibleWall> walls(std::size_t i) const override { return walls_[i]; }
  void push(std::size_t, const std::array<std::uint32_t, 3>&, const std::array<double, 3>&,
            const Vec3& force) override {
    pushed += force;
  }
  /// Half of the plane y = 0 seen, as two tiles.
  void add_plane() {
    for (std::size_t i = 0; i < x_.size(); ++i)
      for (double share : {0.7, 0.3}) {
        VisibleWall w;
        w.normal = Vec3::UnitY();
        w.distance = x_[i].y();
        w.share = share;
        walls_[i].push_back(w);
      }
  }
  /// A triangle in the plane y = 0, of whose plane the particles see a part.
  void add_triangle(double share) {
    triangle_.x_t0 = {Vec3(0.0005, 0, 0.0005), Vec3(0.003, 0, 0.001), Vec3(0.001, 0, 0.0035)};
    surfaces = Span<SurfaceMotion* const>(&surface_, 1);
    for (std::size_t i = 0; i < x_.size(); ++i) {
      const ClosestPoint c = closest_point(x_[i], triangle_.x_t0[0], triangle_.x_t0[1], triangle_.x_t0[2]);
      VisibleWall w;
      w.nodes = {0, 1, 2};
      w.weights = c.weights;
      w.normal = Vec3::UnitY();
      w.distance = x_[i].y();
      w.share = share;
      walls_[i].push_back(w);
    }
  }
  Vec3 total_force() const {
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < x_.size(); ++i) sum += mass(i) * sum_[i];
    return sum;
  }
  Vec3 total_torque() const {
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < x_.size(); ++i) sum += mass(i) * x_[i].cross(sum_[i]);
    return sum;
  }
  Vec3 pushed = Vec3::Zero();

 private:
  std::vector<Vec3> x_;
  std::vector<float> ratios_;
  std::vector<std::uint64_t> ids_;
  std::vector<Vec3> sum_;
  std::vector<std::vector<std::uint32_t>> lists_;
  std::vector<std::vector<VisibleWall>> walls_;
  SurfaceMotion triangle_;
  SurfaceMotion* surface_ = &triangle_;
};

std::vector<Vec3> scattered(std::size_t count, double size) {
  test::Random random(11);
  std::vector<Vec3> x;
  for (std::size_t i = 0; i < count; ++i)
    x.push_back(size * Vec3(random.uniform(), random.uniform(), random.uniform()) + Vec3(0, 0.0002, 0));
  return x;
}

std::vector<float> ratios(std::size_t count) {
  std::vector<float> r;
  for (std::size_t i = 0; i < count; ++i)
    r.push_back(static_cast<float>(0.3 + 0.7 * static_cast<double>(i) / static_cast<double>(count)));
  return r;
}

/// The energies (S.3) and (S.6), written anew. The attraction of walls is integrated.
double energy_of(const Cloud& c, double sigma, double angle) {
  namespace e = effects;
  const double h = c.support_radius, unit = e::calibration * sigma;
  const e::WallParts parts = e::wall_parts(angle);
  double sum = 0;
  for (std::size_t i = 0; i < c.position.size(); ++i) {
    double lacks = 1 - c.mass(i) / 1000 / (h * h * h) * e::LackKernel::value(0);
    Vec3 slope = Vec3::Zero();
    for (std::uint32_t j : c.neighbours(i)) {
      const Vec3 d = (c.position[i] - c.position[j]) / h;
      const double q = d.norm(), v = c.mass(j) / 1000 / (h * h * h);
      lacks -= v * 105 / (32 * test::pi) * (1 - q * q) * (1 - q * q);
      slope -= v * 210 / test::pi * std::pow(1 - q, 3) * d;
    }
    double at_wall = 0;
    for (const VisibleWall& w : c.walls(i)) {
      double z = w.distance / h, share = w.share;
      Vec3 normal = w.normal;
      if (w.share < 0.5 && c.walls(i).size() == 1) {  // a rim
        Vec3 away = c.position[i];
        for (std::size_t k = 0; k < 3; ++k) away -= w.weights[k] * c.surfaces[0]->x_t0[w.nodes[k]];
        z = away.norm() / h;
        normal = away.normalized();
        share = z < 1 ? 1 : 0;
      }
      const double step = (1 - z) / 4000;
      lacks -= parts.fluid * share * e::LackKernel::half_space(z);
      slope -= parts.fluid * share * e::SlopeKernel::plane(z) * normal;
      for (int k = 0; k < 4000; ++k)
        at_wall -= parts.attraction * share * step * e::half_space_attraction(z + (k + 0.5) * step);
    }
    const double lack = std::max(0.0, lacks);
    sum += unit * c.mass(i) / 1000 / h *
           (0.5 * e::energy_of_lack * lack * lack + 0.5 * e::energy_of_slope * slope.squaredNorm() + at_wall);
  }
  return sum;
}

TEST(SurfaceTension, settings_out_of_range_are_refused_and_do_not_act) {
  const double nan = std::nan("");
  for (SurfaceTensionSettings wrong : {SurfaceTensionSettings{0, 90},
                                       {-1, 90},
                                       {nan, 90},
                                       {std::numeric_limits<double>::infinity(), 90},
                                       {0.07, -1},
                                       {0.07, 180.5},
                                       {0.07, nan}}) {
    SurfaceTension tension(wrong), valid;
    EXPECT_FALSE(tension.status().ok());
    EXPECT_NE(tension.status().message.find("surface_tension."), std::string::npos);
    EXPECT_FALSE(valid.set_settings(wrong).ok());
    EXPECT_EQ(valid.settings().coefficient, 0.0728);
    Cloud cloud(scattered(20, 0.003), ratios(20));
    tension.act(cloud);
    EXPECT_EQ(cloud.total_force(), Vec3::Zero());
    EXPECT_EQ(cloud.acceleration[3], Vec3::Zero());
    EXPECT_FALSE(tension.longest_interval(FluidSettings()) < 1e300);
  }
  EXPECT_TRUE((SurfaceTensionSettings{1e-9, 0}.validate().ok()));
  EXPECT_TRUE((SurfaceTensionSettings{1e3, 180}.validate().ok()));
}

/// Compares forces with differences of the energy; add(cloud) gives it walls.
template <class AddWalls>
void expect_slopes_of_the_energy(const AddWalls& add) {
  const std::vector<Vec3> x = scattered(60, 0.004);
  for (double angle : {0.0, 60.0, 180.0}) {
    SurfaceTension tension({0.05, angle});
    Cloud cloud(x, ratios(x.size()));
    add(cloud);
    tension.act(cloud);
    const double step = 1e-9;
    for (std::size_t i = 0; i < x.size(); i += 7)
      for (int axis = 0; axis < 3; ++axis) {
        double energy[2];
        for (int side = 0; side < 2; ++side) {
          std::vector<Vec3> moved = x;
          moved[i][axis] += (side - 0.5) * step;
          Cloud other(moved, ratios(x.size()));
          add(other);
          energy[side] = energy_of(other, 0.05, angle);
        }
        const double force = cloud.mass(i) * cloud.acceleration[i][axis];
        EXPECT_NEAR(force, (energy[0] - energy[1]) / step, 1e-5 * cloud.mass(i) * 1000) << angle << " " << i;
      }
  }
}

TEST(SurfaceTension, forces_are_the_slope_of_the_energy) {
  expect_slopes_of_the_energy([](Cloud& c) { c.add_plane(); });
}

TEST(SurfaceTension, forces_at_rims_are_the_slope_of_the_energy) {
  expect_slopes_of_the_energy([](Cloud& c) { c.add_triangle(0.3); });
}

// With forces along the normals, in the shares that are seen, it boils there with 0.8 √(σ/ρR).
TEST(SurfaceTension, a_drop_that_wets_a_plate_up_to_its_rim_comes_to_rest) {
  Drop drop(6, 0.0005);
  drop.settings.contact_angle = 50;
  drop.make_world();
  drop.add_plate(5 * drop.dx);
  const double r = drop.radius;
  drop.fill(Vec3(0, 0.52 * drop.dx, 0), r, [r](const Vec3& p) { return p.y() > 0 && p.norm() < r; });
  drop.run(60 * drop.unit(), 0.05 / drop.unit());
  EXPECT_LE(drop.rms_speed(), 0.25 * drop.speed_unit());
  EXPECT_GT(drop.centre().y(), 0) << "on the plate";
}

TEST(SurfaceTension, forces_between_unequal_particles_keep_momentum_and_its_moment) {
  const std::vector<Vec3> x = scattered(400, 0.008);
  SurfaceTension tension;
  Cloud cloud(x, ratios(x.size()));
  tension.act(cloud);
  double scale = 0;
  for (std::size_t i = 0; i < x.size(); ++i) scale += cloud.mass(i) * cloud.acceleration[i].norm();
  EXPECT_GT(scale, 1e-4);
  EXPECT_LE(cloud.total_force().norm(), 1e-13 * scale);
  EXPECT_LE(cloud.total_torque().norm(), 1e-13 * scale * 0.008);
  EXPECT_EQ(cloud.pushed, Vec3::Zero());
}

/// The acceleration of one particle by a plane, from its energy, by integrals over the half-space.
double plane_acceleration(double z, double h, double sigma, double angle, double mass) {
  namespace e = effects;
  const double c = 0.5 * (1 + std::cos(angle * test::pi / 180)), k = std::pow(c, 1.2), zeta = z / h;
  double attraction = 0, half_space = 0, slope = 0;
  const int n = 20000;
  for (int a = 0; a < n; ++a) {  // planes at depth s
    const double s = zeta + (1 - zeta) * (a + 0.5) / n, ds = (1 - zeta) / n;
    attraction += s * fluid::CubicSpline::w(s) * ds;
    half_space += test::pi / 3 * 105 / (32 * test::pi) * std::pow(1 - s * s, 3) * ds;
    slope += 2 * test::pi * s * 21 / (2 * test::pi) * std::pow(1 - s, 4) * (1 + 4 * s) * ds;
  }
  attraction *= 16 * 560. / 31 * std::min(1.0, zeta / 0.25) * c * c * (1.03 + 2.3 * c * (1 - c));
  const double own = mass / 1000 / (h * h * h) * 105 / (32 * test::pi);
  const double lack = std::max(0.0, 1 - own - k * half_space);
  const double plane = 105. / 96 * std::pow(1 - zeta * zeta, 3);
  const double steepness =
      -2 * test::pi * zeta * 21 / (2 * test::pi) * std::pow(1 - zeta, 4) * (1 + 4 * zeta);
  const double towards =
      attraction + e::energy_of_lack * lack * k * plane + e::energy_of_slope * k * k * slope * steepness;
  return e::calibration * sigma / (1000 * h * h) * towards;
}

TEST(SurfaceTension, one_particle_at_a_plane_has_the_acceleration_of_the_formula) {
  for (double angle : {0.0, 75.0, 150.0, 180.0})
    for (double z : {0.0002, 0.0007, 0.0011, 0.0019, 0.0021}) {
      SurfaceTension tension({0.0728, angle});
      Cloud cloud({Vec3(0, z, 0)}, {1.0f});
      cloud.add_plane();
      tension.act(cloud);
      const double expected = z < 0.002 ? plane_acceleration(z, 0.002, 0.0728, angle, cloud.mass(0)) : 0;
      EXPECT_NEAR(-cloud.acceleration[0].y(), expected, 1e-6 * std::abs(expected) + 1e-9)
          << angle << " " << z;
      EXPECT_LE((cloud.pushed + cloud.total_force()).norm(),
                1e-12 * cloud.mass(0) * (1 + std::abs(expected)));
    }
}

TEST(SurfaceTension, particles_and_nodes_get_opposite_momentum) {
  Drop drop(4, 0.0005);
  drop.settings.contact_angle = 50;
  drop.make_world();
  drop.add_plate(0.01);
  const double r = drop.radius;
  drop.fill(Vec3(0, 0.5 * drop.dx, 0), r, [r](const Vec3& p) { return p.y() > 0 && p.norm() < r; });
  for (int k = 0; k < 40; ++k) {
    const StepReport& report = drop.world->step(drop.dt());
    ASSERT_TRUE(report.status.ok());
    ASSERT_LE(report.momentum_residual().norm(), 1e-12 * 1e-5);
    ASSERT_LE(report.momentum_effects.norm(), 1e-12 * 1e-5);
  }
}

TEST(SurfaceTension, nothing_adheres_through_a_second_layer) {
  Vec3 moved[2];
  for (int layers : {1, 2}) {
    Drop drop(1, 0.0005);
    drop.settings.contact_angle = 0;
    drop.make_world();
    drop.add_plate(0.01);
    test::StaticMesh second;
    second.add_rectangle(Vec3(-0.01, -0.0004, 0.01), Vec3(0.02, 0, 0), Vec3(0, 0, -0.02), 8, 8);
    SurfaceId id;
    if (layers == 2) {
      ASSERT_TRUE(drop.world->attach(second, SurfaceSettings(), &id).ok());
    }
    const std::vector<Vec3> x = {Vec3(0, 0.0004, 0)}, v = {Vec3::Zero()};
    ASSERT_TRUE(drop.world->add_particles(x, v).ok());
    ASSERT_TRUE(drop.world->step(1e-6).status.ok());
    moved[layers - 1] = drop.world->velocities()[0];
    if (layers == 2) {
      EXPECT_EQ(load_of(*drop.world->surface(id)).impulse, Vec3::Zero());
    }
  }
  EXPECT_LT(moved[0].y(), -1e-6);
  // With two surfaces six tiles of the first are summed, with one its plane counts: the last bit differs.
  EXPECT_LE((moved[0] - moved[1]).norm(), 1e-14 * moved[0].norm());
}

TEST(SurfaceTension, a_drop_hangs_under_a_sheet_that_it_wets_and_falls_where_it_does_not) {
  for (double angle : {60.0, 180.0}) {
    Drop drop(4, 0.0005);
    drop.gravity = Vec3(0, -9.81, 0);
    drop.settings.contact_angle = angle;
    drop.make_world();
    drop.add_plate(0.01);
    const double r = drop.radius;
    drop.fill(Vec3(0, -0.5 * drop.dx, 0), r, [r](const Vec3& p) { return p.y() < 0 && p.norm() < r; });
    drop.run(0.06);
    if (angle < 90)
      EXPECT_GT(drop.centre().y(), -r) << "free fall: 18 mm";
    else
      EXPECT_LT(drop.centre().y(), -0.012);
  }
}

TEST(SurfaceTension, threads_do_not_change_a_bit) {
  std::uint64_t hash[2];
  for (int threads : {1, 2}) {
    Drop drop(6, 0.0005);
    drop.threads = threads;
    drop.make_world();
    drop.add_plate(0.01);
    const double r = drop.radius;
    drop.fill(Vec3(0, 0.5 * drop.dx, 0), r, [r](const Vec3& p) { return p.y() > 0 && p.norm() < r; });
    drop.run(30 * drop.dt());
    hash[threads - 1] = drop.world->state_hash();
  }
  EXPECT_EQ(hash[0], hash[1]);
}

}  // namespace
}  // namespace oilskin
