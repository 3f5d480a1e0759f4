#include "study/validate_command.h"

#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>

#include "output/write_file.h"
#include "run/signals.h"
#include "scene/options.h"
#include "study/run/case_files.h"
#include "study/run/case_judgement.h"
#include "study/run/case_report.h"

namespace oilskin::demo {
namespace {

namespace fs = std::filesystem;

Variation variation_of(const ValidateOptions& o) {
  return {o.step, o.thickness, host_of(o.host), preset_of(o.preset), o.set};
}

std::vector<const ValidationCase*> chosen_cases(const ValidateOptions& options) {
  std::vector<const ValidationCase*> chosen;
  for (const std::string& name : options.cases) chosen.push_back(&validation_case(name));
  if (options.cases.empty())
    for (const ValidationCase& c : validation_cases()) chosen.push_back(&c);
  return chosen;
}

std::vector<double> chosen_spacings(const ValidateOptions& options, const ValidationCase& of) {
  if (!options.spacings.empty()) return options.spacings;
  std::vector<double> all = of.spacings;
  if (options.levels > 0 && static_cast<std::size_t>(options.levels) < all.size())
    all.resize(static_cast<std::size_t>(options.levels));
  return all;
}

/// Refuses a folder that cannot be written to before anything is computed.
void prepare(const std::string& out) {
  std::error_code error;
  fs::create_directories(out + "/runs", error);
  const std::string probe = out + "/validation.csv.part";
  if (error || !std::ofstream(probe))
    throw SceneError("--out " + out + ": the folder cannot be written to" +
                     (error ? ": " + error.message() : std::string()));
  fs::remove(probe, error);
}

void list_cases() {
  for (const ValidationCase& c : validation_cases()) {
    std::string levels;
    for (const double spacing : c.spacings) {
      char text[40];
      std::snprintf(text, sizeof text, "%s%.4g", levels.empty() ? "" : ", ", 1e3 * spacing);
      levels += text;
    }
    std::printf("%-16s %s (%s mm)\n", c.name.c_str(), c.title.c_str(), levels.c_str());
  }
}

class Validation {
 public:
  Validation(const ValidateOptions& options, const MakeSimulation& make_simulation)
      : options_(options),
        make_simulation_(make_simulation),
        variation_(variation_of(options)),
        cases_(chosen_cases(options)) {
    for (const ValidationCase* c : cases_)
      for (const double spacing : chosen_spacings(options, *c)) varied_scene(*c, spacing, variation_);
    prepare(options.out);
  }

  int execute() {
    watch_signals();
    for (const ValidationCase* c : cases_) {
      CaseLevels levels{*c, {}};
      for (const double spacing : chosen_spacings(options_, *c)) {
        levels.runs.push_back(run(*c, spacing));
        if (caught_signal() != 0) return static_cast<int>(ExitCode::signalled) + caught_signal();
      }
      results_.push_back(std::move(levels));
    }
    return finish();
  }

 private:
  CaseRun run(const ValidationCase& of, double spacing) {
    const std::string file = case_file(options_.out, of.name, spacing, variation_);
    if (!options_.again)
      if (const auto found = read_case_run(file, of.name, spacing, variation_, options_.threads)) {
        print(of, *found, true);
        return *found;
      }
    CaseRun run = run_case(of, spacing, variation_, options_.threads, make_simulation_,
                           [&](double fraction) { show(of, spacing, fraction); });
    if (run.signal != 0) return run;
    write_case_run(file, run, options_.threads);
    print(of, run, false);
    return run;
  }

  void show(const ValidationCase& of, double spacing, double fraction) {
    const int percent = static_cast<int>(100 * fraction);
    if (options_.quiet || percent == shown_ || isatty(fileno(stdout)) == 0) return;
    shown_ = percent;
    std::printf("\r%-16s %6.4g mm %3d %%", of.name.c_str(), 1e3 * spacing, percent);
    std::fflush(stdout);
  }

  void print(const ValidationCase& of, const CaseRun& run, bool earlier) const {
    if (options_.quiet) return;
    std::printf("\r%-16s %6.4g mm %8.2f s, %llu particles%s\n", of.name.c_str(), 1e3 * run.spacing,
                run.cost.wall_seconds, static_cast<unsigned long long>(run.cost.particles),
                earlier ? " (there already)" : "");
    for (const Quantity& q : run.quantities)
      std::printf("  %-40s %12.5g %12.5g  error %9.3g %s\n", q.name.c_str(), q.value, q.reference, q.error(),
                  verdict(of, run, q));
    if (!run.failure.empty()) std::printf("  FAILED: %s\n", run.failure.c_str());
    if (run.crossings > 0)
      std::printf("  FAILED: %llu crossings\n", static_cast<unsigned long long>(run.crossings));
    std::fflush(stdout);
  }

  int finish() const {
    write_file(options_.out + "/validation.csv", validation_csv(results_));
    write_file(options_.out + "/validation.md",
               validation_markdown(results_, machine_of_study(options_.threads)));
    bool good = true;
    for (const CaseLevels& levels : results_)
      for (const CaseRun& run : levels.runs) good = good && passes(levels.of, run);
    if (!options_.quiet) std::printf("  %s/validation.md\n", options_.out.c_str());
    return static_cast<int>(good ? ExitCode::done : ExitCode::check_failed);
  }

  const ValidateOptions& options_;
  const MakeSimulation& make_simulation_;
  Variation variation_;
  std::vector<const ValidationCase*> cases_;
  std::vector<CaseLevels> results_;
  int shown_ = -1;  // percent
};

}  // namespace

int validate_command(const ValidateOptions& options, const MakeSimulation& make_simulation) {
  if (options.list) {
    list_cases();
    return static_cast<int>(ExitCode::done);
  }
  return Validation(options, make_simulation).execute();
}

}  // namespace oilskin::demo
