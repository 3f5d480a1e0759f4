#include "ccd_command.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iomanip>
#include <ostream>

namespace oilskin::demo {
namespace {

constexpr int kRowsPerQuery = 8;
constexpr int kNumbersPerRow = 6;
constexpr int kPasses = 7;  // timed; the median is reported

struct Row {
  Vec3 position;
  bool hit = false;
};

/// A whole number with optional sign, up to the separator; advances `text` past it. Numbers may have more
/// digits than any integer type holds, so they are read as doubles, rounded once.
bool read_whole_number(const char** text, char separator, double* value) {
  const char* c = *text;
  if (*c == '-' || *c == '+') ++c;
  const char* digits = c;
  while (*c >= '0' && *c <= '9') ++c;
  if (c == digits || *c != separator) return false;
  *value = std::strtod(*text, nullptr);
  *text = separator == '\0' ? c : c + 1;
  return true;
}

/// Empty if the line is a row, else what is wrong with it.
std::string read_row(const std::string& line, Row* row) {
  const char* text = line.c_str();
  std::array<double, kNumbersPerRow> number{};
  for (int i = 0; i < kNumbersPerRow; ++i) {
    if (!read_whole_number(&text, ',', &number[i])) {
      return "field " + std::to_string(i + 1) + " is not a whole number followed by a comma";
    }
  }
  double label = 0;
  if (!read_whole_number(&text, '\0', &label) || (label != 0 && label != 1)) {
    return "field 7, the label, must be 0 or 1 and end the line";
  }
  row->hit = label == 1;
  for (int k = 0; k < 3; ++k) {
    if (number[2 * k + 1] == 0) return "field " + std::to_string(2 * k + 2) + ", a denominator, is zero";
    row->position[k] = number[2 * k] / number[2 * k + 1];
    if (!std::isfinite(row->position[k])) return "coordinate " + std::to_string(k + 1) + " is not finite";
  }
  return {};
}

Vec3& corner(ccd::PointTriangleMotion* m, int row) {
  Vec3* const corners[kRowsPerQuery] = {&m->p_t0, &m->a_t0, &m->b_t0, &m->c_t0,
                                        &m->p_t1, &m->a_t1, &m->b_t1, &m->c_t1};
  return *corners[row];
}

struct Score {
  std::size_t queries = 0, hits = 0, false_negatives = 0, false_positives = 0;
  std::array<double, kPasses> nanoseconds{};  // of all queries, per pass

  void add(const Score& other) {
    queries += other.queries;
    hits += other.hits;
    false_negatives += other.false_negatives;
    false_positives += other.false_positives;
    for (int i = 0; i < kPasses; ++i) nanoseconds[i] += other.nanoseconds[i];
  }
  double median_per_query() const {
    std::array<double, kPasses> sorted = nanoseconds;
    std::nth_element(sorted.begin(), sorted.begin() + kPasses / 2, sorted.end());
    return queries == 0 ? 0 : sorted[kPasses / 2] / static_cast<double>(queries);
  }
};

Score judge(const std::vector<LabelledQuery>& queries) {
  Score score;
  score.queries = queries.size();
  for (const LabelledQuery& query : queries) {
    const bool found = ccd::point_triangle(query.motion).hit;
    score.hits += query.hit ? 1 : 0;
    score.false_negatives += query.hit && !found ? 1 : 0;
    score.false_positives += !query.hit && found ? 1 : 0;
  }
  for (double& nanoseconds : score.nanoseconds) {
    const auto start = std::chrono::steady_clock::now();
    std::size_t found = 0;
    for (const LabelledQuery& query : queries) found += ccd::point_triangle(query.motion).hit ? 1 : 0;
    nanoseconds = std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - start).count();
    // A use of the result keeps the loop from being optimised away; the results cannot differ between passes.
    if (found != score.hits - score.false_negatives + score.false_positives) std::abort();
  }
  return score;
}

void print(const std::string& name, const Score& score, std::ostream& out) {
  out << name << ": queries " << score.queries << ", hits " << score.hits << ", false negatives "
      << score.false_negatives << ", false positives " << score.false_positives << ", ns/query " << std::fixed
      << std::setprecision(1) << score.median_per_query() << '\n';
}

}  // namespace

bool read_queries(const std::string& file, std::vector<LabelledQuery>* queries, std::string* error) {
  queries->clear();
  std::ifstream in(file);
  int number = 0, rows = 0;
  const auto fail = [&](const std::string& what) {
    *error = file + (number > 0 ? ":" + std::to_string(number) : "") + ": " + what;
    return false;
  };
  if (!in) return fail("cannot be opened");
  LabelledQuery query;
  std::string line;
  while (std::getline(in, line)) {
    ++number;
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.empty()) continue;
    Row row{Vec3::Zero()};
    const std::string fault = read_row(line, &row);
    if (!fault.empty()) return fail(fault);
    if (rows > 0 && row.hit != query.hit) return fail("the label differs from that of the query's first row");
    query.hit = row.hit;
    corner(&query.motion, rows) = row.position;
    if (++rows < kRowsPerQuery) continue;
    queries->push_back(query);
    rows = 0;
  }
  if (in.bad() || !in.eof()) return fail("cannot be read");
  if (rows > 0) return fail("the last query has " + std::to_string(rows) + " rows instead of 8");
  if (queries->empty()) return fail("holds no query");
  return true;
}

int ccd_command(const std::vector<std::string>& files, std::ostream& out, std::ostream& err) {
  if (files.empty()) {
    err << "oilskin ccd: name at least one file of queries\n";
    return 2;
  }
  std::vector<std::vector<LabelledQuery>> queries(files.size());
  for (std::size_t i = 0; i < files.size(); ++i) {
    std::string error;
    if (!read_queries(files[i], &queries[i], &error)) {
      err << "oilskin ccd: " << error << '\n';
      return 2;
    }
  }
  Score total;
  for (std::size_t i = 0; i < files.size(); ++i) {
    const Score score = judge(queries[i]);
    print(files[i], score, out);
    total.add(score);
  }
  print("total", total, out);
  return total.false_negatives > 0 ? 1 : 0;
}

}  // namespace oilskin::demo
