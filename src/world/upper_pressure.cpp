#include "world/upper_pressure.h"

#include <algorithm>
#include <array>
#include <cstring>

namespace oilskin::world {

namespace {

/// Largest number of particles that do not count, of all.
constexpr std::size_t one_in = 1000;

constexpr std::size_t chunk_size = 16384;

/// Positive doubles in order, eight to an octave: the exponent and three bits of the fraction.
constexpr int bits_below = 49;

/// From 1 mPa to 1e12 Pa; what lies beyond is in the first or the last.
constexpr std::size_t bins = 400;
constexpr std::uint64_t first_bin = (1023 - 10) * 8;

std::size_t bin_of(double pressure) {
  std::uint64_t bits;
  std::memcpy(&bits, &pressure, sizeof bits);
  const std::uint64_t bin = bits >> bits_below;
  return static_cast<std::size_t>(std::clamp(bin, first_bin, first_bin + bins - 1) - first_bin);
}

double upper_end(std::size_t bin) {
  const std::uint64_t bits = (first_bin + bin + 1) << bits_below;
  double pressure;
  std::memcpy(&pressure, &bits, sizeof pressure);
  return pressure;
}

struct Histogram {
  std::array<std::uint32_t, bins> count = {};
  void operator+=(const Histogram& o) {
    for (std::size_t k = 0; k < bins; ++k) count[k] += o.count[k];
  }
};

}  // namespace

double upper_pressure(Span<const double> pressure, const Workers& workers) {
  const Histogram all =
      workers.ordered_sum(pressure.size(), chunk_size, Histogram(), [&](std::size_t begin, std::size_t end) {
        Histogram part;
        for (std::size_t i = begin; i < end; ++i)
          if (pressure[i] > 0) ++part.count[bin_of(pressure[i])];
        return part;
      });
  const std::size_t ignored = pressure.size() / one_in;
  std::size_t above = 0;
  for (std::size_t k = bins; k-- > 0;) {
    above += all.count[k];
    if (above > ignored) return upper_end(k);
  }
  return 0;
}

}  // namespace oilskin::world
