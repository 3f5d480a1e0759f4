#include "fluid/neighbours.h"

#include <cmath>
#include <sstream>

#include "core/assert.h"

namespace oilskin::fluid {

namespace {

constexpr std::size_t sort_chunk = 8192, cell_chunk = 1024, row_chunk = 64;
constexpr int most_digit_bits = 10;

/// The record of the padding: far from everything, and its square is a finite float.
constexpr Record far_away = {1e18f, 1e18f, 1e18f, 0};

constexpr std::size_t list_padding = 8;

/// Length of a padded list in water at rest, H from 2 to 2.2 dx.
constexpr std::size_t usual_list = 42;

/// Records beyond the last one that the search may read, and places beyond a list that it may write.
constexpr std::size_t read_ahead = 8, write_ahead = 16;

/// Width of the blocks whose particles boxes() puts into one box.
constexpr std::uint64_t block_cells = 4;  // a power of two

constexpr std::size_t padded_size(std::size_t n) {
  return (n + list_padding - 1) / list_padding * list_padding;
}

struct Extent {
  Box box;
  void operator+=(const Extent& o) { box.add(o.box); }
};

int bits_for(std::uint64_t values) {
  int bits = 0;
  while ((std::uint64_t{1} << bits) < values) ++bits;
  return bits;
}

}  // namespace

const std::vector<std::uint32_t>& Neighbours::cell_order(Span<const Vec3> positions, double support_radius,
                                                         const Workers& workers) {
  OILSKIN_ASSERT(positions.size() < UINT32_MAX);
  OILSKIN_ASSERT(support_radius > 0);
  support_radius_ = support_radius;
  inverse_radius_ = 1 / support_radius;
  make_keys(positions, workers);
  sort_keys(workers);
  return order_;
}

void Neighbours::make_keys(Span<const Vec3> positions, const Workers& workers) {
  keys_.resize(positions.size());
  order_.resize(positions.size());
  const Extent all =
      workers.ordered_sum(positions.size(), sort_chunk, Extent{}, [&](std::size_t b, std::size_t e) {
        Extent part;
        for (std::size_t i = b; i < e; ++i) {
          OILSKIN_ASSERT(positions[i].allFinite());  // the world removes particles that are not
          part.box.add(positions[i]);
        }
        return part;
      });
  // Cells ascend with positions. One empty cell on either side, so that a neighbouring cell never wraps into
  // another row.
  bits_ = {};
  if (positions.empty()) return;
  first_cell_ = cell_of(all.box.min);
  last_cell_ = cell_of(all.box.max);
  for (int k = 0; k < 3; ++k)
    bits_[k] = bits_for(static_cast<std::uint64_t>(last_cell_[k] - first_cell_[k]) + 3);
  workers.for_each(positions.size(), sort_chunk, [&](std::size_t i) {
    const Cell c = cell_of(positions[i]);
    std::uint64_t key = 0;
    for (int k = 2; k >= 0; --k)
      key = (key << bits_[k]) | static_cast<std::uint64_t>(c[k] - first_cell_[k] + 1);
    keys_[i] = key;
    order_[i] = static_cast<std::uint32_t>(i);
  });
}

/// Radix sort, least significant digit first: stable, so the result does not depend on the chunks.
void Neighbours::sort_keys(const Workers& workers) {
  const std::size_t n = keys_.size(), chunks = (n + sort_chunk - 1) / sort_chunk;
  keys_scratch_.resize(n);
  order_scratch_.resize(n);
  const int key_bits = bits_[0] + bits_[1] + bits_[2];
  OILSKIN_ASSERT(key_bits <= 64);
  if (n == 0) return;
  const int rounds = (key_bits + most_digit_bits - 1) / most_digit_bits;
  const int digit_bits = (key_bits + rounds - 1) / rounds;
  const std::size_t digits = std::size_t{1} << digit_bits;
  for (int shift = 0; shift < key_bits; shift += digit_bits) {
    auto digit = [&](std::uint64_t key) { return (key >> shift) & (digits - 1); };
    histogram_.assign(chunks * digits, 0);
    workers.for_chunks(n, sort_chunk, [&](std::size_t b, std::size_t e, std::size_t c) {
      std::uint32_t* h = &histogram_[c * digits];
      for (std::size_t i = b; i < e; ++i) ++h[digit(keys_[i])];
    });
    std::uint32_t sum = 0;
    for (std::size_t d = 0; d < digits; ++d)
      for (std::size_t c = 0; c < chunks; ++c) {
        const std::uint32_t here = histogram_[c * digits + d];
        histogram_[c * digits + d] = sum;
        sum += here;
      }
    workers.for_chunks(n, sort_chunk, [&](std::size_t b, std::size_t e, std::size_t c) {
      std::uint32_t* h = &histogram_[c * digits];
      for (std::size_t i = b; i < e; ++i) {
        const std::uint32_t place = h[digit(keys_[i])]++;
        keys_scratch_[place] = keys_[i];
        order_scratch_[place] = order_[i];
      }
    });
    keys_.swap(keys_scratch_);
    order_.swap(order_scratch_);
  }
}

void Neighbours::search(Span<const Vec3> positions, const Workers& workers) {
  OILSKIN_ASSERT(positions.size() == keys_.size());
  const std::size_t n = positions.size();
  make_records(positions, workers);
  find_cells(workers);
  find_runs(workers);
  check_crowds(workers);
  begin_.resize(n);
  count_.resize(n);
  const std::size_t chunks = (n + chunk_size - 1) / chunk_size;
  if (lists_.size() < chunks) lists_.resize(chunks);
  used_.assign(chunks, 0);
  workers.for_chunks(n, chunk_size,
                     [&](std::size_t b, std::size_t e, std::size_t c) { search_chunk(b, e, c); });
}

void Neighbours::check_crowds(const Workers& workers) const {
  struct Crowd {
    std::uint64_t pairs = 0, largest = 0;  // largest: particles of a cell
    void operator+=(const Crowd& o) {
      pairs += o.pairs;
      largest = std::max(largest, o.largest);
    }
  };
  const Crowd all = workers.ordered_sum(cell_count(), sort_chunk, Crowd{}, [&](std::size_t b, std::size_t e) {
    Crowd part;
    for (std::size_t cell = b; cell < e; ++cell) {
      std::uint64_t around = 0;
      for (const Run& run : runs_[cell]) around += run.end - run.begin;
      const std::uint64_t own = cell_begin_[cell + 1] - cell_begin_[cell];
      part += {own * around, own};
    }
    return part;
  });
  const std::uint64_t most = max_pairs + max_pairs_each * order_.size();
  if (all.pairs <= most) return;
  std::ostringstream text;
  text << "the particles are too crowded: " << all.largest << " lie in a cube of " << support_radius_
       << " m, and " << all.pairs << " pairs may be neighbours; it must be at most " << most
       << ": spread or remove some (World::remove_particles())";
  throw TooCrowded(text.str());
}

/// The origin is the median of a sample: it lies in the bulk, so that rounding to float is small there, even
/// if a few drops are far away.
void Neighbours::make_records(Span<const Vec3> positions, const Workers& workers) {
  const std::size_t n = positions.size(), samples = std::min<std::size_t>(n, 255);
  origin_.setZero();
  std::vector<double> sample(samples);
  for (int k = 0; k < 3 && n > 0; ++k) {
    for (std::size_t s = 0; s < samples; ++s) sample[s] = positions[s * n / samples][k];
    std::nth_element(sample.begin(), sample.begin() + static_cast<std::ptrdiff_t>(samples / 2), sample.end());
    origin_[k] = sample[samples / 2];
  }
  const double inverse = 1 / support_radius_;
  records_.resize(n + read_ahead);
  std::fill(records_.end() - read_ahead, records_.end(), far_away);
  workers.for_each(n, sort_chunk, [&](std::size_t i) {
    const Eigen::Vector3f x = ((positions[i] - origin_) * inverse).cast<float>();
    records_[i] = {x[0], x[1], x[2], 0};
  });
}

void Neighbours::find_cells(const Workers& workers) {
  const std::size_t n = keys_.size();
  const auto row_of = [&](std::size_t i) { return keys_[i] >> bits_[0]; };
  // f(i, whether a row begins, too) for the first particle of each cell.
  const auto for_starts = [&](std::size_t begin, std::size_t end, const auto& f) {
    for (std::size_t i = begin; i < end; ++i)
      if (i == 0 || keys_[i] != keys_[i - 1]) f(i, i == 0 || row_of(i) != row_of(i - 1));
  };
  // Counted by chunks of particles, then written to the places that follow from the counts.
  struct Count {
    std::uint32_t cells = 0, rows = 0;
  };
  std::vector<Count> place((n + sort_chunk - 1) / sort_chunk);
  workers.for_chunks(n, sort_chunk, [&](std::size_t b, std::size_t e, std::size_t c) {
    for_starts(b, e, [&](std::size_t, bool begins_row) {
      ++place[c].cells;
      place[c].rows += begins_row;
    });
  });
  Count all;
  for (Count& of_chunk : place) {
    const Count here = of_chunk;
    of_chunk = all;
    all.cells += here.cells;
    all.rows += here.rows;
  }
  cell_key_.resize(all.cells);
  cell_begin_.resize(all.cells + 1);
  row_key_.resize(all.rows);
  row_begin_.resize(all.rows + 1);
  workers.for_chunks(n, sort_chunk, [&](std::size_t b, std::size_t e, std::size_t c) {
    Count at = place[c];
    for_starts(b, e, [&](std::size_t i, bool begins_row) {
      if (begins_row) {
        row_key_[at.rows] = row_of(i);
        row_begin_[at.rows++] = at.cells;
      }
      cell_key_[at.cells] = keys_[i];
      cell_begin_[at.cells++] = static_cast<std::uint32_t>(i);
    });
  });
  cell_begin_.back() = static_cast<std::uint32_t>(n);
  row_begin_.back() = all.cells;
  OILSKIN_ASSERT(std::is_sorted(cell_key_.begin(), cell_key_.end()));
}

void Neighbours::find_runs(const Workers& workers) {
  runs_.resize(cell_key_.size());
  workers.for_chunks(row_key_.size(), row_chunk, [&](std::size_t begin, std::size_t end, std::size_t) {
    // Of each plane the first row that is not before those around. It ascends with the rows.
    std::array<std::size_t, 3> around{};
    for (std::size_t k = 0; k < 3; ++k) around[k] = first_row(row_around(begin, k, 0));
    for (std::size_t row = begin; row < end; ++row) {
      for (std::size_t k = 0; k < 3; ++k)
        while (around[k] < row_key_.size() && row_key_[around[k]] < row_around(row, k, 0)) ++around[k];
      runs_of_row(row, around);
    }
  });
}

void Neighbours::runs_of_row(std::size_t row, const std::array<std::size_t, 3>& around) {
  const std::uint64_t x_mask = (std::uint64_t{1} << bits_[0]) - 1;
  for (std::size_t slot = 0, r = 0; slot < 9; ++slot) {
    if (slot % 3 == 0) r = around[slot / 3];
    const bool exists = r < row_key_.size() && row_key_[r] == row_around(row, slot / 3, slot % 3);
    const std::size_t stop = exists ? row_begin_[r + 1] : 0;
    std::size_t first = exists ? row_begin_[r++] : 0, last = first;
    for (std::size_t c = row_begin_[row]; c < row_begin_[row + 1]; ++c) {
      const std::uint64_t x = cell_key_[c] & x_mask;  // ≥ 1
      while (first < stop && (cell_key_[first] & x_mask) < x - 1) ++first;
      last = std::max(last, first);
      while (last < stop && (cell_key_[last] & x_mask) <= x + 1) ++last;
      runs_[c][slot] = {cell_begin_[first], cell_begin_[last]};
    }
  }
}

std::size_t Neighbours::first_row(std::uint64_t row_key) const {
  return static_cast<std::size_t>(std::lower_bound(row_key_.begin(), row_key_.end(), row_key) -
                                  row_key_.begin());
}

std::vector<Box> Neighbours::boxes(Span<const Vec3> positions, const Workers& workers) const {
  OILSKIN_ASSERT(positions.size() == keys_.size());
  std::uint64_t place_in_block = 0;  // the bits of a key that differ between the cells of a block
  for (std::size_t k = 0, shift = 0; k < 3; shift += bits_[k], ++k)
    place_in_block |= (std::min(block_cells, std::uint64_t{1} << bits_[k]) - 1) << shift;
  // Runs of cells along x that lie in one block. Chunks of cells may part a run: its pieces are joined below.
  struct Part {
    std::uint64_t block;
    Box box;
  };
  std::vector<std::vector<Part>> of_chunk((cell_count() + cell_chunk - 1) / cell_chunk);
  workers.for_chunks(cell_count(), cell_chunk, [&](std::size_t begin, std::size_t end, std::size_t c) {
    std::vector<Part>& parts = of_chunk[c];
    for (std::size_t cell = begin; cell < end; ++cell) {
      const std::uint64_t block = cell_key_[cell] & ~place_in_block;
      if (parts.empty() || parts.back().block != block) parts.push_back({block, Box()});
      for (std::uint32_t i = cell_begin_[cell]; i < cell_begin_[cell + 1]; ++i)
        parts.back().box.add(positions[i]);
    }
  });
  std::vector<Part> parts;
  for (const std::vector<Part>& some : of_chunk) parts.insert(parts.end(), some.begin(), some.end());
  std::sort(parts.begin(), parts.end(), [](const Part& a, const Part& b) { return a.block < b.block; });
  std::vector<Box> boxes;
  for (std::size_t k = 0; k < parts.size(); ++k)
    if (k > 0 && parts[k].block == parts[k - 1].block)
      boxes.back().add(parts[k].box);
    else
      boxes.push_back(parts[k].box);
  return boxes;
}

void Neighbours::remove(Span<const std::pair<std::uint32_t, std::uint32_t>> pairs, const Workers& workers) {
  OILSKIN_ASSERT(std::is_sorted(pairs.begin(), pairs.end()));
  OILSKIN_ASSERT(pairs.empty() || pairs[pairs.size() - 1].first < size());
  std::vector<std::size_t> first_of;  // index of each particle's first pair
  for (std::size_t k = 0; k < pairs.size(); ++k)
    if (k == 0 || pairs[k].first != pairs[k - 1].first) first_of.push_back(k);
  workers.for_each(first_of.size(), 64, [&](std::size_t g) {
    const std::uint32_t i = pairs[first_of[g]].first;
    std::uint32_t* list = lists_[i / chunk_size].data() + begin_[i];
    const std::size_t stop = g + 1 < first_of.size() ? first_of[g + 1] : pairs.size();
    const auto is_removed = [&](std::uint32_t j) {
      return std::binary_search(pairs.begin() + static_cast<std::ptrdiff_t>(first_of[g]),
                                pairs.begin() + static_cast<std::ptrdiff_t>(stop), std::make_pair(i, j));
    };
    const std::size_t padded = padded_size(count_[i]);
    std::uint32_t kept = 0;
    for (std::uint32_t k = 0; k < count_[i]; ++k)
      if (!is_removed(list[k])) list[kept++] = list[k];
    OILSKIN_ASSERT(kept < count_[i]);  // it was a neighbour
    count_[i] = kept;
    for (; kept < padded; ++kept) list[kept] = static_cast<std::uint32_t>(count_.size());
  });
}

void Neighbours::search_chunk(std::size_t begin, std::size_t end, std::size_t chunk) {
  Around candidates;
  const PairKernels& kernels = pair_kernels();
  if (lists_[chunk].empty()) lists_[chunk].resize(usual_list * (end - begin));
  std::size_t cell = static_cast<std::size_t>(
      std::upper_bound(cell_begin_.begin(), cell_begin_.end(), static_cast<std::uint32_t>(begin)) -
      cell_begin_.begin() - 1);
  for (std::size_t i = begin; i < end; ++cell) {
    collect(kernels, cell, candidates);
    const std::uint32_t own_first = runs_[cell][4].begin;
    for (const std::size_t stop = std::min<std::size_t>(end, cell_begin_[cell + 1]); i < stop; ++i)
      list_neighbours(kernels, i, candidates.own_run + (i - own_first), candidates, chunk);
  }
}

void Neighbours::collect(const PairKernels& kernels, std::size_t cell, Around& c) const {
  std::size_t n = 0;
  for (const Run& r : runs_[cell]) n += r.end - r.begin;
  c.count = n;
  if (const std::size_t length = n + candidate_padding; c.particle.size() < length) {
    for (AlignedVector<float>* v : {&c.x, &c.y, &c.z}) v->resize(length);
    c.particle.resize(length);
  }
  std::size_t k = 0;
  for (std::size_t slot = 0; slot < 9; ++slot) {
    const Run& r = runs_[cell][slot];
    if (slot == 4) c.own_run = static_cast<std::uint32_t>(k);
    kernels.columns(records_.data(), {r.begin, r.end}, &c.x[k], &c.y[k], &c.z[k]);
    std::uint32_t* const particle = &c.particle[k];
    const std::uint32_t count = r.end - r.begin;
    for (std::uint32_t j = 0; j < count; ++j) particle[j] = r.begin + j;
    k += count;
  }
  for (AlignedVector<float>* v : {&c.x, &c.y, &c.z})
    std::fill_n(v->data() + n, candidate_padding, far_away.x);
}

void Neighbours::list_neighbours(const PairKernels& kernels, std::size_t i, std::size_t own, Around& c,
                                 std::size_t chunk) {
  OILSKIN_ASSERT(own < c.count && c.particle[own] == i);
  const std::size_t n = c.count, begin = used_[chunk];
  std::vector<std::uint32_t>& list = lists_[chunk];
  if (list.size() < begin + n + write_ahead) {
    list.reserve(begin + n + write_ahead + list.size() / 32);  // resize() alone would reserve twice as much
    list.resize(list.capacity());
  }
  std::uint32_t* out = list.data() + begin;
  c.x[own] = far_away.x;  // no neighbour of itself
  std::size_t found =
      kernels.near({c.x.data(), c.y.data(), c.z.data(), c.particle.data(), n}, records_[i], out);
  c.x[own] = records_[i].x;
  begin_[i] = static_cast<std::uint32_t>(begin);
  count_[i] = static_cast<std::uint32_t>(found);
  std::fill_n(out + found, list_padding, static_cast<std::uint32_t>(count_.size()));  // without a branch
  used_[chunk] = begin + padded_size(found);
}

}  // namespace oilskin::fluid
