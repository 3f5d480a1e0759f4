/// `oilskin ccd FILE.csv…`: the continuous test judged by files of queries with known answers.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "ccd/point_triangle.h"

namespace oilskin::demo {

/// One vertex–face query and its exact answer (touching is a hit).
struct LabelledQuery {
  ccd::PointTriangleMotion motion;
  bool hit = false;
};

/// Reads a file of queries: eight rows each (point and corners at t = 0, then at t = 1), a row being
/// x_num,x_den,y_num,y_den,z_num,z_den,label with whole numbers of any length and the label 0 or 1 on each
/// row. Blank lines are skipped. On failure `queries` is unspecified and `error` names file, line and fault.
bool read_queries(const std::string& file, std::vector<LabelledQuery>* queries, std::string* error);

/// Prints a line per file and a last line that begins with `total`. Returns 0; 1 on any false negative; 2,
/// before anything is tested, if a file cannot be read or is malformed.
int ccd_command(const std::vector<std::string>& files, std::ostream& out, std::ostream& err);

}  // namespace oilskin::demo
