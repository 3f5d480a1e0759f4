/// Sheets that absorb, for hard cases of effects.
#pragma once

#include <algorithm>

#include "hard_cases/cloth_scene.h"
#include "hard_cases/water.h"
#include "oilskin/implicit_viscosity.h"
#include "oilskin/surface_tension.h"
#include "oilskin/wetting.h"

namespace oilskin::test {

/// Settings of the effects of a scene; those that are absent do not act.
struct EffectSetup {
  std::optional<WettingSettings> wetting;
  std::optional<SurfaceTensionSettings> tension;
  std::optional<ImplicitViscositySettings> viscosity;
};

/// What wetting and its extremes were in a run, of one thread and of two.
struct WetFound {
  double most_liquid = 0;  ///< [kg]
  double saturation = 0;   ///< largest S of a node
  double least_ratio = 1;  ///< smallest relative mass of a particle
  double lost = 0, risen = 0;
  std::uint64_t absorbed = 0, released = 0, removed = 0, emitted = 0;
  std::uint32_t flags = 0;
  int substeps = 1;
  std::uint64_t messages = 0;  ///< steps with one
  double speed = 0;            ///< largest of a particle [m/s]
};

/// Lets the first surface hold S times its capacity: in its first interval it takes the reserve, particles
/// above y.
class Soak : public Effect {
 public:
  double saturation = 0;
  const Wetting* wetting = nullptr;  ///< must be added before
  static constexpr double reserve_height = 0.3;

  std::string name() const override { return "soak"; }
  bool changes_masses() const override { return true; }
  void exchange(EffectExchange& e) override {
    if (done_) return;
    done_ = true;
    const Span<const double> capacity = wetting->capacity(e.surface_id[0]);
    std::size_t i = 0;
    for (std::uint32_t node = 0; node < capacity.size(); ++node) {
      const std::vector<double>& held = e.surfaces[0]->absorbed_mass;
      double missing = saturation * capacity[node] - (held.empty() ? 0 : held[node]);
      for (; missing > 1e-9 * capacity[node] && i < e.id.size(); ++i) {
        if (e.position[i].y() < reserve_height) continue;
        missing -= e.absorb(i, 0, {node, node, node}, {missing, 0, 0});
        if (e.mass(i) > 0) break;
      }
    }
  }

 private:
  bool done_ = false;
};

/// ClothScene<double> with effects and gravity on the cloth.
class WetScene : public ClothScene<double> {
 public:
  using Fill = std::function<void(WetScene&)>;
  using WetHook = std::function<void(WetScene&, int)>;

  WetScene(const ClothSetup& setup, const EffectSetup& effects, int threads, WetFound& found, Fill fill = {},
           WetHook before = {})
      : ClothScene<double>(setup, threads),
        area_(setup.shape.u.cross(setup.shape.v).norm()),
        found_(found),
        before_(std::move(before)) {
    if (effects.wetting) wetting = std::make_unique<Wetting>(*effects.wetting);
    if (effects.tension) tension = std::make_unique<SurfaceTension>(*effects.tension);
    if (effects.viscosity) viscosity = std::make_unique<ImplicitViscosity>(*effects.viscosity);
    for (Effect* e : all()) EXPECT_TRUE(world().add_effect(*e).ok());
    if (fill) fill(*this);
  }
  std::vector<Effect*> all() const {
    std::vector<Effect*> list;
    for (Effect* e : {static_cast<Effect*>(tension.get()), static_cast<Effect*>(wetting.get()),
                      static_cast<Effect*>(viscosity.get())})
      if (e != nullptr) list.push_back(e);
    return list;
  }
  void before_step(int k) override {
    if (before_) before_(*this, k);
  }
  void after_step(int) override {
    World& w = world();
    const StepReport& r = w.report();
    found_.absorbed += r.absorbed;
    found_.released += r.released;
    found_.removed += r.removed;
    found_.emitted += r.emitted;
    found_.lost += r.mass_lost;
    found_.flags |= r.flags;
    found_.substeps = std::max(found_.substeps, r.substeps);
    found_.messages += r.messages.empty() ? 0 : 1;
    found_.speed = std::max(found_.speed, fastest(w));
    if (r.energy.scale > 0) found_.risen = std::max(found_.risen, r.energy.risen / r.energy.scale);
    found_.most_liquid = std::max(found_.most_liquid, w.absorbed_mass());
    for (float ratio : w.mass_ratios())
      found_.least_ratio = std::min(found_.least_ratio, static_cast<double>(ratio));
    if (wetting) measure_saturation();
  }

  /// The first sheet holds S of its capacity after the first step. What it does not need falls beside it.
  void soak(double saturation) {
    const double mass = saturation * wetting->settings().fabric.capacity * area_;
    const int n = static_cast<int>(std::ceil(std::sqrt(mass / world().particle_mass() + 1)));
    const double side = -0.5 * (n - 1) * water::dx;
    water::fill(world(), water::lattice(n, 1, n, Vec3(0.25, Soak::reserve_height + 0.05, side)));
    soak_.saturation = saturation;
    soak_.wetting = wetting.get();
    EXPECT_TRUE(world().add_effect(soak_).ok());
  }

  std::unique_ptr<Wetting> wetting;
  std::unique_ptr<SurfaceTension> tension;
  std::unique_ptr<ImplicitViscosity> viscosity;

 private:
  void measure_saturation() {
    for (SurfaceId id : ids) {
      const Span<const double> liquid = world().absorbed(id), room = wetting->capacity(id);
      for (std::size_t i = 0; i < std::min(liquid.size(), room.size()); ++i)
        if (room[i] > 0) found_.saturation = std::max(found_.saturation, liquid[i] / room[i]);
    }
  }

  Soak soak_;
  const double area_;  // of a sheet [m²]
  WetFound& found_;
  WetHook before_;
};

/// A sheet of 0.2 m and 17 × 17 nodes in a world of half a metre, with gravity.
inline ClothSetup wet_setup(PressureSolver solver = PressureSolver::pcisph, bool mirrored = true) {
  ClothSetup setup;
  setup.world = water::world_of(0.5);
  setup.fluid = water::solver_of(solver, mirrored);
  setup.shape.nu = setup.shape.nv = 17;
  setup.cloth_gravity = Vec3(0, -water::g, 0);
  return setup;
}

inline void pin_border(MockCloth<double>& cloth, std::uint32_t n) {
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = 0; j < n; ++j)
      if (i == 0 || j == 0 || i + 1 == n || j + 1 == n) cloth.pin(i + n * j);
}

/// `n` × `layers` × `n` particles, the lowest half a spacing above y.
inline void add_water(World& w, int n, int layers, double y, const Vec3& velocity) {
  using water::dx;
  const double side = -0.5 * (n - 1) * dx;
  water::fill(w, water::lattice(n, layers, n, Vec3(side, y + 0.5 * dx, side)), velocity);
}

/// run_checked() of a WetScene.
inline Found run_wet(const ClothSetup& setup, const EffectSetup& effects, int steps, double dt,
                     WetFound& found, const WetScene::Fill& fill, const WetScene::WetHook& before = {}) {
  return run_checked(
      [&](int threads) { return std::make_unique<WetScene>(setup, effects, threads, found, fill, before); },
      steps, dt);
}

}  // namespace oilskin::test
