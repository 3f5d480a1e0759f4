#include "app/program.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace oilskin::test {
namespace {

std::string contents(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

[[noreturn]] void become(const std::string& program, const std::vector<std::string>& arguments,
                         const std::string& out, const std::string& err) {
  std::vector<char*> argv;
  std::string name = program;
  std::vector<std::string> copies = arguments;
  argv.push_back(name.data());
  for (std::string& a : copies) argv.push_back(a.data());
  argv.push_back(nullptr);
  unsetenv("DISPLAY");
  const int o = open(out.c_str(), O_CREAT | O_WRONLY | O_TRUNC, 0600);
  const int e = open(err.c_str(), O_CREAT | O_WRONLY | O_TRUNC, 0600);
  dup2(o, 1);
  dup2(e, 2);
  execv(name.c_str(), argv.data());
  _exit(127);
}

Outcome start(const std::string& program, const std::vector<std::string>& arguments, int signal) {
  const Folder folder;
  const std::string out = folder.path("out"), err = folder.path("err");
  const pid_t child = fork();
  if (child == 0) become(program, arguments, out, err);
  // The first step is done when the first line of progress is there.
  for (int i = 0; signal != 0 && i < 600 && contents(out).find('%') == std::string::npos; ++i) usleep(50000);
  if (signal != 0) kill(child, signal);
  int status = 0;
  waitpid(child, &status, 0);
  Outcome outcome;
  outcome.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  outcome.out = contents(out);
  outcome.err = contents(err);
  return outcome;
}

}  // namespace

Outcome run_program(const std::string& program, const std::vector<std::string>& arguments) {
  return start(program, arguments, 0);
}

Outcome run_program_and_signal(const std::string& program, const std::vector<std::string>& arguments,
                               int signal) {
  return start(program, arguments, signal);
}

Outcome oilskin(const std::vector<std::string>& arguments) {
  const char* const other = std::getenv("OILSKIN_TESTED_PROGRAM");
  return run_program(other ? other : OILSKIN_PROGRAM, arguments);
}

Folder::Folder() {
  std::string name = (std::filesystem::temp_directory_path() / "oilskin-test-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) ADD_FAILURE() << "no temporary folder";
  path_ = name;
}

Folder::~Folder() {
  std::error_code error;
  std::filesystem::remove_all(path_, error);
}

std::string Folder::write(const std::string& name, const std::string& text) const {
  std::ofstream(path(name), std::ios::binary) << text;
  return path(name);
}

std::string Folder::read(const std::string& name) const {
  return contents(path(name));
}

nlohmann::json report_of(const std::string& scene, const std::string& duration,
                         const std::vector<std::string>& more) {
  const Folder folder;
  std::vector<std::string> arguments = {"run", scene,   "--quiet",    "--no-render", "--frames-per-second",
                                        "0",   "--out", folder.path()};
  if (!duration.empty())
    // The promise, not the energies: some scenes begin with what no pressure solver resolves.
    arguments.insert(arguments.end(), {"--duration", duration, "--set",
                                       R"(acceptance={"energy_made": 1e9, "diverged_steps": 1})"});
  arguments.insert(arguments.end(), more.begin(), more.end());
  const Outcome outcome = oilskin(arguments);
  EXPECT_EQ(outcome.exit_code, 0) << scene << ": " << outcome.err << folder.read("report.json");
  return nlohmann::json::parse(folder.read("report.json"), nullptr, false);
}

std::map<std::string, std::vector<double>> read_series(const std::string& text) {
  std::istringstream in(text);
  std::string line, word;
  std::getline(in, line);
  std::vector<std::string> names;
  for (std::istringstream head(line); std::getline(head, word, ',');) names.push_back(word);
  std::map<std::string, std::vector<double>> columns;
  while (std::getline(in, line)) {
    std::size_t k = 0;
    for (std::istringstream row(line); std::getline(row, word, ','); ++k)
      columns[names.at(k)].push_back(std::stod(word));
    EXPECT_EQ(k, names.size());
  }
  return columns;
}

}  // namespace oilskin::test
