// A game's rate: the scene `jet` with game_preset() in frames of 1/60 s and one sub-step of Bullet's cloth in
// a step. The nozzle fills the scene until it has the asked number of particles, and goes on while water runs
// off the cloth. Prints, for each second, the particles, the frame times and the errors, and the frame times
// of the whole run as a histogram. A frame is what a game waits for: Bullet's cloth, the fluid and their
// contact.
//
// use: game_benchmark [particles = 10000] [seconds = 10] [steps a frame = 2] [threads = 0, all] [spacing [m]]
//      [budget of the water [ms a frame] = 0, none] [KEY=VALUE …]
// KEY is one of `oilskin run --set`.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "hosts/bullet_simulation.h"
#include "oilskin/presets.h"
#include "scene/scene_library.h"

using namespace oilskin;
using namespace oilskin::demo;

namespace {

constexpr int frames_per_second = 60;
constexpr double frame_limit = 1e3 / frames_per_second;  // [ms]

struct Options {
  int particles = 10000, seconds = 10, steps = 2, threads = 0;
  double spacing = 0.005, budget = 0;
  std::vector<std::string> set;
};

Scene scene_of(const Options& o) {
  const Preset preset = game_preset(o.spacing, o.steps);
  const auto setting = [](const char* key, double value) {
    char text[64];
    std::snprintf(text, sizeof text, "%s=%.17g", key, value);
    return std::string(text);
  };
  RunOptions options;
  options.scene = "jet";
  options.set = {"preset=game",
                 "contact.verify=false",
                 "cloth.0.substeps=1",
                 setting("fluid.spacing", o.spacing),
                 setting("dt", preset.dt),
                 setting("fluid.max_substeps", preset.fluid.max_substeps)};
  options.set.insert(options.set.end(), o.set.begin(), o.set.end());
  Scene scene = load_scene(options);
  scene.duration = o.seconds;
  scene.world.step_budget = 1e-3 * o.budget / o.steps;
  scene.world.max_particles = static_cast<std::uint64_t>(o.particles);
  return scene;
}

/// Of frames: their times [ms], and means of what their steps report.
class Frames {
 public:
  void add(double ms, std::size_t particles, double density_error) {
    ms_.push_back(ms);
    particles_ += static_cast<double>(particles);
    error_ += density_error;
  }
  void add(const Frames& o) {
    ms_.insert(ms_.end(), o.ms_.begin(), o.ms_.end());
    particles_ += o.particles_;
    error_ += o.error_;
  }
  double mean() const {
    double sum = 0;
    for (double ms : ms_) sum += ms;
    return sum / static_cast<double>(ms_.size());
  }
  /// The time that `share` of the frames do not exceed.
  double percentile(double share) const {
    std::vector<double> sorted = ms_;
    std::sort(sorted.begin(), sorted.end());
    const double place = std::ceil(share * static_cast<double>(sorted.size()));
    return sorted[static_cast<std::size_t>(std::max(1.0, place)) - 1];
  }
  double particles() const { return particles_ / static_cast<double>(ms_.size()); }
  double density_error() const { return error_ / static_cast<double>(ms_.size()); }
  const std::vector<double>& ms() const { return ms_; }

 private:
  std::vector<double> ms_;
  double particles_ = 0, error_ = 0;
};

double mean_density_error(const World& world, double rest_density) {
  double sum = 0;
  for (double density : world.densities()) sum += std::max(0.0, density / rest_density - 1);
  return world.particle_count() > 0 ? sum / static_cast<double>(world.particle_count()) : 0;
}

class Game {
 public:
  explicit Game(const Options& options)
      : options_(options),
        scene_(scene_of(options)),
        simulation_(make_simulation(scene_, simulation_options())) {}

  void play_frame(Frames& frames) {
    const auto begin = std::chrono::steady_clock::now();
    for (int k = 0; k < options_.steps; ++k) step();
    const std::chrono::duration<double, std::milli> elapsed = std::chrono::steady_clock::now() - begin;
    const World& world = simulation_->world();
    frames.add(elapsed.count(), world.particle_count(), mean_density_error(world, scene_.fluid.rest_density));
  }

  void print_stages(int frames) const {
    const StageSeconds& s = seconds_;
    const double ms = 1e3 / frames;
    std::printf(
        "ms a frame: Bullet's cloth %.2f, neighbours %.2f, hidden neighbours %.2f, boundary %.2f, pressure "
        "%.2f, "
        "other fluid %.2f, proximity %.2f, impulses %.2f, continuous test %.2f, rest of contact %.2f\n",
        ms * simulation_->host_seconds(), ms * s.neighbours, ms * s.occlusion, ms * s.boundary,
        ms * s.pressure, ms * s.other_fluid, ms * s.proximity, ms * s.impulses, ms * s.ccd,
        ms * (s.gather + s.zones));
    if (options_.budget > 0)
      std::printf("%.1f %% of the steps were limited; %.2f fluid sub-steps a frame were left out\n",
                  100.0 * static_cast<double>(limited_) / (frames * options_.steps),
                  static_cast<double>(left_out_) / frames);
    std::printf("%.2f fluid sub-steps and %.1f pressure iterations a frame; energy made at most %.2f %%\n",
                static_cast<double>(substeps_) / frames, iterations_ / frames, 100 * energy_made_);
  }

 private:
  SimulationOptions simulation_options() const {
    SimulationOptions options;
    options.threads = options_.threads;
    return options;
  }

  void step() {
    const StepReport& r = simulation_->step(scene_.dt);
    if (!r.status.ok()) throw std::runtime_error(r.status.message);
    seconds_ += r.seconds;
    substeps_ += static_cast<std::uint64_t>(r.substeps);
    iterations_ += r.fluid.iterations;
    left_out_ += static_cast<std::uint64_t>(r.substeps_left_out);
    limited_ += (r.flags & flag_budget_limited) != 0;
    if (r.energy.scale > 0) energy_made_ = std::max(energy_made_, r.energy.risen / r.energy.scale);
  }

  const Options options_;
  const Scene scene_;
  std::unique_ptr<Simulation> simulation_;
  StageSeconds seconds_;
  std::uint64_t substeps_ = 0, left_out_ = 0, limited_ = 0;
  double iterations_ = 0;
  double energy_made_ = 0;
};

void print_histogram(const std::vector<double>& all) {
  constexpr std::array<double, 8> ends = {2, 4, 8, 12, frame_limit, 25, 33.3, 50};
  double begin = 0;
  for (std::size_t k = 0; k <= ends.size(); ++k) {
    const double end = k < ends.size() ? ends[k] : std::numeric_limits<double>::infinity();
    const auto count =
        std::count_if(all.begin(), all.end(), [&](double ms) { return ms > begin && ms <= end; });
    const double share = static_cast<double>(count) / static_cast<double>(all.size());
    std::printf("%5.1f to %5.1f ms %5.1f %%  %s\n", begin, end, 100 * share,
                std::string(static_cast<std::size_t>(std::lround(60 * share)), '#').c_str());
    begin = end;
  }
}

void play(const Options& options) {
  Game game(options);
  std::printf("second  particles  mean ms   95 %%   99 %%  longest  mean density error %%\n");
  Frames all;
  for (int second = 0; second < options.seconds; ++second) {
    Frames frames;
    for (int k = 0; k < frames_per_second; ++k) game.play_frame(frames);
    std::printf("%6d %10.0f %8.2f %6.2f %6.2f %8.2f %8.2f\n", second + 1, frames.particles(), frames.mean(),
                frames.percentile(0.95), frames.percentile(0.99), frames.percentile(1),
                100 * frames.density_error());
    all.add(frames);
  }
  std::printf("%6s %10.0f %8.2f %6.2f %6.2f %8.2f %8.2f\n", "all", all.particles(), all.mean(),
              all.percentile(0.95), all.percentile(0.99), all.percentile(1), 100 * all.density_error());
  print_histogram(all.ms());
  game.print_stages(options.seconds * frames_per_second);
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  for (; argc > 1 && std::strchr(argv[argc - 1], '='); --argc)
    options.set.insert(options.set.begin(), argv[argc - 1]);
  if (argc > 1) options.particles = std::atoi(argv[1]);
  if (argc > 2) options.seconds = std::atoi(argv[2]);
  if (argc > 3) options.steps = std::atoi(argv[3]);
  if (argc > 4) options.threads = std::atoi(argv[4]);
  if (argc > 5) options.spacing = std::atof(argv[5]);
  if (argc > 6) options.budget = std::atof(argv[6]);
  if (options.particles < 1 || options.seconds < 1 || options.steps < 1 || options.steps > 4 ||
      !(options.spacing > 0) || !(options.budget >= 0)) {
    std::fprintf(stderr,
                 "use: game_benchmark [particles] [seconds] [steps a frame, 1 … 4] [threads] [spacing, m] "
                 "[budget, ms a frame] [KEY=VALUE ...]\n");
    return 2;
  }
  try {
    play(options);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 2;
  }
  return 0;
}
