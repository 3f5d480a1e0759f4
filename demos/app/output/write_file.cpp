#include "output/write_file.h"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "output/output_error.h"

namespace oilskin::demo {

void write_file(const std::string& path, const std::string& content) {
  // Several processes may work on one folder: each has a file of its own.
  const std::string part = path + "." + std::to_string(getpid()) + ".part";
  {
    std::ofstream out(part, std::ios::binary | std::ios::trunc);
    out << content;
    if (!out.flush()) {
      const std::string why = std::strerror(errno);
      std::remove(part.c_str());
      throw OutputError(path + ": cannot be written: " + why);
    }
  }
  std::error_code error;
  std::filesystem::rename(part, path, error);
  if (error) {
    std::remove(part.c_str());
    throw OutputError(path + ": cannot be written: " + error.message());
  }
}

}  // namespace oilskin::demo
