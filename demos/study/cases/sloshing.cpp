/// The first standing wave in a tank.
#include <cmath>

#include "study/cases/case_table.h"
#include "study/cases/parts.h"
#include "study/cases/shapes.h"

namespace oilskin::demo {
namespace {

constexpr double length = 0.12, depth = 0.06, breadth = 0.02;  // [m]
// At the walls [m]: k a = 0.21. Without corrected gradients water that is strained less than about 0.2 swings
// faster, on all spacings: its particles keep their neighbours, and their arrangement resists shear.
constexpr double amplitude = 0.008;
constexpr double pi = 3.14159265358979323846;
constexpr double wavenumber = pi / length;  // [1/m]

/// A swing through zero, and the largest values between two of them.
struct Swing {
  std::vector<double> zeros;  // [s]
  std::vector<double> peaks;  // one more than zeros
};

Swing swing_of(const std::vector<Point2>& series) {
  Swing swing;
  double peak = 0;
  for (std::size_t i = 0; i < series.size(); ++i) {
    const double now = series[i][1], before = i > 0 ? series[i - 1][1] : now;
    if (now * before < 0) {
      const double part = before / (before - now);
      swing.zeros.push_back(series[i - 1][0] + part * (series[i][0] - series[i - 1][0]));
      swing.peaks.push_back(peak);
      peak = 0;
    }
    peak = std::max(peak, std::abs(now));
  }
  return swing;
}

/// The amplitude of the first mode is (2 h/N) Σ cos k x over the particles: it is zero for still water, and
/// other modes do not enter.
class Wave : public Probe {
 public:
  void after_step(const Moment& now) override {
    double sum = 0;
    for (const Vec3& x : now.simulation.world().positions()) sum += std::cos(wavenumber * x.x());
    const auto count = static_cast<double>(now.simulation.world().particle_count());
    series_.push_back({now.t, 2 * depth * sum / count});
  }

  std::vector<Quantity> quantities(const Moment& end) override {
    const Swing swing = swing_of(series_);
    const std::size_t n = swing.zeros.size();
    double damping = never, squared = never;
    if (n >= 3) {
      const double half = (swing.zeros[n - 1] - swing.zeros[0]) / static_cast<double>(n - 1);
      // The peaks that lie between the first and the last zero.
      damping = std::log(swing.peaks[1] / swing.peaks[n - 1]) / (half * static_cast<double>(n - 2));
      squared = std::pow(pi / half, 2) + damping * damping;
    }
    const double exact = earth * wavenumber * std::tanh(wavenumber * depth);
    const double viscous = 2 * end.scene.fluid.viscosity * wavenumber * wavenumber;
    // At k h = π/2 a standing wave of finite amplitude a has ω² lower by 0.194 (k a)² [Tadjbakhsh, Keller
    // 1960], which is 0.9 % here.
    return {{"ω² [1/s²]", squared, exact, 0, 0.009, 0.02},
            {"damping of the amplitude [1/s]", damping, viscous, 0, 0, never}};
  }

 private:
  std::vector<Point2> series_;  // time [s], amplitude [m]
};

Scene scene_at(double spacing) {
  Scene scene = empty_scene(spacing, 0.8);
  FilledBox water = water_box(Vec3::Zero(), Vec3(length, depth, breadth));
  FieldTerm shape;
  shape.kind = FieldKind::standing_wave;
  shape.wave.wavelength = 2 * length;
  shape.wave.depth = depth;
  shape.amplitude = amplitude;
  water.initial.displacement = {shape};
  scene.emitters = {water};
  scene.bodies = {tank_body(Vec3::Zero(), Vec3(length, 2 * depth, breadth))};
  return scene;
}

}  // namespace

ValidationCase sloshing_case() {
  return {"sloshing",
          "standing wave of 8 mm in a tank of 120 mm with 60 mm of water",
          "linear waves of an inviscid fluid, ω² = g k tanh k h; damping: 2 ν k²",
          {0.01, 0.005, 0.0025},
          scene_at,
          [](const Scene&) { return std::make_unique<Wave>(); }};
}

}  // namespace oilskin::demo
