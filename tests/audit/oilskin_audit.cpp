// oilskin_audit [--delta [SURFACE=]METRES]… FILE: audits a motion trace ("-" = standard input).
// Exit code: 0 nothing found, 1 something found, 2 bad usage or a malformed file.
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iostream>

#include "audit/trace_auditor.h"

namespace {

using oilskin::audit::Limits;
using oilskin::audit::Summary;

bool read_delta(const std::string& text, Limits* limits) {
  const std::size_t equals = text.find('=');
  const std::string value = equals == std::string::npos ? text : text.substr(equals + 1);
  char* end = nullptr;
  const double delta = std::strtod(value.c_str(), &end);
  if (value.empty() || *end != '\0' || !std::isfinite(delta) || delta < 0) return false;
  if (equals == std::string::npos) {
    limits->delta = delta;
    return true;
  }
  const std::string id = text.substr(0, equals);
  if (id.empty() || id.find_first_not_of("0123456789") != std::string::npos) return false;
  limits->delta_of[std::strtoull(id.c_str(), nullptr, 10)] = delta;
  return true;
}

int usage() {
  std::cerr << "usage: oilskin_audit [--delta [SURFACE=]METRES]... FILE   (- = standard input)\n";
  return 2;
}

}  // namespace

int main(int argc, char** argv) {
  Limits limits;
  std::string file;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--delta") {
      if (++i == argc || !read_delta(argv[i], &limits)) return usage();
    } else if (!file.empty() || (word.size() > 1 && word[0] == '-')) {
      return usage();
    } else {
      file = word;
    }
  }
  if (file.empty()) return usage();
  std::ifstream stream;
  if (file != "-") {
    stream.open(file, std::ios::binary);
    if (!stream) {
      std::cerr << "oilskin_audit: " << file << ": cannot be opened\n";
      return 2;
    }
  }
  Summary summary;
  std::string error;
  const bool whole = oilskin::audit::audit_stream(file == "-" ? std::cin : stream, limits, &summary, &error);
  std::cout << summary;
  if (!whole) {
    std::cerr << "oilskin_audit: " << file << ": " << error << '\n';
    return 2;
  }
  return summary.findings() > 0 ? 1 : 0;
}
