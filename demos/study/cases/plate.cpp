/// The force of a round jet on a flat plate, without gravity (F.53): all momentum across the plate is taken,
/// none along it.
#include <cmath>

#include "study/cases/case_table.h"
#include "study/cases/parts.h"

namespace oilskin::demo {
namespace {

constexpr double radius = 0.0125, speed = 2.5;  // of the jet [m], [m/s]
constexpr double half = 0.1;                    // of the plate: four jet diameters [m]
constexpr double above = 0.04;                  // of the nozzle, at first [m]
constexpr double window = 0.3;                  // in which the force is measured [s]

struct Plate {
  double angle = 90;  // between jet and plate [degrees]
  double away = 0;    // speed of the plate along the jet [m/s]

  double sine() const { return std::sin(angle * M_PI / 180); }
  Vec3 along() const { return {sine(), -std::cos(angle * M_PI / 180), 0}; }
  Vec3 normal() const { return {std::cos(angle * M_PI / 180), sine(), 0}; }
  /// The slowest way: down to the plate, three diameters of jet, out to the border.
  double begin() const { return (above + 6 * radius + 1.5 * half) / (speed - away); }
};

class Force : public Probe {
 public:
  explicit Force(const Plate& plate) : plate_(plate) {}

  void after_step(const Moment& now) override {
    if (now.t < plate_.begin()) return;
    const StepReport& r = now.simulation.world().report();
    time_ += now.dt;
    impulse_ += r.contact.impulse_on_prescribed;
    mass_ += r.mass_emitted;
    mass_removed_ += r.mass_removed;
    removed_ += r.momentum_removed;
  }

  std::vector<Quantity> quantities(const Moment&) override {
    const double relative = 1 - plate_.away / speed, hits = mass_ / time_ * relative;
    const double expected = hits * speed * relative * plate_.sine();
    const Vec3 normal = plate_.normal(), force = impulse_ / time_;
    const Vec3 left = removed_ - mass_removed_ * plate_.away * Vec3(0, -1, 0);
    return {{"normal force / (mass flow × speed)", -force.dot(normal) / expected, 1, 0, 0, 0.03, 1},
            {"tangential / normal force", (force - force.dot(normal) * normal).norm() / force.norm(), 0, 1, 0,
             0.01},
            {"momentum of the rebound / arriving", left.dot(normal) / time_ / expected, 0, 1, 0, 0.03, 1},
            {"flow emitted / (ρ π r² v)", mass_ / time_ / (water_density * M_PI * radius * radius * speed), 1,
             0, 0, 0.005}};
  }

 private:
  Plate plate_;
  Vec3 impulse_ = Vec3::Zero(), removed_ = Vec3::Zero();
  double time_ = 0, mass_ = 0, mass_removed_ = 0;
};

Scene scene_at(double spacing, const Plate& plate) {
  Scene scene = empty_scene(spacing, plate.begin() + window);
  scene.dt = 0.1 * spacing;
  scene.world.gravity = Vec3::Zero();
  const Vec3 along = plate.along();
  // The box ends with the plate: water is taken away while the plate still carries it.
  const double deep = half * std::abs(along.y()) + plate.away * (scene.duration + scene.dt);
  scene.world.kill_box = {Vec3(-half * along.x(), -deep - 0.02, -half),
                          Vec3(half * along.x(), half * std::abs(along.y()) + above + 0.02, half)};
  Body body =
      mesh_body(sheet_mesh(-half * along - Vec3(0, 0, half), Vec3(0, 0, 2 * half), 2 * half * along, 15, 15));
  body.motion.velocity = plate.away * Vec3(0, -1, 0);
  scene.bodies = {body};
  DiscEmitter nozzle;
  nozzle.center = Vec3(0, above, 0);
  nozzle.radius = radius;
  nozzle.speed = speed;
  scene.emitters = {nozzle};
  return scene;
}

ValidationCase case_of(const std::string& name, const std::string& title, const Plate& plate) {
  return {name,
          title,
          "momentum balance (F.53)",
          {0.005, 0.0035, 0.0025},
          [plate](double spacing) { return scene_at(spacing, plate); },
          [plate](const Scene&) { return std::make_unique<Force>(plate); }};
}

}  // namespace

ValidationCase plate_case(int angle) {
  Plate plate;
  plate.angle = angle;
  const std::string text = std::to_string(angle);
  return case_of("plate_" + text, "a round jet strikes a plate at " + text + "°", plate);
}

ValidationCase moving_plate_case() {
  Plate plate;
  plate.away = speed / 2;
  return case_of("plate_moving", "a round jet strikes a plate that moves away at half its speed", plate);
}

}  // namespace oilskin::demo
