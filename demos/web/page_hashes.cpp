// page_hashes SCENE.json STEPS EVERY [KEY=VALUE …]: runs the scene of the page on this machine, through the
// functions that the page calls, and prints a JSON object: the state hash after each EVERY steps, and what
// was counted.
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>

#include "page_api.h"

namespace {

std::string contents(const char* file) {
  std::ifstream in(file);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

int refused() {
  std::fprintf(stderr, "page_hashes: %s\n", page_message());
  return 1;
}

/// A number above 0, or 0.
int count_of(const char* argument) {
  char* end = nullptr;
  const long count = std::strtol(argument, &end, 10);
  return *end == '\0' && count > 0 && count < 1000000 ? static_cast<int>(count) : 0;
}

}  // namespace

int main(int argc, char** argv) {
  const int steps = argc > 3 ? count_of(argv[2]) : 0, every = argc > 3 ? count_of(argv[3]) : 0;
  if (steps == 0 || every == 0) {
    std::fprintf(stderr, "usage: page_hashes SCENE.json STEPS EVERY [KEY=VALUE ...]\n");
    return 2;
  }
  std::string settings;
  for (int i = 4; i < argc; ++i) settings += std::string(argv[i]) + "\n";
  if (page_open(contents(argv[1]).c_str(), settings.c_str()) == 0) return refused();
  std::printf("{ \"hashes\": {");
  for (int step = every; step <= steps; step += every) {
    if (page_step(every) == 0) return refused();
    std::printf("%s \"%d\": \"%s\"", step > every ? "," : "", step, page_state_hash());
  }
  std::printf(" },\n  \"report\": %s }\n", page_report());
  return 0;
}
