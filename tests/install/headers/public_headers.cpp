// A program that is not Oilskin's takes over its assertions and compares versions.
#include <oilskin/assert.h>
#include <oilskin/trace.h>
#include <oilskin/version.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <sstream>

namespace {

void report_and_leave(const char* expression, const char*, int) {
  std::printf("caught: %s\n", expression);
  std::exit(0);
}

/// One id without positions, which the trace does not accept. Asserted, so only a library with assertions
/// says so.
void write_an_interval_without_positions() {
  const std::uint64_t id = 1;
  oilskin::Interval interval;
  interval.id = {&id, 1};
  std::ostringstream out;
  oilskin::TraceWriter(out).on_interval(interval);
}

}  // namespace

int main(int argc, char** argv) {
  std::printf("%d headers, version %s, library %s\n", HEADERS, OILSKIN_VERSION_STRING,
              oilskin::version() == oilskin::header_version ? "of the same version" : "of another version");
  oilskin::set_assert_handler(report_and_leave);
  if (argc > 1 && std::strcmp(argv[1], "misuse") == 0) {
    write_an_interval_without_positions();
    return 1;
  }
  return 0;
}
