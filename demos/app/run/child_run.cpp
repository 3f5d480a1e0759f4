#include "run/child_run.h"

#include <spawn.h>
#include <sys/wait.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "output/output_error.h"
#include "run/signals.h"

// NOLINTNEXTLINE(readability-identifier-naming): POSIX's
extern char** environ;

namespace oilskin::demo {
namespace {

int exit_code_of(int status) {
  return WIFEXITED(status) ? WEXITSTATUS(status) : static_cast<int>(ExitCode::signalled) + WTERMSIG(status);
}

}  // namespace

std::string exact(double value) {
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%.17g", value);
  return text.data();
}

std::vector<std::string> arguments_of(const RunOptions& options) {
  std::vector<std::string> all = {"run",       options.scene, "--out",
                                  options.out, "--threads",   std::to_string(options.threads),
                                  "--quiet",   "--no-render"};
  const auto add = [&](const char* name, const std::string& value) {
    all.emplace_back(name);
    all.push_back(value);
  };
  if (options.duration) add("--duration", exact(*options.duration));
  if (options.dt) add("--dt", exact(*options.dt));
  if (options.seed) add("--seed", std::to_string(*options.seed));
  if (options.frames_per_second) add("--frames-per-second", exact(*options.frames_per_second));
  for (const std::string& assignment : options.set) add("--set", assignment);
  return all;
}

std::string program_path() {
  return std::filesystem::read_symlink("/proc/self/exe").string();
}

int run_child(const std::vector<std::string>& arguments) {
  std::string program = program_path();
  std::vector<std::string> texts = arguments;
  std::vector<char*> argv = {program.data()};
  for (std::string& text : texts) argv.push_back(text.data());
  argv.push_back(nullptr);
  pid_t child = 0;
  const int error = posix_spawn(&child, program.c_str(), nullptr, nullptr, argv.data(), environ);
  if (error != 0) throw OutputError(program + ": cannot be started: " + std::strerror(error));
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR)
    if (caught_signal() != 0) kill(child, caught_signal());
  return exit_code_of(status);
}

}  // namespace oilskin::demo
