/// Bodies float: as deep as Archimedes says, upright, and carried along.
#include "checks/check.h"

namespace oilskin::demo {
namespace {

/// What is asked of one body.
struct Asked {
  int body = 0;
  int tank = -1;           // in which it floats; −1: its draught is not looked at
  double tolerance = 0.4;  // of the mean draught [spacings]
  double window = 0.4;     // the last seconds of the run
  double upright = 0.9;    // the cosine of its tilt, at least, at all times
  Vec3 along = Vec3(1, 0, 0);
  double travel = 0;  // how far it has come along that direction at the end, at least [m]; 0: anywhere
};

/// The middle of the nodes.
Vec3 middle_of(const SurfaceMotion& motion) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& x : motion.x_t1) sum += x;
  return sum / static_cast<double>(motion.x_t1.size());
}

const BoxShape* box_of(const Scene& scene, int body) {
  return std::get_if<BoxShape>(&scene.bodies[static_cast<std::size_t>(body)].shape);
}

const TankShape* tank_of(const Scene& scene, int body) {
  return std::get_if<TankShape>(&scene.bodies[static_cast<std::size_t>(body)].shape);
}

bool is_body(const Scene& scene, int index) {
  return index >= 0 && static_cast<std::size_t>(index) < scene.bodies.size();
}

/// The height of the surface above the floor of the tank, were all at rest: what floats displaces its mass.
double level_in(const TankShape& tank, const Moment& now) {
  const Vec3 size = tank.inside.max - tank.inside.min;
  double volume = water_volume(now.scene, now.simulation);
  for (const Body& body : now.scene.bodies)
    if (const auto* box = std::get_if<BoxShape>(&body.shape); box && body.is_dynamic())
      volume += body.mass_with(box->volume()) / now.scene.fluid.rest_density;
  return volume / (size.x() * size.z());
}

/// Of one body in the course of a run.
struct Seen {
  std::optional<Vec3> start, end;  // its middle [m]
  Eigen::Matrix3d first = Eigen::Matrix3d::Zero();
  double least_cosine = 1;
  TimeMean draught;
};

class Floats : public Check {
 public:
  void describe(Fields& f) override {
    f.list("floats", asked_, [](Fields& g, Asked& a) {
      g.integer("body", a.body, between(0, 1e6));
      g.integer("tank", a.tank, between(-1, 1e6));
      g.number("tolerance", a.tolerance, positive());
      g.number("window", a.window, positive());
      g.number("upright", a.upright, between(-1, 1));
      g.direction("along", a.along);
      g.number("travel", a.travel, not_negative());
    });
    seen_.resize(asked_.size());
  }

  void check_scene(const Scene& scene) const override {
    for (std::size_t k = 0; k < asked_.size(); ++k) check_asked(scene, asked_[k], std::to_string(k));
  }

  void after_step(const Moment& now) override {
    for (std::size_t k = 0; k < asked_.size(); ++k)
      if (const SurfaceMotion* motion = now.simulation.body(static_cast<std::size_t>(asked_[k].body)))
        look(asked_[k], *motion, now, seen_[k]);
  }

  std::vector<CheckResult> results(const RunEnd& end) override {
    std::vector<CheckResult> all;
    for (std::size_t k = 0; k < asked_.size(); ++k) {
      const Asked& asked = asked_[k];
      const Seen& seen = seen_[k];
      const std::string name = "floats." + std::to_string(k);
      all.push_back(at_least(name + ".upright", seen.end ? seen.least_cosine : -1, asked.upright));
      if (asked.tank >= 0)
        all.push_back(at_most(name + ".draught",
                              seen.draught.empty() ? never : error_of(asked, seen, end.scene),
                              asked.tolerance));
      if (asked.travel > 0)
        all.push_back(at_least(name + ".travel",
                               seen.end ? (*seen.end - *seen.start).dot(asked.along.normalized()) : 0,
                               asked.travel));
    }
    return all;
  }

 private:
  static void check_asked(const Scene& scene, const Asked& a, const std::string& number) {
    const std::string key = "acceptance.floats." + number;
    if (!is_body(scene, a.body) || !scene.bodies[static_cast<std::size_t>(a.body)].is_dynamic())
      throw SceneError(key + ".body: is " + std::to_string(a.body) +
                       ", must be the index of a body with a mass or density");
    if (a.tank < 0) return;
    check_has_weight(scene);
    if (!is_body(scene, a.tank) || !tank_of(scene, a.tank) || !(up_of(scene) - Vec3::UnitY()).isZero(1e-9))
      throw SceneError(key + ".tank: is " + std::to_string(a.tank) +
                       ", must be the index of a tank, in a scene whose gravity is along -y");
    if (!box_of(scene, a.body)) throw SceneError(key + ".body: must be a box, of which the draught is known");
  }

  static void look(const Asked& asked, const SurfaceMotion& motion, const Moment& now, Seen& seen) {
    const Vec3 middle = middle_of(motion);
    // The axes by three nodes: a rigid body keeps their differences' angles.
    const Vec3 a = motion.x_t1[1] - motion.x_t1[0], b = motion.x_t1[2] - motion.x_t1[0];
    Eigen::Matrix3d axes;
    axes << a.normalized(), a.cross(b).normalized(), a.cross(a.cross(b)).normalized();
    if (!seen.start) {
      seen.start = middle;
      seen.first = axes;
    }
    seen.end = middle;
    const Vec3 up = up_of(now.scene);
    seen.least_cosine = std::min(seen.least_cosine, (axes * seen.first.transpose() * up).dot(up));
    if (asked.tank < 0 || !in_last(asked.window, now)) return;
    const TankShape& tank = *tank_of(now.scene, asked.tank);
    const double bottom = middle.y() - box_of(now.scene, asked.body)->half_extents.y() - tank.inside.min.y();
    seen.draught.add(level_in(tank, now) - bottom, now.dt);
  }

  /// [spacings]
  static double error_of(const Asked& asked, const Seen& seen, const Scene& scene) {
    const BoxShape& box = *box_of(scene, asked.body);
    const double mass = scene.bodies[static_cast<std::size_t>(asked.body)].mass_with(box.volume());
    const double density = mass / box.volume();
    const double theory = density / scene.fluid.rest_density * 2 * box.half_extents.y();
    return std::abs(seen.draught.value() - theory) / scene.fluid.spacing;
  }

  std::vector<Asked> asked_;
  std::vector<Seen> seen_;
};

}  // namespace

std::unique_ptr<Check> make_floats() {
  return std::make_unique<Floats>();
}

}  // namespace oilskin::demo
