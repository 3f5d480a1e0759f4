/// Neighbours within the support radius H by a uniform grid of cells of width H. Only occupied cells are
/// stored, in sorted order, so that a few drops far away cost nothing. Results do not depend on the number of
/// threads.
#pragma once

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "core/aligned_vector.h"
#include "core/parallel.h"
#include "fluid/pairs/pair_kernels.h"
#include "oilskin/types.h"

namespace oilskin::fluid {

/// Particles are so close together that lists of their neighbours would take minutes and all memory.
struct TooCrowded : std::runtime_error {
  using std::runtime_error::runtime_error;
};

class Neighbours {
 public:
  /// Particles per task; the lists of a task lie together.
  static constexpr std::size_t chunk_size = 512;

  /// The cell order of finite positions: order[i] is the present index of the particle that comes i-th.
  /// Stable within a cell.
  const std::vector<std::uint32_t>& cell_order(Span<const Vec3> positions, double support_radius,
                                               const Workers& workers);

  /// Pairs of particles in the same or in adjacent cells: at most this, and 2000 for each particle. Water at
  /// rest has about 200 (27 cells of 8 particles).
  static constexpr std::uint64_t max_pairs = std::uint64_t{1} << 24, max_pairs_each = 2000;

  /// Finds the neighbours. `positions` are those of the last cell_order(), in that order. Throws TooCrowded
  /// where there are too many pairs.
  void search(Span<const Vec3> positions, const Workers& workers);

  std::size_t size() const { return count_.size(); }
  /// Neighbours of particle i without itself. Padded to a multiple of eight with size(), the index of a
  /// record beyond every support radius.
  const std::uint32_t* list(std::size_t i) const { return lists_[i / chunk_size].data() + begin_[i]; }
  std::uint32_t count(std::size_t i) const { return count_[i]; }
  /// Index for values per pair, counted within the chunk: pair_begin(i) + k < pair_capacity(chunk).
  std::size_t pair_begin(std::size_t i) const { return begin_[i]; }
  std::size_t pair_capacity(std::size_t chunk) const { return used_[chunk]; }
  /// The lists of a chunk; `slopes` and `mass_ratio` as there.
  PairTable table(std::size_t chunk, float* slopes, const float* mass_ratio) const {
    return {lists_[chunk].data(), begin_.data(), count_.data(), slopes, mass_ratio};
  }

  /// f(begin, end) for runs of particles in cell order. The runs contain all particles in the box [m], and
  /// others in cells that overlap it.
  template <class F>
  void for_runs_in(const Box& box, const F& f) const {
    for_cells_in(box, [&](std::size_t first, std::size_t stop) { f(cell_begin_[first], cell_begin_[stop]); });
  }
  /// The same by the occupied cells: f(first, stop) for runs of them.
  template <class F>
  void for_cells_in(const Box& box, const F& f) const;
  std::size_t cell_count() const { return cell_key_.size(); }
  /// First particle of an occupied cell; of cell_count(), the number of particles.
  std::uint32_t cell_begin(std::size_t cell) const { return cell_begin_[cell]; }
  /// Cells are in one group if they are neighbours along x and have the same number.
  std::uint64_t cell_group(std::size_t cell, int width_bits) const { return cell_key_[cell] >> width_bits; }

  /// Boxes of parts of the fluid, a few cells wide, that contain all particles [m].
  std::vector<Box> boxes(Span<const Vec3> positions, const Workers& workers) const;

  /// Removes `second` from the list of `first`. Pairs are sorted and unique, and with (i, j) there is (j, i):
  /// else forces would not be antisymmetric.
  void remove(Span<const std::pair<std::uint32_t, std::uint32_t>> pairs, const Workers& workers);

  /// (x − origin)/H in float, w = 0, and eight more records that are far from everything: the padding.
  const std::vector<Record>& records() const { return records_; }
  const Vec3& origin() const { return origin_; }

 private:
  struct Run {
    std::uint32_t begin, end;  // particles, contiguous in cell order
  };
  using Cell = std::array<std::int32_t, 3>;
  struct Around {  // a cell: the particles that may be neighbours
    AlignedVector<float> x, y, z;
    AlignedVector<std::uint32_t> particle;
    std::size_t count = 0;      // without padding; the arrays are longer
    std::uint32_t own_run = 0;  // where the run that contains the cell itself starts
  };

  /// Cell indices are clamped to ±2²⁰: particles beyond share the outermost cells, which costs time but loses
  /// no neighbours. Three indices and a margin fit into 63 bits.
  static constexpr double max_cell = (1 << 20) - 2;

  Cell cell_of(const Vec3& x) const {
    Cell c;
    for (int k = 0; k < 3; ++k) {
      const double in_cells = std::clamp(x[k] * inverse_radius_, -max_cell, max_cell);
      c[k] = static_cast<std::int32_t>(in_cells);
      c[k] -= c[k] > in_cells;  // floor, which is a function call without SSE4.1
    }
    return c;
  }
  std::size_t first_row(std::uint64_t row_key) const;
  void make_keys(Span<const Vec3> positions, const Workers& workers);
  void sort_keys(const Workers& workers);
  void make_records(Span<const Vec3> positions, const Workers& workers);
  void find_cells(const Workers& workers);
  void find_runs(const Workers& workers);
  /// `around`: the first rows that are not before those around the row in the planes z − 1, z and z + 1.
  void runs_of_row(std::size_t row, const std::array<std::size_t, 3>& around);
  /// The key of the row at y − 1 + dy and z − 1 + dz of a row. Indices in keys are ≥ 1.
  std::uint64_t row_around(std::size_t row, std::uint64_t dz, std::uint64_t dy) const {
    return row_key_[row] + (dz << bits_[1]) + dy - (std::uint64_t{1} << bits_[1]) - 1;
  }
  void check_crowds(const Workers& workers) const;
  void search_chunk(std::size_t begin, std::size_t end, std::size_t chunk);
  void collect(const PairKernels& kernels, std::size_t cell, Around& c) const;
  void list_neighbours(const PairKernels& kernels, std::size_t i, std::size_t own, Around& c,
                       std::size_t chunk);

  double support_radius_ = 1, inverse_radius_ = 1;
  Cell first_cell_{}, last_cell_{};  // of all particles
  // Of the cell coordinates in a key: x lowest, so that cells along x are contiguous
  std::array<int, 3> bits_{};
  std::vector<std::uint64_t> keys_, keys_scratch_;  // cell of each particle, sorted
  std::vector<std::uint32_t> order_, order_scratch_;
  std::vector<std::uint32_t> histogram_;
  std::vector<std::uint64_t> cell_key_, row_key_;
  std::vector<std::uint32_t> cell_begin_;  // first particle of a cell
  std::vector<std::uint32_t> row_begin_;   // first cell of a row (same y and z)
  std::vector<std::array<Run, 9>> runs_;   // per cell: the three cells around it in each of the nine rows
  std::vector<Record> records_;
  Vec3 origin_ = Vec3::Zero();
  std::vector<std::vector<std::uint32_t>> lists_;  // per chunk
  std::vector<std::size_t> used_;
  std::vector<std::uint32_t> begin_;
  std::vector<std::uint32_t> count_;
};

template <class F>
void Neighbours::for_cells_in(const Box& box, const F& f) const {
  if (row_key_.empty()) return;
  Cell low = cell_of(box.min), high = cell_of(box.max);
  for (int k = 0; k < 3; ++k) {
    if (low[k] > last_cell_[k] || high[k] < first_cell_[k]) return;
    low[k] = std::max(low[k], first_cell_[k]) - first_cell_[k] + 1;  // offset by one, as in the keys
    high[k] = std::min(high[k], last_cell_[k]) - first_cell_[k] + 1;
  }
  const auto row_of = [&](std::uint64_t y, std::uint64_t z) { return (z << bits_[1]) | y; };
  const std::uint64_t y_mask = (std::uint64_t{1} << bits_[1]) - 1,
                      x_mask = (std::uint64_t{1} << bits_[0]) - 1;
  const auto y0 = static_cast<std::uint64_t>(low[1]), y1 = static_cast<std::uint64_t>(high[1]);
  const auto z0 = static_cast<std::uint64_t>(low[2]), z1 = static_cast<std::uint64_t>(high[2]);
  const auto x0 = static_cast<std::uint64_t>(low[0]), x1 = static_cast<std::uint64_t>(high[0]);
  for (std::size_t r = first_row(row_of(y0, z0)); r < row_key_.size() && row_key_[r] <= row_of(y1, z1);) {
    const std::uint64_t y = row_key_[r] & y_mask, z = row_key_[r] >> bits_[1];
    if (y < y0 || y > y1) {  // skip to the first row of the box in this plane, or in the next
      r = first_row(row_of(y0, y > y1 ? z + 1 : z));
      continue;
    }
    const auto row = cell_key_.begin() + row_begin_[r], row_end = cell_key_.begin() + row_begin_[r + 1];
    auto stop = std::lower_bound(row, row_end, (row_key_[r] << bits_[0]) | x0);
    const auto first = stop;
    while (stop != row_end && (*stop & x_mask) <= x1) ++stop;
    if (stop != first)
      f(static_cast<std::size_t>(first - cell_key_.begin()),
        static_cast<std::size_t>(stop - cell_key_.begin()));
    ++r;
  }
}

}  // namespace oilskin::fluid
