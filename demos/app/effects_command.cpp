#include "effects_command.h"

#include <cstdio>
#include <filesystem>
#include <fstream>

#include "output/effect_table.h"
#include "output/output_error.h"
#include "output/write_file.h"
#include "run/child_run.h"
#include "run/effect_runs.h"
#include "run/signals.h"
#include "scene/fields.h"
#include "scene/scene_library.h"

namespace oilskin::demo {
namespace {

namespace fs = std::filesystem;

RunOptions run_options(const EffectsOptions& options) {
  RunOptions run;
  run.scene = options.scene;
  run.duration = options.duration;
  run.threads = options.threads;
  run.set = options.set;
  return run;
}

/// Refuses a folder that cannot be written to before anything is computed.
void prepare(const std::string& out) {
  std::error_code error;
  fs::create_directories(out, error);
  const std::string probe = out + "/effects.csv.part";
  if (error || !std::ofstream(probe))
    throw SceneError("--out " + out + ": the folder cannot be written to" +
                     (error ? ": " + error.message() : std::string()));
  fs::remove(probe, error);
}

std::string in_quotes(const std::string& text) {
  return "'" + text + "'";
}

std::string command_of(const EffectsOptions& o) {
  char numbers[120];
  std::snprintf(numbers, sizeof numbers, " --duration %g --threads %d --repeat %d", o.duration, o.threads,
                o.repeat);
  std::string command = "oilskin effects " + o.scene + numbers;
  for (const std::string& assignment : o.set) command += " --set " + in_quotes(assignment);
  return command;
}

/// One measurement: its runs, in turn, and its files.
class Measurement {
 public:
  explicit Measurement(const EffectsOptions& options) : options_(options), run_(run_options(options)) {
    costs_ = effect_configurations(run_, named_);
    const std::string scene = load_scene(run_).name;
    out_ = options.out.empty() ? "out/" + scene + "_effects" : options.out;
    title_ = {scene, command_of(options), notes(scene)};
    for (const EffectCost& cost : costs_) check_scene_of(options_with(run_, cost.effects, out_));
    prepare(out_);
  }

  int execute() {
    watch_signals();
    if (!options_.quiet)
      for (const std::string& note : title_.notes) std::printf("%s\n", note.c_str());
    // Each round begins with another configuration, so that none is always the first.
    for (int round = 0; round < options_.repeat; ++round)
      for (std::size_t k = 0; k < costs_.size(); ++k) {
        const int code = run(costs_[(static_cast<std::size_t>(round) + k) % costs_.size()], round);
        if (code != 0) return code;
      }
    return finish();
  }

 private:
  std::vector<std::string> notes(const std::string& scene) const {
    std::vector<std::string> notes = {
        "The acceptance checks of the scene and contact.verify are off, unless --set gives them."};
    if (!named_.empty())
      notes.push_back(scene + " names effects of its own: " + joined(named_) +
                      ". Their settings are the scene's; the run `none` is without them.");
    return notes;
  }

  /// 0, or the exit code of a run that did not run to its end.
  int run(EffectCost& cost, int round) {
    const std::string folder = out_ + "/" + cost.name + "_" + std::to_string(round + 1);
    const RunOptions options = options_with(run_, cost.effects, folder);
    std::optional<RunCost> found;
    if (!options_.again) found = cost_of_earlier_run(options);
    const bool earlier = found.has_value();
    if (!earlier) {
      const int code = run_child(arguments_of(options));
      if (caught_signal() != 0) return static_cast<int>(ExitCode::signalled) + caught_signal();
      if (code != static_cast<int>(ExitCode::done) && code != static_cast<int>(ExitCode::check_failed))
        return stop(cost, round, code);
      found = cost_of_earlier_run(options);
      if (!found) throw OutputError(folder + "/report.json: is not that of the run that has just ended");
    }
    cost.runs.push_back(*found);
    print(cost, round, earlier);
    return 0;
  }

  int stop(const EffectCost& cost, int round, int code) const {
    std::fprintf(stderr,
                 "oilskin: effects: %s, run %d, ended with exit code %d; the same command continues\n",
                 cost.name.c_str(), round + 1, code);
    return code;
  }

  void print(const EffectCost& cost, int round, bool earlier) const {
    if (options_.quiet) return;
    const RunCost& c = cost.runs.back();
    std::printf("%-15s %d of %d: %.2f s, CPU %.2f s, effects %.2f s, %.1f MiB, %llu particles%s\n",
                cost.name.c_str(), round + 1, options_.repeat, c.wall_seconds, c.cpu_seconds,
                c.effects_seconds, c.peak_memory / (1024 * 1024),
                static_cast<unsigned long long>(c.particles), earlier ? " (there already)" : "");
    for (const std::string& check : c.failed) std::printf("  the check %s FAILED\n", check.c_str());
    std::fflush(stdout);
  }

  int finish() const {
    write_file(out_ + "/effects.csv", effects_csv(costs_));
    write_file(out_ + "/effects.md", effects_markdown(title_, costs_));
    write_file(out_ + "/effects.svg", effects_svg(title_, costs_));
    bool good = true;
    for (const EffectCost& cost : costs_) {
      good &= cost.checks_hold();
      const Spread ratio = cost.ratio(&RunCost::wall_seconds, costs_.front());
      if (!options_.quiet)
        std::printf("%-15s wall / none %.2f (%.2f to %.2f)\n", cost.name.c_str(), ratio.median, ratio.min,
                    ratio.max);
    }
    if (!options_.quiet) std::printf("  %s/effects.md\n", out_.c_str());
    return static_cast<int>(good ? ExitCode::done : ExitCode::check_failed);
  }

  const EffectsOptions& options_;
  RunOptions run_;
  std::vector<std::string> named_;
  std::vector<EffectCost> costs_;
  std::string out_;
  EffectsTitle title_;
};

}  // namespace

int effects_command(const EffectsOptions& options) {
  return Measurement(options).execute();
}

}  // namespace oilskin::demo
