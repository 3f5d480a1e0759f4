// Viscous flow between two parallel sheets against the series of [Morris1997], (F.51) and (F.52):
// plane Poiseuille and Couette flow from rest, wall force, free slip.
//
// The World has no periodic boundary, so a slug of fluid fills a piece of the channel: open ends along x,
// free-slip walls across z, driven by gravity along x. At the Reynolds numbers here it moves by a tenth of a
// spacing before the flow is steady. Particles at the ends and at the free-slip walls lack the neighbours
// that carry momentum between layers, so the slug is 4 channel widths long and 1.6 deep, and only its middle
// is looked at; what they still do there is below 2 %.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "support/record.h"
#include "support/static_mesh.h"
#include "support/world_helpers.h"

namespace oilskin {
namespace {

struct Channel {
  int across = 10;  // particles
  PressureSolver solver = PressureSolver::pcisph;
  BoundaryModel boundary = BoundaryModel::contact_only;
  SlipSettings slip{SlipModel::viscous_wall};
  double poiseuille = 0.01;  // Re = peak D/ν of the driven flow
  double couette = 0;        // Re = V D/ν, V the speed of the upper sheet
  double looseness = 1;      // spacing of the lattice over that of the fluid
};

class ChannelFlow {
 public:
  static constexpr double width = 0.05, viscosity = 0.01, density = 1000;  // D [m], ν [m²/s], ρ [kg/m³]

  explicit ChannelFlow(const Channel& c)
      : channel_(c),
        dx_(width / c.across),
        dt_(0.125 * dx_ * dx_ / viscosity),
        force_(8 * c.poiseuille * viscosity * viscosity / std::pow(width, 3)),
        world_(world_settings(), fluid_settings()) {
    EXPECT_TRUE(world_.status().ok()) << world_.status().message;
    // The first layer is half a spacing off: within reach of every slip law, nearer than which nothing comes.
    SurfaceSettings wall = test::sheet_settings(0.45 * dx_);
    const double around = 0.3 * width;
    const Vec3 low(-0.5 * length() - around, 0, -around);
    const Vec3 along(length() + 2 * around, 0, 0), up(0, width, 0), side(0, 0, depth() + 2 * around);
    const auto cells = [&](const Vec3& e) { return static_cast<std::uint32_t>(std::lround(e.norm() / dx_)); };
    bottom_.add_rectangle(low, along, side, cells(along), cells(side));
    top_.add_rectangle(low + up, along, side, cells(along), cells(side));
    for (double z : {0.0, depth()})
      sides_.add_rectangle({low.x(), -around, z}, along, up + 2 * around * Vec3::UnitY(), 40, 4);
    top_.speed = moving_wall();
    EXPECT_TRUE(world_.attach(sides_, wall, nullptr).ok());
    wall.slip = c.slip;
    EXPECT_TRUE(world_.attach(bottom_, wall, &sheet_[0]).ok());
    EXPECT_TRUE(world_.attach(top_, wall, &sheet_[1]).ok());
    std::vector<Vec3> x;
    for (int i = 0; i < columns(); ++i)
      for (int j = 0; j < c.across; ++j)
        for (int k = 0; k < layers_deep(); ++k)
          x.push_back(dx_ * Vec3(i + 0.5 - 0.5 * columns(), j + 0.5, k + 0.5));
    std::uint64_t blocked = 0;
    EXPECT_TRUE(world_.add_particles(x, std::vector<Vec3>(x.size(), Vec3::Zero()), &blocked).ok());
    EXPECT_EQ(blocked, 0u);
  }

  double time() const { return viscosity * world_.time() / (width * width); }  // ν t/D²
  double dt() const { return dt_; }
  double body_force() const { return force_; }
  double peak() const { return force_ * width * width / (8 * viscosity); }
  double moving_wall() const { return channel_.couette * viscosity / width; }
  const World& world() const { return world_; }

  void step() {
    momentum_before_ = momentum_in_the_middle();
    EXPECT_TRUE(world_.step(dt_).status.ok());
  }
  void run_to(double time_end) {
    while (time() < time_end - 1e-9) step();
  }

  /// The series at the present time.
  double exact(double y) const {
    const double t = time(), eta = y / width;
    double u = 4 * peak() * eta * (1 - eta) + moving_wall() * eta;
    for (int n = 0; n < 200; ++n) {
      const double k = (2 * n + 1) * M_PI;
      u -= 32 * peak() / (k * k * k) * std::sin(k * eta) * std::exp(-k * k * t);
    }
    for (int n = 1; n < 200; ++n) {
      const double k = n * M_PI;
      u += 2 * moving_wall() / k * (n % 2 ? -1 : 1) * std::sin(k * eta) * std::exp(-k * k * t);
    }
    return u;
  }

  /// Velocity along the channel at y, from the two layers around it; means over the middle.
  double velocity(double y) const {
    double sum = 0, weights = 0;
    for_middle([&](std::size_t i) {
      const double w = std::max(0.0, 1 - std::abs(world_.positions()[i].y() - y) / dx_);
      sum += w * world_.velocities()[i].x();
      weights += w;
    });
    return sum / weights;
  }
  double max_deviation() const {
    double largest = 0;
    for_middle([&](std::size_t i) {
      const double off = world_.velocities()[i].x() - exact(world_.positions()[i].y());
      largest = std::max(largest, std::abs(off));
    });
    return largest;
  }

  /// Shear stress on a sheet (0 below, 1 above) in the middle over the last step [Pa].
  double wall_stress(int sheet) const {
    const SurfaceMotion& m = *world_.surface(sheet_[sheet]);
    const auto inside = [&](double off, double half) {  // the tent of a node at the end reaches over it
      return std::clamp(0.5 - (std::abs(off) - half) / dx_, 0.0, 1.0);
    };
    double impulse = 0;
    for (std::size_t i = 0; i < m.impulse.size(); ++i)
      impulse += inside(m.x_t1[i].x(), 0.5 * width) * inside(m.x_t1[i].z() - 0.5 * depth(), 2 * dx_) *
                 m.impulse[i].x();
    return impulse / (dt_ * width * 4 * dx_);
  }
  /// What both sheets must take together: what the body force gives and the fluid does not keep [Pa].
  double stress_by_balance() const {
    const double kept = (momentum_in_the_middle() - momentum_before_) / dt_;
    return density * force_ * width - kept / (width * 4 * dx_);
  }

 private:
  int columns() const { return 4 * channel_.across; }
  int layers_deep() const { return 2 * (8 * channel_.across / 10); }
  double length() const { return columns() * dx_; }
  double depth() const { return layers_deep() * dx_; }
  template <class F>
  void for_middle(const F& f) const {
    for (std::size_t i = 0; i < world_.particle_count(); ++i) {
      const Vec3& x = world_.positions()[i];
      if (std::abs(x.x()) < 0.5 * width && std::abs(x.z() - 0.5 * depth()) < 2 * dx_) f(i);
    }
  }
  double momentum_in_the_middle() const {
    double p = 0;
    for_middle([&](std::size_t i) { p += world_.particle_mass() * world_.velocities()[i].x(); });
    return p;
  }
  WorldSettings world_settings() const {
    WorldSettings s;
    s.gravity = Vec3(force_, 0, 0);
    s.kill_box = {Vec3::Constant(-1), Vec3::Constant(1)};
    return s;
  }
  FluidSettings fluid_settings() const {
    FluidSettings s;
    s.spacing = dx_ / channel_.looseness;
    s.rest_density = density;
    s.solver = channel_.solver;
    s.viscosity = viscosity;
    s.xsph_rate = 0;
    s.boundary = channel_.boundary;
    return s;
  }

  Channel channel_;
  double dx_, dt_, force_, momentum_before_ = 0;
  World world_;
  test::SlidingMesh bottom_, top_;
  test::StaticMesh sides_;
  SurfaceId sheet_[2];
};

/// Shear viscosity of the fluid models on a lattice whose axes lie along the flow, relative to ν, at H = 2
/// dx: what flows of this kind see, since their particles stay in layers. Sums over the lattice of the pair
/// terms as they are written; those of PCISPH and DFSPH are made so that it is 1.
double lattice_viscosity(PressureSolver solver) {
  return solver == PressureSolver::mcg03 ? 0.9786 : 1;
}

/// Is the fluid's own viscosity right here, so that the series may be asked for?
bool is_true_viscosity(double ratio) {
  return std::abs(ratio - 1) < 0.05;
}

/// The steady profile over the series' peak at the middle, of n layers that exchange momentum by ratio × ν
/// and have the wall half a spacing off the outer ones: the discrete model that the viscous wall law belongs
/// to. 1 + O(1/n²) for ratio 1.
double peak_of_layers(int n, double ratio) {
  // u_1 = F n dx²/(4ν) from the wall; (u_{j+1} − u_j) ratio ν/dx = F dx (n/2 − j) across j | j+1
  double u = n / 4.0;
  for (int j = 1; j < n / 2; ++j) u += (0.5 * n - j) / ratio;
  return u / (n * n / 8.0);
}
double peak_of_glued_layers(int n, double ratio) {
  return peak_of_layers(n, ratio) - (n / 4.0) / (n * n / 8.0);
}

struct Mode {
  const char* name;
  PressureSolver solver;
  BoundaryModel boundary;
};
void PrintTo(const Mode& mode, std::ostream* out) {
  *out << mode.name;
}

const Mode pcisph{"pcisph", PressureSolver::pcisph, BoundaryModel::contact_only};
const Mode pcisph_mirrored{"pcisph_mirrored", PressureSolver::pcisph, BoundaryModel::mirrored};
const Mode dfsph_mirrored{"dfsph_mirrored", PressureSolver::dfsph, BoundaryModel::mirrored};
const Mode mcg03{"mcg03", PressureSolver::mcg03, BoundaryModel::contact_only};
std::string name_of(const ::testing::TestParamInfo<Mode>& mode) {
  return mode.param.name;
}

/// The flow in each mode; `across` particles unless OILSKIN_CHANNEL_ACROSS says otherwise.
class Flow : public ::testing::TestWithParam<Mode> {
 protected:
  static Channel channel(SlipModel slip, int across) {
    Channel c;
    c.solver = GetParam().solver;
    c.boundary = GetParam().boundary;
    c.slip.model = slip;
    const char* asked = std::getenv("OILSKIN_CHANNEL_ACROSS");
    c.across = asked != nullptr ? std::atoi(asked) : across;
    return c;
  }
};

class Poiseuille : public Flow {};
class PoiseuilleSticking : public Flow {};
class PoiseuilleFreeSlip : public Flow {};
class Couette : public Flow {};

TEST_P(Poiseuille, the_viscous_wall_gives_the_profile_and_the_wall_force) {
  const Channel c = channel(SlipModel::viscous_wall, 10);
  const double ratio = lattice_viscosity(c.solver);
  ChannelFlow flow(c);
  // With boundary terms the slug first settles against its walls, at speeds like those of the flow.
  const bool settles = c.boundary == BoundaryModel::mirrored;
  for (double t : {0.1, 0.2, 0.5}) {
    flow.run_to(t);
    if (settles && t < 0.5) continue;
    const double stress = flow.wall_stress(0) + flow.wall_stress(1);
    const std::string at = " at " + std::to_string(t);
    test::record("largest deviation over peak" + at, flow.max_deviation() / flow.peak());
    test::record("wall force over balance" + at, stress / flow.stress_by_balance());
    // What flows in from the ends is the rest; 4.6 % with boundary terms, whose cause is not known yet.
    EXPECT_NEAR(stress, flow.stress_by_balance(), (settles ? 0.05 : 0.02) / ratio * stress);
    EXPECT_NEAR(flow.wall_stress(0), flow.wall_stress(1), (settles ? 2e-2 : 1e-3) * stress);
    if (is_true_viscosity(ratio)) {
      EXPECT_LT(flow.max_deviation(), (settles ? 0.06 : 0.05) * flow.peak());
    }
  }
  EXPECT_NEAR(flow.velocity(0.5 * flow.width) / flow.peak(), peak_of_layers(c.across, ratio), 0.05 / ratio);
}

// With contact alone the first layer stands still. With boundary terms it lies in the viscous sublayer of so
// thick a liquid (y⁺² = 0.02), where sticking is the viscous wall.
TEST_P(PoiseuilleSticking, the_first_layer_is_at_rest_or_in_the_viscous_sublayer) {
  const Channel c = channel(SlipModel::sticking, 8);
  ChannelFlow flow(c);
  flow.run_to(0.5);
  const double middle = flow.velocity(0.5 * flow.width) / flow.peak();
  test::record("middle over peak", middle);
  const double ratio = lattice_viscosity(c.solver), z = 0.5 / c.across;
  const double first = flow.velocity(z * flow.width) / flow.peak();
  test::record("first layer over peak", first);
  if (c.boundary == BoundaryModel::contact_only) {
    EXPECT_NEAR(first, 0, 1e-3);
    EXPECT_NEAR(middle, peak_of_glued_layers(c.across, ratio), 0.06);
  } else {
    EXPECT_NEAR(first, 4 * z * (1 - z), 0.05);
    EXPECT_NEAR(middle, peak_of_layers(c.across, ratio), 0.06);
  }
}

// Without boundary terms: with them the slug settles, see above.
TEST_P(PoiseuilleFreeSlip, the_velocity_is_the_integral_of_the_body_force) {
  Channel c = channel(SlipModel::free, 10);
  // Or the lattice's density is ρ0 up to rounding, and where it rounds up there is pressure.
  c.looseness = 1.001;
  ChannelFlow flow(c);
  for (int k = 1; k <= 50; ++k) {
    flow.step();
    const double expected = flow.body_force() * flow.dt() * k;
    for (const Vec3& v : flow.world().velocities()) ASSERT_NEAR(v.x(), expected, 1e-10 * expected);
    ASSERT_EQ(flow.wall_stress(0), 0);
    ASSERT_EQ(flow.wall_stress(1), 0);
  }
}

TEST_P(Couette, flow_between_a_sheet_that_slides_and_one_at_rest) {
  Channel c = channel(SlipModel::viscous_wall, 8);
  c.poiseuille = 0;
  c.couette = 0.01;
  ChannelFlow flow(c);
  for (double t : {0.2, 0.5, 0.8}) {
    flow.run_to(t);
    test::record("largest deviation over V at " + std::to_string(t),
                 flow.max_deviation() / flow.moving_wall());
  }
  EXPECT_LT(flow.max_deviation(), 0.03 * flow.moving_wall());
  const double dx = flow.width / c.across, ratio = lattice_viscosity(c.solver);
  const double stress = flow.density * flow.viscosity * flow.moving_wall() / (dx + (flow.width - dx) / ratio);
  // PCISPH with contact alone holds no pressure in so shallow a slug: the first layer drifts off the wall.
  const bool drifts = c.solver == PressureSolver::pcisph && c.boundary == BoundaryModel::contact_only;
  const double tolerance = (drifts ? 0.25 : 0.06) * stress;
  EXPECT_NEAR(flow.wall_stress(0), stress, tolerance);
  EXPECT_NEAR(flow.wall_stress(1), -stress, tolerance);
}

// Each mode with some law; `Long` has the other pairs, for the label slow.
INSTANTIATE_TEST_SUITE_P(Modes, Poiseuille, ::testing::Values(pcisph, dfsph_mirrored), name_of);
INSTANTIATE_TEST_SUITE_P(Long, Poiseuille, ::testing::Values(pcisph_mirrored, mcg03), name_of);
INSTANTIATE_TEST_SUITE_P(Modes, PoiseuilleSticking, ::testing::Values(mcg03, pcisph_mirrored), name_of);
INSTANTIATE_TEST_SUITE_P(Long, PoiseuilleSticking, ::testing::Values(pcisph, dfsph_mirrored), name_of);
INSTANTIATE_TEST_SUITE_P(Modes, PoiseuilleFreeSlip, ::testing::Values(pcisph, mcg03), name_of);
INSTANTIATE_TEST_SUITE_P(Modes, Couette, ::testing::Values(pcisph, dfsph_mirrored), name_of);
INSTANTIATE_TEST_SUITE_P(Long, Couette, ::testing::Values(pcisph_mirrored, mcg03), name_of);

}  // namespace
}  // namespace oilskin
