#include "study/tables/study_tables.h"

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>

#include "output/write_file.h"
#include "run/child_run.h"
#include "run/signals.h"
#include "study/run/case_files.h"

namespace oilskin::demo {
namespace {

namespace fs = std::filesystem;

/// Rows by key; the first line names the machine.
std::map<std::string, std::string> stored_rows(const std::string& path, const std::string& machine) {
  std::map<std::string, std::string> rows;
  std::error_code error;
  const auto made = fs::last_write_time(path, error);
  if (error || made < fs::last_write_time(program_path())) return rows;
  std::ifstream file(path);
  std::string line;
  if (!std::getline(file, line) || line != machine) return rows;
  while (std::getline(file, line)) {
    const std::size_t tab = line.find('\t');
    if (tab != std::string::npos) rows[line.substr(0, tab)] = line.substr(tab + 1);
  }
  return rows;
}

std::string stored_text(const std::string& machine, const std::map<std::string, std::string>& rows) {
  std::string text = machine + "\n";
  for (const auto& [key, row] : rows) text.append(key).append("\t").append(row).append("\n");
  return text;
}

}  // namespace

const std::vector<StudyTable>& study_tables() {
  static const std::vector<StudyTable> all = {leaks_table(), methods_table(), stability_table(),
                                              floating_table(), sizes_table()};
  return all;
}

const StudyTable& study_table(const std::string& name) {
  std::vector<std::string> names;
  for (const StudyTable& t : study_tables()) {
    if (t.name == name) return t;
    names.push_back(t.name);
  }
  throw SceneError(name + ": there is no such part of the study" + suggestion(name, names) +
                   ". See oilskin study --list");
}

std::string rows_of_table(const std::string& name, const std::string& head, const std::vector<TableRow>& rows,
                          const TablePlace& place) {
  const std::string path = place.directory + "/runs/" + name + ".rows";
  const std::string machine = machine_of_study(place.threads).dump();
  std::map<std::string, std::string> stored;
  if (!place.again) stored = stored_rows(path, machine);
  std::string text = head + "\n";
  for (const TableRow& row : rows) {
    const bool earlier = stored.count(row.key) > 0;
    if (!earlier) {
      const std::string computed = row.compute();
      if (caught_signal() != 0) return text;
      stored[row.key] = computed;
      write_file(path, stored_text(machine, stored));
    }
    text += stored[row.key] + "\n";
    if (!place.quiet)
      std::printf("%-10s %s%s\n", name.c_str(), stored[row.key].c_str(), earlier ? " (there already)" : "");
    std::fflush(stdout);
  }
  return text;
}

}  // namespace oilskin::demo
