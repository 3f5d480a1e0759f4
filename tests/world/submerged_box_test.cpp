/// Water around a box that stands still in a tank.
#include <gtest/gtest.h>

#include <cmath>

#include "support/record.h"
#include "support/static_mesh.h"
#include "support/world_helpers.h"

namespace oilskin {
namespace {

constexpr double dx = 0.02, side = 14 * dx, depth = 10 * dx, half = 3 * dx, height = 3 * dx;

/// A tank with a box in its middle, `gap` [dx] above the floor, and water around both.
class SubmergedBox {
 public:
  explicit SubmergedBox(double gap) : bottom_(gap * dx), world_(test::under_gravity(), test::of_spacing(dx)) {
    tank_.add_box({Vec3::Zero(), Vec3(side, 2 * depth, side)}, 2 * dx);
    box_.add_box({middle() - Vec3(half, -bottom_, half), middle() + Vec3(half, bottom_ + height, half)}, dx);
    for (SurfaceHost* host : {static_cast<SurfaceHost*>(&tank_), static_cast<SurfaceHost*>(&box_)})
      EXPECT_TRUE(world_.attach(*host, test::sheet_settings(0.2 * dx), nullptr).ok());
    std::vector<Vec3> x;
    for (double a = 0.5 * dx; a < side; a += dx)
      for (double b = 0.525 * dx; b < depth; b += dx)
        for (double c = 0.5 * dx; c < side; c += dx)
          if (!is_in_box({a, b, c})) x.emplace_back(a, b, c);
    EXPECT_TRUE(world_.add_particles(x, std::vector<Vec3>(x.size(), Vec3::Zero()), nullptr).ok());
  }

  void run(double seconds) {
    for (const double end = world_.time() + seconds; world_.time() < end;)
      ASSERT_TRUE(world_.step(0.005).status.ok());
  }
  /// Below the box.
  bool is_in_slot(const Vec3& x) const {
    const Vec3 d = x - middle();
    return std::abs(d.x()) < half && std::abs(d.z()) < half && x.y() < bottom_;
  }
  /// Root mean square speed [m/s] in or outside of the slot.
  double speed(bool in_slot) const {
    double sum = 0;
    int n = 0;
    for (std::size_t i = 0; i < world_.particle_count(); ++i)
      if (is_in_slot(world_.positions()[i]) == in_slot) sum += world_.motions()[i].squaredNorm(), ++n;
    EXPECT_GT(n, 0);
    return std::sqrt(sum / n);
  }
  int in_slot() const {
    int n = 0;
    for (const Vec3& x : world_.positions()) n += is_in_slot(x);
    return n;
  }

 private:
  static Vec3 middle() { return {side / 2, 0, side / 2}; }
  bool is_in_box(const Vec3& x) const {
    const Vec3 d = x - middle();
    const double around = half + 0.3 * dx;
    return std::abs(d.x()) < around && std::abs(d.z()) < around && x.y() > bottom_ - 0.3 * dx &&
           x.y() < bottom_ + height + 0.3 * dx;
  }

  const double bottom_;
  test::StaticMesh tank_, box_;
  World world_;
};

// With gradients corrected beside its edges (F.77) it moves at 0.1 √(g dx).
TEST(SubmergedBox, water_around_it_comes_to_rest) {
  SubmergedBox box(3);
  box.run(2);
  double speed = 0;
  for (int k = 0; k < 5; ++k) {
    box.run(0.1);
    speed += box.speed(false) / 5;
  }
  test::record("rms speed / √(g dx)", speed / std::sqrt(9.81 * dx));
  EXPECT_LT(speed, 0.07 * std::sqrt(9.81 * dx));
}

// Without (B.42) the slot takes a third of its water, which flies through it with metres per second.
TEST(SubmergedBox, a_slot_below_it_holds_its_volume) {
  for (const double gap : {0.5, 0.75}) {
    SubmergedBox box(gap);
    box.run(2);
    double water = 0, speed = 0;
    for (int k = 0; k < 5; ++k) {
      box.run(0.1);
      water += box.in_slot() / 5.0;
      speed += box.speed(true) / 5;
    }
    const double volume = 4 * half * half * gap / (dx * dx);
    test::record("particles over the slot's volume", water / volume);
    test::record("rms speed / √(g dx)", speed / std::sqrt(9.81 * dx));
    EXPECT_NEAR(water / volume, 1, 0.3);
    EXPECT_LT(speed, 1.0 * std::sqrt(9.81 * dx));
  }
}

}  // namespace
}  // namespace oilskin
