#include "reconstruction/particle_blocks.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/simd.h"

namespace oilskin::reconstruction {

namespace {

constexpr std::uint64_t no_block = ~0ull;

std::uint64_t block_key(const Vec3& p, double per_cell) {
  const Vec3 q = p * per_cell;
  // The comparison is false for NaN, too.
  if (!(std::abs(q.x()) < 0x1p20 && std::abs(q.y()) < 0x1p20 && std::abs(q.z()) < 0x1p20)) return no_block;
  return key_of(block_at(q));
}

}  // namespace

namespace {

/// Blocks in the order in which their first particles come.
struct BlocksByAppearance {
  std::vector<std::uint64_t> keys;
  std::vector<std::uint32_t> count;     // particles per block
  std::vector<std::uint32_t> block_of;  // per position; none: skipped
  std::size_t skipped = 0;

  BlocksByAppearance(const ReconstructionInput& input, double per_cell)
      : block_of(input.positions.size(), none) {
    KeyMap numbers;
    std::uint64_t last_key = no_block;
    std::uint32_t last = none;
    for (std::size_t i = 0; i < input.positions.size(); ++i) {
      if (!input.volumes.empty() && !(input.volumes[i] > 0)) continue;
      const std::uint64_t key = block_key(input.positions[i], per_cell);
      if (key == no_block || (!input.velocities.empty() && !input.velocities[i].cast<float>().allFinite())) {
        ++skipped;
        continue;
      }
      if (key != last_key) {
        last_key = key;
        last = numbers.insert(key, static_cast<std::uint32_t>(keys.size()));
        if (last == keys.size()) {
          keys.push_back(key);
          count.push_back(0);
        }
      }
      block_of[i] = last;
      ++count[last];
    }
  }
};

/// Numbers the blocks by key, and orders the particles by block.
void order_by_key(const BlocksByAppearance& found, ParticleBlocks& out) {
  const std::vector<std::uint64_t>& keys = found.keys;
  std::vector<std::uint32_t> order(keys.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return keys[a] < keys[b]; });
  out.index.reset(keys.size());
  out.blocks.clear();
  out.begin.assign(1, 0);
  std::vector<std::uint32_t> next(keys.size());
  for (std::uint32_t b : order) {
    next[b] = out.begin.back();
    out.index.insert(keys[b], static_cast<std::uint32_t>(out.blocks.size()));
    out.blocks.push_back(block_of_key(keys[b]));
    out.begin.push_back(out.begin.back() + found.count[b]);
  }
  out.source.resize(out.begin.back());
  for (std::size_t i = 0; i < found.block_of.size(); ++i)
    if (found.block_of[i] != none) out.source[next[found.block_of[i]]++] = static_cast<std::uint32_t>(i);
}

}  // namespace

void sort_into_blocks(const ReconstructionInput& input, double cell, const Workers& workers,
                      ParticleBlocks& out) {
  const Span<const Vec3> positions = input.positions;
  OILSKIN_ASSERT(cell > 0 && positions.size() < none);
  OILSKIN_ASSERT(input.volumes.empty() || input.volumes.size() == positions.size());
  OILSKIN_ASSERT(input.velocities.empty() || input.velocities.size() == positions.size());
  const double per_cell = 1 / cell;
  {
    const BlocksByAppearance found(input, per_cell);
    out.skipped = found.skipped;
    order_by_key(found, out);
  }
  for (std::vector<float>* v : {&out.x, &out.y, &out.z}) v->resize(out.size());
  const double edge = side * cell;
  workers.for_each(out.blocks.size(), 64, [&](std::size_t b) {
    const Vec3 origin(out.blocks[b].x * edge, out.blocks[b].y * edge, out.blocks[b].z * edge);
    for (std::size_t s = out.begin[b]; s < out.begin[b + 1]; ++s) {
      const Vec3 p = (positions[out.source[s]] - origin) * per_cell;
      out.x[s] = static_cast<float>(p.x());
      out.y[s] = static_cast<float>(p.y());
      out.z[s] = static_cast<float>(p.z());
    }
  });
}

Box ParticleBlocks::bounds() const {
  Box box;
  for (const Int3& b : blocks) {
    const Vec3 low = side * Vec3(b.x, b.y, b.z);
    box.add(Box{low, low + Vec3::Constant(side)});
  }
  return box;
}

namespace {

using simd::F8;

/// Calls f(i) for the elements i of [begin, end) with x, y and z in [low, high], in their order.
template <class F>
void for_inside(const float* x, const float* y, const float* z, std::size_t begin, std::size_t end,
                const std::array<float, 3>& low, const std::array<float, 3>& high, const F& f) {
  const auto out = [&](const float* v, std::size_t axis) {
    const F8 at = F8::load(v);
    return greater_mask(low[axis], at) | greater_mask(at, high[axis]);
  };
  std::size_t i = begin;
  for (; i + 8 <= end; i += 8)
    for (std::uint32_t bits = 0xff & ~(out(x + i, 0) | out(y + i, 1) | out(z + i, 2)); bits != 0;
         bits &= bits - 1)
      f(i + std::size_t(__builtin_ctz(bits)));
  for (; i < end; ++i)
    if (x[i] >= low[0] && x[i] <= high[0] && y[i] >= low[1] && y[i] <= high[1] && z[i] >= low[2] &&
        z[i] <= high[2])
      f(i);
}

}  // namespace

void NearParticles::make_space(std::size_t more) {
  const std::size_t needed = count + more + 8;
  if (needed <= x.size()) return;
  for (std::vector<float>* v : {&x, &y, &z, &volume}) v->resize(2 * needed);
  particle.resize(2 * needed);
}

/// The block lies `step` blocks away.
void NearParticles::add_block(const ParticleBlocks& p, const std::vector<float>& volumes, std::size_t block,
                              const Int3& step, const Limits& limits) {
  const std::array<float, 3> offset = {float(side * step.x), float(side * step.y), float(side * step.z)};
  const std::size_t begin = p.begin[block], end = p.begin[block + 1];
  make_space(end - begin);
  std::array<float, 3> low, high;
  for (std::size_t a = 0; a < 3; ++a) {
    low[a] = limits.low[a] - offset[a];
    high[a] = limits.high[a] - offset[a];
  }
  const auto add = [&](std::size_t s) {
    x[count] = p.x[s] + offset[0];
    y[count] = p.y[s] + offset[1];
    z[count] = p.z[s] + offset[2];
    volume[count] = volumes.empty() ? 1.0f : volumes[s];
    particle[count++] = static_cast<std::uint32_t>(s);
  };
  for_inside(p.x.data(), p.y.data(), p.z.data(), begin, end, low, high, add);
}

void NearParticles::gather(const ParticleBlocks& p, const std::vector<float>& volumes, const Int3& at,
                           float low, float high, float reach) {
  count = 0;
  const float from = low - reach, to = high + reach;
  const int first = static_cast<int>(std::floor(from / side)), last = static_cast<int>(std::floor(to / side));
  const Limits limits = {{from, from, from}, {to, to, to}};
  for (int dz = first; dz <= last; ++dz)
    for (int dy = first; dy <= last; ++dy)
      for (int dx = first; dx <= last; ++dx) {
        const std::uint32_t b = p.index.find(key_of(at + Int3{dx, dy, dz}));
        if (b != none) add_block(p, volumes, b, {dx, dy, dz}, limits);
      }
  pad();
}

void NearParticles::select(const NearParticles& from, const std::array<float, 3>& low,
                           const std::array<float, 3>& high, float reach) {
  count = 0;
  make_space(from.count);
  std::array<float, 3> least, most;
  for (std::size_t a = 0; a < 3; ++a) {
    least[a] = low[a] - reach;
    most[a] = high[a] + reach;
  }
  for_inside(from.x.data(), from.y.data(), from.z.data(), 0, from.count, least, most, [&](std::size_t c) {
    x[count] = from.x[c];
    y[count] = from.y[c];
    z[count] = from.z[c];
    volume[count] = from.volume[c];
    particle[count++] = from.particle[c];
  });
  pad();
}

void NearParticles::pad() {
  make_space(0);
  for (std::size_t c = count; c < padded(); ++c) {
    x[c] = y[c] = z[c] = 1e15f;
    volume[c] = 0;
    particle[c] = none;
  }
}

}  // namespace oilskin::reconstruction
