#include "study/validate_command.h"

#include <unistd.h>

#include <cstdio>

#include "output/write_file.h"
#include "run/signals.h"
#include "scene/options.h"
#include "study/run/case_files.h"
#include "study/run/case_judgement.h"
#include "study/run/case_report.h"
#include "study/run/obtain_run.h"

namespace oilskin::demo {
namespace {

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
  Validation(const ValidateOptions& options, const RunPlace& place)
      : options_(options), place_(place), variation_(variation_of(options)), cases_(chosen_cases(options)) {
    for (const ValidationCase* c : cases_)
      for (const double spacing : chosen_spacings(options, *c)) varied_scene(*c, spacing, variation_);
    prepare_place(place);
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
    const ObtainedRun obtained =
        obtain_run(of, spacing, variation_, place_, [&](double fraction) { show(of, spacing, fraction); });
    if (obtained.run.signal == 0) print(of, obtained.run, obtained.earlier);
    return obtained.run;
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
                run.cost.wall_seconds.front(), static_cast<unsigned long long>(run.cost.particles),
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
    if (options_.tables) write_tables();
    bool good = true;
    for (const CaseLevels& levels : results_)
      for (const CaseRun& run : levels.runs) good = good && passes(levels.of, run);
    return static_cast<int>(good ? ExitCode::done : ExitCode::check_failed);
  }

  void write_tables() const {
    write_file(options_.out + "/validation.csv", validation_csv(results_));
    write_file(options_.out + "/validation.md",
               validation_markdown(results_, machine_of_study(options_.threads)));
    if (!options_.quiet) std::printf("  %s/validation.md\n", options_.out.c_str());
  }

  const ValidateOptions& options_;
  RunPlace place_;
  Variation variation_;
  std::vector<const ValidationCase*> cases_;
  std::vector<CaseLevels> results_;
  int shown_ = -1;  // percent
};

}  // namespace

int validate_command(const ValidateOptions& options, HostKind built_in,
                     const MakeSimulation& make_simulation) {
  if (options.list) {
    list_cases();
    return static_cast<int>(ExitCode::done);
  }
  return Validation(options,
                    {options.out, options.threads, options.repeat, options.again, built_in, make_simulation})
      .execute();
}

}  // namespace oilskin::demo
