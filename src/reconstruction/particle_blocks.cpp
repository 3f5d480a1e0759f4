#include "reconstruction/particle_blocks.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace oilskin::reconstruction {

namespace {

constexpr std::uint64_t no_block = ~0ull;

std::uint64_t block_key(const Vec3& p, double per_cell) {
  const Vec3 q = p * per_cell;
  // The comparison is false for NaN, too.
  if (!(std::abs(q.x()) < 0x1p20 && std::abs(q.y()) < 0x1p20 && std::abs(q.z()) < 0x1p20)) return no_block;
  const auto part = [](double v) { return static_cast<int>(std::floor(v)) >> 3; };
  return key_of({part(q.x()), part(q.y()), part(q.z())});
}

}  // namespace

namespace {

/// Blocks in the order in which their first particles come.
struct BlocksByAppearance {
  std::vector<std::uint64_t> keys;
  std::vector<std::uint32_t> count;     // particles per block
  std::vector<std::uint32_t> block_of;  // per position; none: skipped
  std::size_t skipped = 0;

  BlocksByAppearance(Span<const Vec3> positions, double per_cell) : block_of(positions.size(), none) {
    KeyMap numbers;
    std::uint64_t last_key = no_block;
    std::uint32_t last = none;
    for (std::size_t i = 0; i < positions.size(); ++i) {
      const std::uint64_t key = block_key(positions[i], per_cell);
      if (key == no_block) {
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
  out.index = KeyMap(keys.size());
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

ParticleBlocks sort_into_blocks(Span<const Vec3> positions, double cell, const Workers& workers) {
  OILSKIN_ASSERT(cell > 0 && positions.size() < none);
  const double per_cell = 1 / cell;
  ParticleBlocks out;
  {
    const BlocksByAppearance found(positions, per_cell);
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
  return out;
}

Box ParticleBlocks::bounds() const {
  Box box;
  for (const Int3& b : blocks) {
    const Vec3 low = side * Vec3(b.x, b.y, b.z);
    box.add(Box{low, low + Vec3::Constant(side)});
  }
  return box;
}

void NearParticles::gather(const ParticleBlocks& p, const std::vector<float>& volumes, const Int3& at,
                           float low, float high, float reach) {
  x.clear();
  y.clear();
  z.clear();
  volume.clear();
  particle.clear();
  const float from = low - reach, to = high + reach;
  const int first = static_cast<int>(std::floor(from / side)), last = static_cast<int>(std::floor(to / side));
  for (int dz = first; dz <= last; ++dz)
    for (int dy = first; dy <= last; ++dy)
      for (int dx = first; dx <= last; ++dx) {
        const std::uint32_t b = p.index.find(key_of(at + Int3{dx, dy, dz}));
        if (b == none) continue;
        const float ox = static_cast<float>(side * dx), oy = static_cast<float>(side * dy),
                    oz = static_cast<float>(side * dz);
        for (std::size_t s = p.begin[b]; s < p.begin[b + 1]; ++s) {
          const float px = p.x[s] + ox, py = p.y[s] + oy, pz = p.z[s] + oz;
          if (!(px >= from && px <= to && py >= from && py <= to && pz >= from && pz <= to)) continue;
          x.push_back(px);
          y.push_back(py);
          z.push_back(pz);
          volume.push_back(volumes.empty() ? 1.0f : volumes[s]);
          particle.push_back(static_cast<std::uint32_t>(s));
        }
      }
  pad();
}

void NearParticles::select(const NearParticles& from, const std::array<float, 3>& low, float edge,
                           float reach) {
  for (std::vector<float>* v : {&x, &y, &z, &volume}) v->clear();
  particle.clear();
  const auto in = [&](float value, std::size_t a) {
    return value >= low[a] - reach && value <= low[a] + edge + reach;
  };
  for (std::size_t c = 0; c < from.count; ++c) {
    if (!in(from.x[c], 0) || !in(from.y[c], 1) || !in(from.z[c], 2)) continue;
    x.push_back(from.x[c]);
    y.push_back(from.y[c]);
    z.push_back(from.z[c]);
    volume.push_back(from.volume[c]);
    particle.push_back(from.particle[c]);
  }
  pad();
}

void NearParticles::pad() {
  count = x.size();
  for (; x.size() % 8 != 0; particle.push_back(none)) {
    for (std::vector<float>* v : {&x, &y, &z}) v->push_back(1e15f);
    volume.push_back(0);
  }
}

}  // namespace oilskin::reconstruction
