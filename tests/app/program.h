// Starts the program as a user does.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace oilskin::test {

struct Outcome {
  int exit_code = -1;  // 128 + n when ended by signal n
  std::string out, err;
};

/// Runs `program` with `arguments`. `signal` != 0 is sent once the standard output holds `signal_after`.
Outcome run_program(const std::string& program, const std::vector<std::string>& arguments);
Outcome run_program_and_signal(const std::string& program, const std::vector<std::string>& arguments,
                               int signal);

/// oilskin ARGUMENTS…
Outcome oilskin(const std::vector<std::string>& arguments);

/// A fresh folder, removed at the end.
class Folder {
 public:
  Folder();
  ~Folder();
  std::string path(const std::string& name = "") const { return name.empty() ? path_ : path_ + "/" + name; }
  std::string write(const std::string& name, const std::string& text) const;
  std::string read(const std::string& name) const;

 private:
  std::string path_;
};

/// report.json of a run of SCENE for `duration` with `more` options; fails the test when the run does not end
/// with 0.
nlohmann::json report_of(const std::string& scene, const std::string& duration,
                         const std::vector<std::string>& more);

/// The columns of series.csv by name.
std::map<std::string, std::vector<double>> read_series(const std::string& text);

}  // namespace oilskin::test
