/// Reads motion traces (OILSTEP1). A parser of its own: it shares nothing with the writer.
#pragma once

#include <array>
#include <cstdint>
#include <iosfwd>
#include <string>
#include <vector>

namespace oilskin::audit {

using Point = std::array<double, 3>;

struct Surface {
  std::uint64_t id = 0;
  std::vector<Point> start, end;  ///< vertices [m]
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// One certified interval.
struct Record {
  std::uint64_t number = 0;
  double length = 0;  ///< [s]
  std::vector<std::uint64_t> ids;
  std::vector<Point> start, end;  ///< particles [m]
  std::vector<Surface> surfaces;
};

enum class ReadResult { kRecord, kEnd, kMalformed };

/// Reads the next record. On `kMalformed`, `error` says what is wrong. Counts are not believed before the
/// data is there, so a damaged file cannot ask for much memory.
ReadResult read_record(std::istream& in, Record* record, std::string* error);

}  // namespace oilskin::audit
