/// Tables of the study that are no sweep over cases: leaks, stability, sizes.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "hosts/simulation.h"

namespace oilskin::demo {

struct TablePlace {
  std::string directory;
  int threads = 0;  ///< 0 = all hardware threads
  bool again = false, quiet = false;
  MakeSimulation make_simulation;
};

struct StudyTable {
  std::string name, title;
  /// Computes the table, or continues it; the content of NAME.csv. Stops early when a signal comes.
  std::function<std::string(const TablePlace& place)> make;
};

const std::vector<StudyTable>& study_tables();
/// Throws SceneError that names the nearest table.
const StudyTable& study_table(const std::string& name);

/// The rows of a table, one computation each. Those in DIR/runs/NAME.rows, of the same machine and newer than
/// the program, are not computed again. `key` must not hold a tab. Stops when a signal comes.
struct TableRow {
  std::string key;
  std::function<std::string()> compute;  ///< the row, without its end of line
};
std::string rows_of_table(const std::string& name, const std::string& head, const std::vector<TableRow>& rows,
                          const TablePlace& place);

/// Energy made by a jet on free and light cloth, over step and areal density.
StudyTable stability_table();
/// Leaks over method, step and speed; accuracy and cost over method (comparators/).
StudyTable leaks_table();
StudyTable methods_table();
/// Energy made by a box that falls into water, over step and mass.
StudyTable floating_table();
/// Cost of a step over the number of particles, of faces, and of contacts.
StudyTable sizes_table();

}  // namespace oilskin::demo
