// Hard cases 13 to 15, 26: extreme speeds, teleports.
#include <gtest/gtest.h>

#include <cmath>

#include "hard_cases/cloth_scene.h"
#include "hard_cases/hard_case.h"
#include "support/random.h"

namespace oilskin::test {
namespace {

template <class Scalar>
Found shoot_jet(bool pinned, int layers) {
  ClothSetup setup;
  setup.pinned = pinned;
  setup.layers = layers;
  setup.world.gravity.setZero();
  setup.world.kill_box = {Vec3::Constant(-4), Vec3::Constant(4)};
  const auto make = [&](int threads) {
    return std::make_unique<ClothScene<Scalar>>(setup, threads, [](ClothScene<Scalar>& s) {
      DiscEmitter jet;
      jet.radius = 0.006;
      jet.center = Vec3(0.003, 0.06, -0.002);
      jet.direction = Vec3(0.1, -1, 0.05);
      jet.speed = 500;
      jet.stop = 0.001;
      EXPECT_TRUE(s.world().add_emitter(jet).ok());
    });
  };
  return run_checked(make, 3, 1e-3);
}

TEST(HardMotion, a_jet_of_500_metres_per_second_passes_neither_one_layer_nor_ten) {
  HardCase c("13", "a 500 m/s jet (0.5 m a step) on pinned and free sheets, 1 and 10 layers");
  Found all;
  for (bool pinned : {true, false})
    for (int layers : {1, 10}) {
      SCOPED_TRACE(std::string(pinned ? "pinned, " : "free, ") + count(layers));
      all.add(shoot_jet<float>(pinned, layers));
      all.add(shoot_jet<double>(pinned, layers));
    }
  EXPECT_TRUE(std::isfinite(all.impulse));
  c.note("paths", all.audit.particles);
  c.no_crossings(all);
  c.above("peak force on a node [N]", all.impulse / 1e-3, 0);
  c.note("steps", all.intervals);
  c.note("ccd iterations", all.total.ccd_iterations);
  c.note("zone rounds", all.total.zone_rounds);
}

TEST(HardMotion, single_particles_of_5000_metres_per_second_are_stopped) {
  HardCase c("14", "single particles of 5,000 m/s (5 m a step) at 1 and 10 layers, pinned and free");
  Found all;
  std::uint64_t passed = 0;
  for (const HostKind& host : host_kinds)
    for (int layers : {1, 10}) {
      SCOPED_TRACE(std::string(host.name) + ", " + count(layers) + " layers");
      Random random(14);
      for (int k = 0; k < 12; ++k) {
        ContactScene scene;
        for (int l = 0; l < layers; ++l) {
          scene.surfaces.push_back(square_sheet(host));
          scene.surfaces.back().id = static_cast<std::uint64_t>(l + 1);
          lift(scene.surfaces.back(), -0.003 * l);
        }
        const Vec3 displacement = (Vec3(0, -1, 0) + 0.5 * random.in_cube(1)).normalized();
        const Vec3 target(random.uniform(-0.015, 0.015), 0, random.uniform(-0.015, 0.015));
        scene.particles.add(target - random.uniform(0.2, 4.5) * displacement, 5000 * displacement,
                            particle_mass);
        CheckedContact check(scene);
        check.run(1);
        all.add(check.found);
        if (!host.free) passed += check.scene.particles.x_t0[0].y() < 0;
      }
    }
  c.note("shots", all.audit.particles);
  c.no_crossings(all);
  c.equal("through pinned sheets", passed, 0);
  c.note("impacts", all.total.impacts);
  c.note("zone rounds", all.total.zone_rounds);
  c.note("largest impulse on a node [N s]", all.impulse);
}

struct Swept {
  Found found;
  double drift = 0, pool_speed = 0;
};

// turn = 0: moved by 0.5 m each step; else turned by that angle each step about the z axis.
template <class Scalar>
Swept sweep_pool(bool pinned, double turn) {
  ClothSetup setup;
  setup.pinned = pinned;
  setup.shape.origin.y() = turn == 0 ? -0.2 : 0;
  setup.world.gravity.setZero();
  setup.world.kill_box = {Vec3::Constant(-4), Vec3::Constant(4)};
  const Eigen::Matrix3d rotation = Eigen::AngleAxisd(turn, Vec3(0, 0, 1)).toRotationMatrix();
  Swept swept;
  Vec3 start = Vec3::Zero(), left = Vec3::Zero();  // [N s]; left: with particles that leave the kill box
  const auto make = [&](int threads) {
    return std::make_unique<ClothScene<Scalar>>(
        setup, threads,
        [&](ClothScene<Scalar>& s) {
          add_block(s.world(), 8, Vec3(0.01, 0.003, -0.018), Vec3::Zero());
          if (!pinned)
            for (auto& v : s.cloths[0]->v) v.y() = 500;
        },
        [&](ClothScene<Scalar>& s, int k) {
          if (k == 0) start = s.momentum();
          left = k == 0 ? Vec3(Vec3::Zero()) : Vec3(left + s.world().report().momentum_removed);
          if (k > 0)
            swept.drift =
                std::max(swept.drift, (s.momentum() + left - start).norm() / (start.norm() + 1e-300));
          for (const Vec3& v : s.world().velocities())
            swept.pool_speed = std::max(swept.pool_speed, v.norm());
          if (!pinned) return;
          for (auto& x : s.cloths[0]->x) {
            const Vec3 at = x.template cast<double>();
            x = (turn == 0 ? Vec3(at + Vec3(0, 0.5, 0)) : Vec3(rotation * at)).template cast<Scalar>();
          }
        });
  };
  swept.found = run_checked(make, 4, 1e-3);
  return swept;
}

TEST(HardMotion,
     cloth_swept_through_a_pool_at_500_metres_per_second_or_flipped_by_200_degrees_takes_it_along) {
  HardCase c("15", "cloth at 500 m/s, and turned by 200° a step, through a resting pool");
  Found all;
  double drift_double = 0, drift_float = 0, slowest = 1e9;
  for (double turn : {0.0, 200 * M_PI / 180}) {
    for (const Swept& s : {sweep_pool<float>(true, turn), sweep_pool<double>(true, turn)}) {
      all.add(s.found);
      slowest = std::min(slowest, s.pool_speed);
    }
  }
  const Swept f = sweep_pool<float>(false, 0), d = sweep_pool<double>(false, 0);
  drift_float = f.drift;
  drift_double = d.drift;
  all.add(f.found);
  all.add(d.found);
  c.note("paths", all.audit.particles);
  c.no_crossings(all);
  c.above("speed of the pool [m/s]", slowest, 10);
  c.at_most("drift of momentum, free cloth in doubles", drift_double, 1e-10);
  c.at_most("drift of momentum, free cloth in floats", drift_float, 1e-4);
}

template <class Scalar>
Found teleport(bool announced, std::uint64_t* ahead, std::uint64_t* relocated) {
  ClothSetup setup;
  setup.pinned = true;
  setup.world.gravity.setZero();
  setup.world.kill_box = {Vec3::Constant(-20), Vec3::Constant(20)};
  const double displacement = 10;
  const auto make = [&](int threads) {
    return std::make_unique<ClothScene<Scalar>>(
        setup, threads,
        [&](ClothScene<Scalar>& s) {
          add_block(s.world(), 6, Vec3(-0.013, 0.02, -0.013), Vec3::Zero());
          // … and some exactly where it is going to stand.
          std::vector<Vec3> x, v;
          for (double at : {-0.05, 0.0123, 0.06})
            x.push_back(Vec3(at, displacement, 0.01)), v.push_back(Vec3::Zero());
          EXPECT_TRUE(s.world().add_particles(x, v).ok());
        },
        [=](ClothScene<Scalar>& s, int k) {
          if (k == 1) {
            if (announced) s.world().reset_motion(s.ids[0]);
            for (auto& x : s.cloths[0]->x) x.y() += static_cast<Scalar>(displacement);
          }
          if (k == 2 && threads == 1) {
            *relocated += s.world().report().contact.relocated;
            for (const Vec3& x : s.world().positions()) *ahead += x.y() > displacement;
          }
        });
  };
  return run_checked(make, 4, 1e-3);
}

TEST(HardMotion, pins_that_teleport_by_ten_metres_sweep_the_particles_in_between_or_are_a_new_surface) {
  HardCase c("26", "all pins of a sheet move by 10 m in one step, unannounced and as reset_motion()");
  std::uint64_t swept = 0, left = 0, relocated = 0, none = 0;
  Found all;
  all.add(teleport<float>(false, &swept, &none));
  all.add(teleport<double>(false, &swept, &none));
  all.add(teleport<float>(true, &left, &relocated));
  all.add(teleport<double>(true, &left, &relocated));
  c.equal("unannounced, particles taken along", swept, 2 * (216 + 3));
  c.equal("unannounced, particles relocated", none, 0);
  c.equal("announced, particles relocated or removed", relocated, 6);
  c.at_most("announced, particles ahead", static_cast<double>(left), 6);
  c.no_crossings(all);
}

}  // namespace
}  // namespace oilskin::test
