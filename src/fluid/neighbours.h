/// Neighbours within the support radius H by a uniform grid of cells of width H. Only occupied cells exist,
/// in sorted order, so that a few drops far away cost nothing. Results do not depend on the number of
/// threads.
#pragma once

#include "core/parallel.h"
#include "fluid/simd.h"
#include "oilskin/types.h"

namespace oilskin::fluid {

class Neighbours {
 public:
  /// Particles per task; the lists of a task lie together.
  static constexpr std::size_t chunk_size = 512;

  /// The cell order of finite positions: order[i] is the place of the i-th now. Stable: within a cell the
  /// order stays as it was.
  const std::vector<std::uint32_t>& cell_order(Span<const Vec3> positions, double support_radius,
                                               const Workers& workers);

  /// Lists of all neighbours, of the positions of the last cell_order() after they were put into that order.
  void search(Span<const Vec3> positions, const Workers& workers);

  std::size_t size() const { return count_.size(); }
  /// Neighbours of particle i without itself. Padded to a multiple of four with size(), the index of a record
  /// that is too far away to count.
  const std::uint32_t* list(std::size_t i) const { return lists_[i / chunk_size].data() + begin_[i]; }
  std::uint32_t count(std::size_t i) const { return count_[i]; }
  std::uint32_t blocks(std::size_t i) const { return (count_[i] + 3) / 4; }
  /// Where values per pair of chunk c may be kept: pair_begin(i) + k, below pair_capacity(c).
  std::size_t pair_begin(std::size_t i) const { return begin_[i]; }
  std::size_t pair_capacity(std::size_t chunk) const { return used_[chunk]; }

  /// (x − origin)/H in float, and one more record that is far from everything; w = 0, free for use by pair
  /// sums.
  const std::vector<Record>& records() const { return records_; }
  std::vector<Record>& records() { return records_; }
  const Vec3& origin() const { return origin_; }

 private:
  struct Key {
    std::uint64_t cell;
    std::uint32_t particle;
  };
  struct Run {
    std::uint32_t begin, end;  // particles, contiguous in cell order
  };
  struct Candidates {
    std::vector<float> x, y, z;
    std::vector<std::uint32_t> particle, near;
    std::uint32_t own_run = 0;  // where the run that contains the cell itself starts
  };

  void make_keys(Span<const Vec3> positions, const Workers& workers);
  void sort_keys(const Workers& workers);
  void make_records(Span<const Vec3> positions, const Workers& workers);
  void find_cells();
  void find_runs(const Workers& workers);
  void runs_of_row(std::size_t row);
  void search_chunk(std::size_t begin, std::size_t end, std::size_t chunk);
  void collect(std::size_t cell, Candidates& c) const;
  void list_neighbours(std::size_t i, std::size_t own, Candidates& c, std::size_t chunk);

  double support_radius_ = 1;
  std::array<int, 3>
      bits_{};  // of the cell coordinates in a key: x lowest, so that cells along x are contiguous
  std::vector<Key> keys_, keys_scratch_;
  std::vector<std::uint32_t> histogram_;
  std::vector<std::uint32_t> order_;
  std::vector<std::uint64_t> cell_key_, row_key_;
  std::vector<std::uint32_t> cell_begin_;  // first particle of a cell
  std::vector<std::uint32_t> row_begin_;   // first cell of a row (same y and z)
  std::vector<std::array<Run, 9>> runs_;   // per cell: the three cells around it in each of the nine rows
  std::vector<Record> records_;
  Vec3 origin_ = Vec3::Zero();
  std::vector<std::vector<std::uint32_t>> lists_;  // per chunk
  std::vector<std::size_t> used_;
  std::vector<std::size_t> begin_;
  std::vector<std::uint32_t> count_;
};

}  // namespace oilskin::fluid
