/// Viscous flow between two plates from rest: plane Poiseuille and Couette flow.
///
/// There are no periodic directions: a slug fills a piece of the channel, with open ends and sides without
/// friction. It moves by a tenth of a spacing before the flow is steady. Only its middle is looked at. The
/// walls brake its ends less, and pressure carries what they gain to the middle: 10 % of the walls' stress in
/// a slug of 2 widths, 4 % of 4 widths, 1 % of 8 widths, as here. Its depth of 1.6 widths does below 2 %.
#include <cmath>

#include "study/cases/case_table.h"
#include "study/cases/parts.h"

namespace oilskin::demo {
namespace {

constexpr double width = 0.05, depth = 0.08, length = 0.4;  // [m]
constexpr double viscosity = 0.01;                          // [m²/s]
constexpr double reynolds = 0.01;                           // of the largest speed and the width

struct Flow {
  bool driven = true;  // Poiseuille; else the upper plate moves

  double largest() const { return reynolds * viscosity / width; }                            // [m/s]
  double force() const { return driven ? 8 * viscosity * largest() / (width * width) : 0; }  // [m/s²]
  double belt() const { return driven ? 0 : largest(); }                                     // [m/s]

  /// The series of [Morris1997], (F.51), (F.52), at y and νt/D².
  double exact(double y, double t) const {
    const double eta = y / width;
    double u = driven ? 4 * largest() * eta * (1 - eta) : largest() * eta;
    for (int n = 1; n < 400; ++n) {
      const double k = n * M_PI, decay = std::exp(-k * k * t);
      if (driven && n % 2 == 1) u -= 32 * largest() / (k * k * k) * std::sin(k * eta) * decay;
      if (!driven) u += 2 * largest() / k * (n % 2 ? -1 : 1) * std::sin(k * eta) * decay;
    }
    return u;
  }
};

class Profile : public Probe {
 public:
  explicit Profile(const Flow& flow) : flow_(flow) {}

  void after_step(const Moment& now) override {
    const double t = viscosity * now.t / (width * width);
    if (!early_ && t >= 0.2) early_ = deviation(now.simulation.world(), t);
    if (now.t < 0.9 * now.scene.duration) return;
    for (const std::size_t sheet : {1, 2})
      stress_.add(std::abs(middle_impulse(*now.simulation.body(sheet), now.scene)) / now.dt, now.dt);
  }

  std::vector<Quantity> quantities(const Moment& end) override {
    const World& world = end.simulation.world();
    const double t = viscosity * end.t / (width * width), y = 0.5 * width, spacing = end.scene.fluid.spacing;
    const double exact_stress = flow_.driven ? water_density * flow_.force() * width / 2
                                             : water_density * viscosity * flow_.belt() / width;
    return {{"largest deviation / largest speed", deviation(world, t), 0, 1, 0.01, 0.05 * share(0.0025), 1},
            {"the same at νt/D² = 0.2", early_.value_or(never), 0, 1, 0.01, 0.05 * share(0.0025), 1},
            {"speed in the middle / exact", speed_at(world, y, spacing) / flow_.exact(y, t), 1, 0, 0.01,
             0.05 * share(0.0025), 1},
            {"shear stress of the walls / exact", stress_.value() / exact_stress, 1, 0, 0.01, 0.05}};
  }

 private:
  /// The 5 % hold at ten particles across, which is not the finest grid.
  static double share(double finest) { return finest / (width / 10); }

  template <class F>
  static void for_middle(const World& world, const F& f) {
    const double spacing = world.fluid_settings().spacing;
    for (std::size_t i = 0; i < world.particle_count(); ++i) {
      const Vec3& x = world.positions()[i];
      if (std::abs(x.x()) < 0.5 * width && std::abs(x.z() - 0.5 * depth) < 2 * spacing) f(i);
    }
  }

  double deviation(const World& world, double t) const {
    double largest = 0;
    for_middle(world, [&](std::size_t i) {
      const double exact = flow_.exact(world.positions()[i].y(), t);
      largest = std::max(largest, std::abs(world.velocities()[i].x() - exact));
    });
    return largest / flow_.largest();
  }

  static double speed_at(const World& world, double y, double spacing) {
    double sum = 0, weights = 0;
    for_middle(world, [&](std::size_t i) {
      const double w = std::max(0.0, 1 - std::abs(world.positions()[i].y() - y) / spacing);
      sum += w * world.velocities()[i].x();
      weights += w;
    });
    return sum / weights;
  }

  /// On the part of a plate in the middle, over its area [N s/m²]; the nodes are one spacing apart.
  static double middle_impulse(const SurfaceMotion& plate, const Scene& scene) {
    const double spacing = scene.fluid.spacing, deep = 2 * spacing;
    const auto inside = [&](double off, double to) {
      return std::clamp(0.5 - (std::abs(off) - to) / spacing, 0.0, 1.0);
    };
    double sum = 0;
    for (std::size_t i = 0; i < plate.impulse.size(); ++i)
      sum += inside(plate.x_t1[i].x(), 0.5 * width) * inside(plate.x_t1[i].z() - 0.5 * depth, deep) *
             plate.impulse[i].x();
    return sum / (width * 2 * deep);
  }

  Flow flow_;
  std::optional<double> early_;
  TimeMean stress_;  // [Pa]
};

Scene scene_at(double spacing, const Flow& flow) {
  Scene scene = empty_scene(spacing, 0.8 * width * width / viscosity);
  scene.dt = 0.125 * spacing * spacing / viscosity;
  scene.fluid.viscosity = viscosity;
  scene.fluid.xsph_rate = 0;
  scene.world.gravity = Vec3(flow.force(), 0, 0);
  const double around = 0.3 * width;
  const Vec3 low(-0.5 * length - around, 0, -around), along(length + 2 * around, 0, 0), up(0, width, 0),
      side(0, 0, depth + 2 * around);
  const auto cells = [&](const Vec3& edge) { return static_cast<int>(std::lround(edge.norm() / spacing)); };
  Mesh sides;
  for (const double z : {0.0, depth})
    append(sides, sheet_mesh({low.x(), -around, z}, along, up + 2 * around * Vec3::UnitY(), 40, 4));
  Body bottom = mesh_body(sheet_mesh(low, along, side, cells(along), cells(side)));
  bottom.surface.slip.model = SlipModel::viscous_wall;
  Body top = mesh_body(sheet_mesh(low + up, along, side, cells(along), cells(side)));
  top.surface.slip.model = SlipModel::viscous_wall;
  top.motion.velocity = Vec3(flow.belt(), 0, 0);
  scene.bodies = {mesh_body(sides), bottom, top};
  // The first layer is half a spacing off: within reach of the wall's law.
  for (Body& body : scene.bodies) body.surface.thickness = 0.45 * spacing;
  scene.emitters = {water_box({-0.5 * length, 0, 0}, {0.5 * length, width, depth})};
  return scene;
}

ValidationCase case_of(const std::string& name, const std::string& title, const Flow& flow) {
  return {name,
          title,
          "[Morris1997], series",
          {0.01, 0.005, 0.0025},
          [flow](double spacing) { return scene_at(spacing, flow); },
          [flow](const Scene&) { return std::make_unique<Profile>(flow); }};
}

}  // namespace

ValidationCase poiseuille_case() {
  return case_of("poiseuille", "a viscous liquid is driven between two plates, 5, 10 and 20 particles across",
                 {true});
}

ValidationCase couette_case() {
  return case_of("couette", "a plate slides over a viscous liquid, 5, 10 and 20 particles deep", {false});
}

}  // namespace oilskin::demo
