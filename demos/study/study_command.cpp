#include "study/study_command.h"

#include <cstdio>

#include "output/write_file.h"
#include "run/signals.h"
#include "scene/options.h"
#include "study/run/case_files.h"
#include "study/run/obtain_run.h"
#include "study/run/study_table.h"
#include "study/tables/study_tables.h"

namespace oilskin::demo {
namespace {

bool is_sweep(const std::string& part) {
  for (const Sweep& s : sweeps())
    if (s.name == part) return true;
  return false;
}

std::vector<std::string> all_parts() {
  std::vector<std::string> parts;
  for (const Sweep& s : sweeps()) parts.push_back(s.name);
  for (const StudyTable& t : study_tables()) parts.push_back(t.name);
  return parts;
}

std::vector<StudiedCase> chosen_cases(const StudyOptions& options) {
  if (options.cases.empty()) return studied_cases();
  std::vector<StudiedCase> chosen;
  std::vector<std::string> known;
  for (const StudiedCase& s : studied_cases()) known.push_back(s.name);
  for (const std::string& name : options.cases) {
    for (const StudiedCase& s : studied_cases())
      if (s.name == name) chosen.push_back(s);
    if (chosen.empty() || chosen.back().name != name)
      throw SceneError("--case " + name + ": is not studied" + suggestion(name, known));
  }
  return chosen;
}

void list_parts() {
  for (const Sweep& s : sweeps()) std::printf("%-12s %s\n", s.name.c_str(), s.title.c_str());
  for (const StudyTable& t : study_tables()) std::printf("%-12s %s\n", t.name.c_str(), t.title.c_str());
}

class Study {
 public:
  Study(const StudyOptions& options, const RunPlace& place)
      : options_(options), place_(place), cases_(chosen_cases(options)) {
    parts_ = options.parts.empty() ? all_parts() : options.parts;
    for (const std::string& part : parts_)
      if (!is_sweep(part)) study_table(part);  // refuses unknown names
    prepare_place(place_);
  }

  int execute() {
    watch_signals();
    for (const std::string& part : parts_) {
      if (is_sweep(part))
        run_sweep(sweep(part));
      else
        run_table(study_table(part));
      if (caught_signal() != 0) return static_cast<int>(ExitCode::signalled) + caught_signal();
    }
    if (rows_.empty()) return static_cast<int>(ExitCode::done);
    mark_pareto_front(rows_);
    write("study.csv", study_csv(rows_));
    write("study.md", study_markdown(rows_, machine_of_study(place_.threads)));
    return static_cast<int>(ExitCode::done);
  }

 private:
  void run_sweep(const Sweep& sweep) {
    for (const StudiedCase& studied : cases_) {
      const ValidationCase& of = validation_case(studied.name);
      for (const SweepPoint& point : points_of(sweep, of)) {
        const double spacing = point.spacing > 0 ? point.spacing : studied.spacing;
        const ObtainedRun obtained = obtain_run(of, spacing, point.variation, place_, [](double) {});
        if (caught_signal() != 0) return;
        rows_.push_back({sweep.name, point.label, studied.quantity, obtained.run});
        print(rows_.back(), obtained.earlier);
      }
    }
  }

  void run_table(const StudyTable& table) {
    const TablePlace place{place_.directory, place_.threads, place_.again, options_.quiet,
                           place_.make_simulation};
    const std::string csv = table.make(place);
    if (caught_signal() == 0) write(table.name + ".csv", csv);
  }

  void print(const StudyRow& row, bool earlier) const {
    if (options_.quiet) return;
    std::printf("%-10s %-12s %-14s error %10.3g, %8.3g s/s%s%s\n", row.run.name.c_str(), row.sweep.c_str(),
                row.label.c_str(), row.error(), row.run.cost.seconds_per_simulated_second().median,
                earlier ? " (there already)" : "", row.run.failure.empty() ? "" : " FAILED");
    std::fflush(stdout);
  }

  void write(const std::string& name, const std::string& content) const {
    write_file(place_.directory + "/" + name, content);
    if (!options_.quiet) std::printf("  %s/%s\n", place_.directory.c_str(), name.c_str());
  }

  const StudyOptions& options_;
  RunPlace place_;
  std::vector<StudiedCase> cases_;
  std::vector<std::string> parts_;
  std::vector<StudyRow> rows_;
};

}  // namespace

int study_command(const StudyOptions& options, HostKind built_in, const MakeSimulation& make_simulation) {
  if (options.list) {
    list_parts();
    return static_cast<int>(ExitCode::done);
  }
  return Study(options,
               {options.out, options.threads, options.repeat, options.again, built_in, make_simulation})
      .execute();
}

}  // namespace oilskin::demo
