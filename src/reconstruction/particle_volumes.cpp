// V_i of (R.3).
#include <algorithm>

#include "core/assert.h"
#include "reconstruction/field.h"

namespace oilskin::reconstruction {

namespace {

constexpr int half_side = side / 2;
constexpr float half = half_side;

int octant_of(const std::array<float, 3>& x) {
  return (x[0] >= half) | (x[1] >= half) << 1 | (x[2] >= half) << 2;
}

/// Σ k as eight partial sums, which are added in a fixed order.
float kernel_sum(const NearParticles& near, const std::array<float, 3>& x, float scale) {
  F8 sums;
  for (std::size_t c = 0; c < near.padded(); c += 8) {
    const F8 dx = F8::load(&near.x[c]) - x[0], dy = F8::load(&near.y[c]) - x[1],
             dz = F8::load(&near.z[c]) - x[2];
    const F8 u = positive_part(F8(1.0f) - (dx * dx + dy * dy + dz * dz) * scale);
    sums = sums + u * u * u;
  }
  float sum[8];
  sums.store(sum);
  return ((sum[0] + sum[1]) + (sum[2] + sum[3])) + ((sum[4] + sum[5]) + (sum[6] + sum[7]));
}

}  // namespace

void particle_volumes(const ParticleBlocks& particles, const FieldParameters& p,
                      const std::vector<std::uint8_t>& needed, const Workers& workers,
                      std::vector<float>& volumes) {
  OILSKIN_ASSERT(needed.size() == particles.blocks.size());
  volumes.assign(particles.size(), 1.0f);
  const std::vector<float> no_volumes;
  const float scale = 1 / (p.kernel_radius * p.kernel_radius);
  workers.for_chunks(particles.blocks.size(), 16, [&](std::size_t from, std::size_t to, std::size_t) {
    NearParticles near, part;
    for (std::size_t b = from; b < to; ++b) {
      if (!needed[b]) continue;
      const std::size_t begin = particles.begin[b], end = particles.begin[b + 1];
      const float count = static_cast<float>(end - begin);
      // Far too many particles in a block (a wrong spacing): avoids work that is quadratic in their number.
      if (count > 64 * (p.rest_count + 8)) {
        std::fill(volumes.begin() + std::ptrdiff_t(begin), volumes.begin() + std::ptrdiff_t(end),
                  p.rest_count / count);
        continue;
      }
      near.gather(particles, no_volumes, particles.blocks[b], 0, side, p.kernel_radius);
      for (int octant = 0; octant < 8; ++octant) {
        const std::array<float, 3> low = {octant & 1 ? half : 0, octant & 2 ? half : 0,
                                          octant & 4 ? half : 0};
        part.select(near, low, {low[0] + half, low[1] + half, low[2] + half}, p.kernel_radius);
        for (std::size_t i = begin; i < end; ++i) {
          const std::array<float, 3> x = {particles.x[i], particles.y[i], particles.z[i]};
          if (octant_of(x) == octant)
            volumes[i] = 1 / (p.kernel_norm * std::max(kernel_sum(part, x, scale), 1.0f));
        }
      }
    }
  });
}

}  // namespace oilskin::reconstruction
