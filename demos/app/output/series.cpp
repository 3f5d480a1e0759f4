#include "output/series.h"

#include <algorithm>
#include <cstdio>

#include "output/output_error.h"

namespace oilskin::demo {
namespace {

/// The water's surface is the height that this part of the particles does not reach.
constexpr double below_level = 0.98;

constexpr const char* columns =
    "time,dt,particles,water_kinetic,water_potential,node_kinetic,node_potential,transfer,entered_kinetic,"
    "entered_potential,left_kinetic,left_potential,work_prescribed,work_host,work_outside,energy_made,"
    "energy_risen,energy_scale,rms_speed,max_speed,level,density_error,iterations,substeps";

class Row {
 public:
  explicit Row(std::ostream& out) : out_(out) {}
  void add(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.10g", value);
    out_ << (first_ ? "" : ",") << text;
    first_ = false;
  }
  void add(const Vec3& v) {
    for (int k = 0; k < 3; ++k) add(v[k]);
  }

 private:
  std::ostream& out_;
  bool first_ = true;
};

/// Height of the water's surface against gravity, +y without gravity [m]; 0 without water.
double level(const World& world, std::vector<double>& heights) {
  const Vec3& g = world.settings().gravity;
  const Vec3 up = g.norm() > 0 ? Vec3(-g.normalized()) : Vec3(0, 1, 0);
  heights.clear();
  for (const Vec3& x : world.positions()) heights.push_back(x.dot(up));
  if (heights.empty()) return 0;
  const auto at = heights.begin() + static_cast<std::ptrdiff_t>(below_level * double(heights.size() - 1));
  std::nth_element(heights.begin(), at, heights.end());
  return *at + 0.5 * world.fluid_settings().spacing;
}

}  // namespace

SeriesOutput::SeriesOutput(const Scene& scene, const std::string& directory)
    : scene_(scene), path_(directory + "/series.csv"), loads_(scene.cloth.size() + scene.bodies.size()) {
  std::remove(path_.c_str());  // of an earlier run
  if (scene.series_every == 0) return;
  out_.open(path_, std::ios::trunc);
  write_head();
}

void SeriesOutput::write_head() {
  out_ << columns;
  const auto of_surface = [this](const std::string& name) {
    for (const char* quantity : {"force", "torque"})
      for (const char* axis : {"x", "y", "z"}) out_ << ',' << name << '_' << quantity << '_' << axis;
  };
  for (std::size_t i = 0; i < scene_.cloth.size(); ++i) of_surface("cloth_" + std::to_string(i));
  for (std::size_t i = 0; i < scene_.bodies.size(); ++i) of_surface("body_" + std::to_string(i));
  out_ << '\n';
}

void SeriesOutput::after_step(const Simulation& simulation, const World& world, const StepReport& report) {
  if (scene_.series_every == 0) return;
  since_row_ += report.dt;
  iterations_ += static_cast<std::uint64_t>(report.fluid.iterations);
  substeps_ += static_cast<std::uint64_t>(report.substeps);
  const std::size_t cloths = scene_.cloth.size();
  for (std::size_t k = 0; k < loads_.size(); ++k) {
    const SurfaceMotion* motion = k < cloths ? simulation.cloth(k) : simulation.body(k - cloths);
    if (motion == nullptr) continue;
    const SurfaceLoad load = load_of(*motion);
    loads_[k].impulse += load.impulse;
    loads_[k].angular_impulse += load.angular_impulse;
  }
  if (++steps_ % static_cast<std::uint64_t>(scene_.series_every) != 0) return;
  write_row(world, report);
  for (SurfaceLoad& load : loads_) load = SurfaceLoad();
  since_row_ = 0;
  iterations_ = substeps_ = 0;
}

void SeriesOutput::write_row(const World& world, const StepReport& report) {
  const EnergyReport& e = report.energy;
  Row row(out_);
  for (const double value : {report.time,
                             report.dt,
                             static_cast<double>(report.alive),
                             e.water_kinetic,
                             e.water_potential,
                             e.node_kinetic,
                             e.node_potential,
                             e.transfer,
                             e.entered_kinetic,
                             e.entered_potential,
                             e.left_kinetic,
                             e.left_potential,
                             e.work_prescribed,
                             e.work_host,
                             e.work_outside,
                             e.made,
                             e.risen,
                             e.scale,
                             e.rms_speed,
                             e.max_speed,
                             level(world, heights_),
                             report.fluid.density_error_mean,
                             static_cast<double>(iterations_),
                             static_cast<double>(substeps_)})
    row.add(value);
  for (const SurfaceLoad& load : loads_) {
    row.add(load.impulse / since_row_);
    row.add(load.angular_impulse / since_row_);
  }
  out_ << '\n';
}

void SeriesOutput::finish() {
  if (scene_.series_every > 0 && !out_.flush())
    throw OutputError(path_ + ": cannot be written; is the disk full?");
}

}  // namespace oilskin::demo
