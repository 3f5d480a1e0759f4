/// Viscous flow between two parallel sheets, from rest, and its series of [Morris1997], (F.51) and (F.52).
///
/// The World has no periodic boundary, so a slug of fluid fills a piece of the channel: open ends along x,
/// free-slip walls across z, driven by gravity along x. At the Reynolds numbers here it moves by a tenth of a
/// spacing before the flow is steady. Particles at the ends and at the free-slip walls lack the neighbours
/// that carry momentum between layers, so the slug is 1.6 channel widths deep, and only its middle is looked
/// at; what they still do there is below 2 %. With boundary terms pressure carries the momentum that the
/// walls do not take at the ends, too: 4 % of the stress in the middle of a slug of 4 widths, 1 % of one
/// of 8.
#pragma once

#include <gtest/gtest.h>

#include <cmath>

#include "oilskin/implicit_viscosity.h"
#include "support/static_mesh.h"
#include "support/world_helpers.h"

namespace oilskin::test {

struct Channel {
  int across = 10;  // particles
  PressureSolver solver = PressureSolver::pcisph;
  BoundaryModel boundary = BoundaryModel::contact_only;
  SlipSettings slip{SlipModel::viscous_wall};
  double poiseuille = 0.01;  // Re = peak D/ν of the driven flow
  double couette = 0;        // Re = V D/ν, V the speed of the upper sheet
  double looseness = 1;      // spacing of the lattice over that of the fluid
  double viscosity = 0.01;   // ν [m²/s]
  double dt = 0;             // [s]; 0: what the explicit term takes
  bool implicit = false;     // the effect instead of the explicit term
  double support_ratio = 2;
  int widths = 4;  // length of the slug
};

class ChannelFlow {
 public:
  static constexpr double width = 0.05, density = 1000;  // D [m], ρ [kg/m³]
  const double viscosity;                                // ν [m²/s]

  explicit ChannelFlow(const Channel& c)
      : viscosity(c.viscosity),
        channel_(c),
        dx_(width / c.across),
        dt_(c.dt > 0 ? c.dt : 0.125 * dx_ * dx_ / viscosity),
        force_(8 * c.poiseuille * viscosity * viscosity / std::pow(width, 3)),
        world_(world_settings(), fluid_settings()),
        effect_({c.viscosity}) {
    EXPECT_TRUE(world_.status().ok()) << world_.status().message;
    if (c.implicit) {
      EXPECT_TRUE(world_.add_effect(effect_).ok());
    }
    // The first layer is half a spacing off: within reach of every slip law, nearer than which nothing comes.
    SurfaceSettings wall = sheet_settings(0.45 * dx_);
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
  const ImplicitViscosity& effect() const { return effect_; }

  void step() {
    momentum_before_ = momentum_in_the_middle();
    EXPECT_TRUE(world_.step(dt_).status.ok());
  }
  void run_to(double time_end) {
    while (time() < time_end - 1e-9) step();
  }

  /// The series at the present time. The implicit term takes its steps by implicit Euler: then each member of
  /// the series decays as in that scheme, so that steps longer than D²/ν have a reference, too.
  double exact(double y) const {
    const double eta = y / width;
    double u = 4 * peak() * eta * (1 - eta) + moving_wall() * eta;
    for (int n = 0; n < 200; ++n) {
      const double k = (2 * n + 1) * M_PI;
      u -= 32 * peak() / (k * k * k) * std::sin(k * eta) * decay(k);
    }
    for (int n = 1; n < 200; ++n) {
      const double k = n * M_PI;
      u += 2 * moving_wall() / k * (n % 2 ? -1 : 1) * std::sin(k * eta) * decay(k);
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
  double decay(double k) const {
    if (!channel_.implicit) return std::exp(-k * k * time());
    return std::pow(1 + k * k * viscosity * dt_ / (width * width), -std::round(world_.time() / dt_));
  }
  int columns() const { return channel_.widths * channel_.across; }
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
    s.viscosity = channel_.implicit ? 0 : viscosity;
    s.xsph_rate = 0;
    s.support_ratio = channel_.support_ratio;
    s.boundary = channel_.boundary;
    return s;
  }

  Channel channel_;
  double dx_, dt_, force_, momentum_before_ = 0;
  World world_;
  ImplicitViscosity effect_;
  SlidingMesh bottom_, top_;
  StaticMesh sides_;
  SurfaceId sheet_[2];
};

}  // namespace oilskin::test
