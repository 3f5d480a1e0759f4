#include "reconstruction/field.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/assert.h"
#include "reconstruction/lanes.h"

namespace oilskin::reconstruction {

namespace {

constexpr double pi = 3.14159265358979323846;

/// Where w falls from the higher to the lower number the radius fades to nothing. At a flat surface w is a
/// half or more, so nothing fades there; in the middle of a gap of 1.5 spacings between two bodies of water
/// it is 0.23.
constexpr float fades_below = 0.5f, gone_below = 0.2f;

/// Thresholds of the largest eigenvalue [Solenthaler2007].
constexpr float eigenvalue_low = 0.4f, eigenvalue_high = 3.5f;

/// Well inside: this share of full water, and its centre not farther than this share of r.
constexpr float solid_share = 0.75f, solid_offset = 0.5f;

/// Nodes with even coordinates, two rows of them side by side.
constexpr int coarse = side / 2;
constexpr float coarse_x[side] = {0, 2, 4, 6, 0, 2, 4, 6}, coarse_y[side] = {0, 0, 0, 0, 4, 4, 4, 4};

struct Range {
  int first, last;
};

/// Nodes of a row of `count`, `step` apart, within `reach` of x.
Range range(float x, float reach, int step, int count) {
  const float low = (x - reach) / static_cast<float>(step), high = (x + reach) / static_cast<float>(step);
  return {low <= 0 ? 0 : static_cast<int>(std::ceil(low)),
          high >= static_cast<float>(count - 1) ? count - 1 : static_cast<int>(std::floor(high))};
}

/// The decay of the radius with the share of water (R.5): the form of [Onderik2011], thresholds above.
float density_decay(float w) {
  const float t = std::clamp((fades_below - w) / (fades_below - gone_below), 0.0f, 1.0f);
  const float u = 1 - t * t;
  return u * u;
}

}  // namespace

FieldParameters field_parameters(const ReconstructionOptions& o) {
  FieldParameters p;
  p.kind = o.field;
  p.kernel_radius = static_cast<float>(o.kernel_radius / o.cell);
  p.particle_radius = static_cast<float>(o.particle_radius / o.cell);
  p.share = static_cast<float>(315 / (64 * pi * std::pow(o.kernel_radius, 3)));
  p.rest_count = static_cast<float>(std::pow(side * o.cell, 3));
  OILSKIN_ASSERT(p.kernel_radius > 0 && p.rest_count > 0);
  return p;
}

/// Adds a particle at q to a row: weights of its eight nodes.
inline void FieldBlock::add(const Lanes& weight, const std::array<float, 3>& q, Row& row) {
  (Lanes::load(row.weight) + weight).store(row.weight);
  (Lanes::load(row.x) + weight * q[0]).store(row.x);
  (Lanes::load(row.y) + weight * q[1]).store(row.y);
  (Lanes::load(row.z) + weight * q[2]).store(row.z);
}

/// f(j, k, rest) for the rows of nodes that a particle at q reaches; rest: 1 − (dy² + dz²)/R².
template <class F>
void FieldBlock::for_rows(const std::array<float, 3>& q, const F& f) const {
  const float scale = 1 / (p_.kernel_radius * p_.kernel_radius);
  const Range ks = range(q[2], p_.kernel_radius, 1, side), js = range(q[1], p_.kernel_radius, 1, side);
  for (int k = ks.first; k <= ks.last; ++k)
    for (int j = js.first; j <= js.last; ++j) {
      const float dz = q[2] - static_cast<float>(k), dy = q[1] - static_cast<float>(j);
      const float rest = 1 - (dz * dz + dy * dy) * scale;
      if (rest > 0) f(j, k, rest);
    }
}

/// f(j, k, weights) for the rows of nodes that a particle reaches: V k (R.1) of their nodes.
template <class F>
void FieldBlock::for_weights(const std::array<float, 3>& q, float volume, const F& f) const {
  const float scale = 1 / (p_.kernel_radius * p_.kernel_radius);
  const Lanes dx = Lanes(q[0]) - Lanes::load(node_numbers), dx2 = dx * dx * scale, v = volume;
  for_rows(q, [&](int j, int k, float rest) {
    const Lanes u = positive_part(Lanes(rest) - dx2);
    f(j, k, u * u * u * v);
  });
}

void FieldBlock::scatter(const NearParticles& near) {
  std::memset(rows_, 0, sizeof rows_);
  for (std::size_t c = 0; c < near.count; ++c) {
    const std::array<float, 3> q = {near.x[c], near.y[c], near.z[c]};
    for_weights(q, near.volume[c],
                [&](int j, int k, const Lanes& weights) { add(weights, q, rows_[j + side * k]); });
  }
}

/// The same for 4³ nodes at even coordinates. A row holds two rows of four, at y = 2j and 2j + 4.
void FieldBlock::scatter_coarse(const NearParticles& near) {
  std::memset(rows_, 0, sizeof(Row) * coarse * coarse / 2);
  const float scale = 1 / (p_.kernel_radius * p_.kernel_radius);
  const Lanes x = Lanes::load(coarse_x), y = Lanes::load(coarse_y);
  for (std::size_t c = 0; c < near.count; ++c) {
    const std::array<float, 3> q = {near.x[c], near.y[c], near.z[c]};
    const Lanes dx = Lanes(q[0]) - x, dy0 = Lanes(q[1]) - y, dy1 = dy0 - 2.0f;
    const Lanes in0 = Lanes(1.0f) - (dx * dx + dy0 * dy0) * scale,
                in1 = Lanes(1.0f) - (dx * dx + dy1 * dy1) * scale;
    const Range ks = range(q[2], p_.kernel_radius, 2, coarse);
    for (int k = ks.first; k <= ks.last; ++k) {
      const float dz = q[2] - static_cast<float>(2 * k);
      const Lanes z2 = dz * dz * scale, u0 = positive_part(in0 - z2), u1 = positive_part(in1 - z2);
      add(u0 * u0 * u0, q, rows_[2 * k]);
      add(u1 * u1 * u1, q, rows_[2 * k + 1]);
    }
  }
}

std::uint64_t FieldBlock::coarse_inside(const NearParticles& near) {
  scatter_coarse(near);
  std::uint64_t good = 0;
  const float far = solid_offset * p_.particle_radius;
  for (int k = 0; k < coarse; ++k)
    for (int j = 0; j < coarse; ++j)
      for (int i = 0; i < coarse; ++i) {
        const Row& row = rows_[2 * k + j % 2];
        const int lane = i + coarse * (j / 2);
        const float w = row.weight[lane];
        if (!(w * p_.share >= solid_share)) continue;
        const float dx = row.x[lane] / w - static_cast<float>(2 * i),
                    dy = row.y[lane] / w - static_cast<float>(2 * j),
                    dz = row.z[lane] / w - static_cast<float>(2 * k);
        if (dx * dx + dy * dy + dz * dz < far * far) good |= 1ull << (i + coarse * (j + coarse * k));
      }
  return good;
}

void FieldBlock::look_from_rows(const BlockSight& sight) {
  sight.row_sides(row_front_, row_back_);
  block_front_.assign(sight.words(), ~0ull);
  block_back_.assign(sight.words(), ~0ull);
  for (std::size_t w = 0; w < row_front_.size(); ++w) {
    block_front_[w % sight.words()] &= row_front_[w];
    block_back_[w % sight.words()] &= row_back_[w];
  }
  between_.resize((1 + 2 * side) * sight.words());
  open_.resize(sight.words());
}

/// May a triangle come between the particle q and a node of the block in its reach? If so, hidden() tells of
/// which.
bool FieldBlock::look_from(const BlockSight& sight, const std::array<float, 3>& q) {
  const float reach = p_.kernel_radius, last = side - 1;
  std::array<float, 3> low, high;
  for (std::size_t a = 0; a < 3; ++a) {
    low[a] = std::min(q[a], std::max(0.0f, q[a] - reach));
    high[a] = std::max(q[a], std::min(last, q[a] + reach));
  }
  if (!sight.may_meet(low, high)) return false;
  sight.sides(q, front_, back_);
  if (!sight.may_hide(block_front_.data(), block_back_.data(), front_.data(), back_.data(), low, high,
                      open_.data()))
    return false;
  std::uint64_t* const out = between_.data();
  sight.overlapping(0, low[0], high[0], out);
  for (std::size_t axis = 1; axis < 3; ++axis) {
    const Range rows = range(q[axis], reach, 1, side);
    for (int i = rows.first; i <= rows.last; ++i) {
      const float x = static_cast<float>(i);
      sight.overlapping(axis, std::min(q[axis], x), std::max(q[axis], x),
                        out + (1 + (axis - 1) * side + std::size_t(i)) * sight.words());
    }
  }
  shadows_.set(sight, q);
  return true;
}

/// Of the nodes `wanted` of a row, those that are hidden from the particle that look_from() was given.
std::uint32_t FieldBlock::hidden(int j, int k, std::uint32_t wanted) {
  const std::size_t words = open_.size();
  const std::uint64_t *x = between_.data(), *y = x + words * std::size_t(1 + j),
                      *z = x + words * std::size_t(1 + side + k);
  const std::uint64_t *row_front = &row_front_[words * std::size_t(j + side * k)],
                      *row_back = &row_back_[words * std::size_t(j + side * k)];
  std::uint64_t any = 0;
  for (std::size_t w = 0; w < words; ++w) {
    const std::uint64_t one_side = (row_front[w] & front_[w]) | (row_back[w] & back_[w]);
    any |= open_[w] = ~one_side & x[w] & y[w] & z[w];
  }
  return any == 0 ? 0 : shadows_.hidden(j, k, wanted, open_.data());
}

void FieldBlock::scatter_visible(const NearParticles& near, const BlockSight& sight) {
  std::memset(rows_, 0, sizeof rows_);
  look_from_rows(sight);
  for (std::size_t c = 0; c < near.count; ++c) {
    const std::array<float, 3> q = {near.x[c], near.y[c], near.z[c]};
    const bool look = look_from(sight, q);
    for_weights(q, near.volume[c], [&](int j, int k, Lanes weights) {
      if (look)
        if (const std::uint32_t bits = hidden(j, k, larger(weights, 0.0f)); bits != 0)
          weights = without(weights, bits);
      add(weights, q, rows_[j + side * k]);
    });
  }
}

/// For the eigenvalue decay; slow, and clear.
void FieldBlock::scatter_moments(const NearParticles& near, const BlockSight* sight) {
  moments_.assign(side * side, Moments{});
  const float scale = 1 / (p_.kernel_radius * p_.kernel_radius);
  if (sight) look_from_rows(*sight);
  for (std::size_t c = 0; c < near.count; ++c) {
    const std::array<float, 3> q = {near.x[c], near.y[c], near.z[c]};
    const bool look = sight && look_from(*sight, q);
    for_rows(q, [&](int j, int k, float) {
      const std::uint32_t out = look ? hidden(j, k, 0xff) : 0;
      Moments& m = moments_[std::size_t(j + side * k)];
      const float y = q[1] - static_cast<float>(j), z = q[2] - static_cast<float>(k);
      for (int i = 0; i < side; ++i) {
        const float x = q[0] - static_cast<float>(i);
        const float u = 1 - (x * x + y * y + z * z) * scale;
        if (!(u > 0) || (out >> i & 1)) continue;
        const float f = 6 * scale * u * u * near.volume[c];
        m.xx[i] += f * x * x;
        m.xy[i] += f * x * y;
        m.xz[i] += f * x * z;
        m.yy[i] += f * y * y;
        m.yz[i] += f * y * z;
        m.zz[i] += f * z * z;
        m.x[i] += f * x;
        m.y[i] += f * y;
        m.z[i] += f * z;
      }
    });
  }
}

/// f(e) of [Solenthaler2007] (R.6), e the largest eigenvalue of ∇x̄ (R.8); ∇k = m y.
float FieldBlock::eigenvalue_decay(int node, const Vec3& mean_offset) const {
  const std::size_t r = std::size_t(node) / side, i = std::size_t(node) % side;
  const Moments& m = moments_[r];
  const double w = rows_[r].weight[i];
  Eigen::Matrix3d a;
  a << m.xx[i], m.xy[i], m.xz[i], m.xy[i], m.yy[i], m.yz[i], m.xz[i], m.yz[i], m.zz[i];
  a = a / w - mean_offset * Vec3(m.x[i], m.y[i], m.z[i]).transpose() / w;
  const double largest = max_real_eigenvalue(a);
  if (largest < eigenvalue_low) return 1;
  const float g = static_cast<float>((eigenvalue_high - largest) / (eigenvalue_high - eigenvalue_low));
  return std::clamp(g * g * g - 3 * g * g + 3 * g, 0.0f, 1.0f);
}

float FieldBlock::value_of(int node) const {
  const int r = node / side, i = node % side;
  const Row& row = rows_[r];
  const float w = row.weight[i];
  // The kernel's edge, where a quotient of two sums would be noise.
  if (!(w > 1e-9f)) return p_.outside();
  if (p_.kind == ReconstructionField::density) {
    const float slope = 0.8127f * p_.kernel_radius;  // of w at a flat surface, turned over
    return (0.5f - w * p_.share) * slope;
  }
  const int j = r % side, k = r / side;
  const float dx = row.x[i] / w - static_cast<float>(i), dy = row.y[i] / w - static_cast<float>(j),
              dz = row.z[i] / w - static_cast<float>(k);
  const float away = std::sqrt(dx * dx + dy * dy + dz * dz);
  float radius = p_.particle_radius;
  if (p_.kind == ReconstructionField::density_decay) radius *= density_decay(w * p_.share);
  if (p_.kind == ReconstructionField::eigenvalue_decay) radius *= eigenvalue_decay(node, Vec3(dx, dy, dz));
  return std::min(away - radius, p_.outside());
}

void FieldBlock::evaluate(const NearParticles& near, const BlockSight* sight, float* values) {
  OILSKIN_ASSERT(near.x.size() % 8 == 0 && near.count <= near.x.size());
  if (sight && !sight->empty())
    scatter_visible(near, *sight);
  else
    scatter(near);
  if (p_.kind == ReconstructionField::eigenvalue_decay)
    scatter_moments(near, sight && !sight->empty() ? sight : nullptr);
  for (int n = 0; n < nodes; ++n) values[n] = value_of(n);
}

namespace {

constexpr int half_side = side / 2;
constexpr float half = half_side;

int octant_of(const std::array<float, 3>& x) {
  return (x[0] >= half) | (x[1] >= half) << 1 | (x[2] >= half) << 2;
}

/// Σ k, as eight sums that are added in a fixed order.
float kernel_sum(const NearParticles& near, const std::array<float, 3>& x, float scale) {
  Lanes sums;
  for (std::size_t c = 0; c < near.x.size(); c += 8) {
    const Lanes dx = Lanes::load(&near.x[c]) - x[0], dy = Lanes::load(&near.y[c]) - x[1],
                dz = Lanes::load(&near.z[c]) - x[2];
    const Lanes u = positive_part(Lanes(1.0f) - (dx * dx + dy * dy + dz * dz) * scale);
    sums = sums + u * u * u;
  }
  float sum[8];
  sums.store(sum);
  return ((sum[0] + sum[1]) + (sum[2] + sum[3])) + ((sum[4] + sum[5]) + (sum[6] + sum[7]));
}

}  // namespace

std::vector<float> particle_volumes(const ParticleBlocks& particles, const FieldParameters& p,
                                    const std::vector<std::uint8_t>& wanted, const Workers& workers) {
  OILSKIN_ASSERT(wanted.size() == particles.blocks.size());
  std::vector<float> volumes(particles.size(), 1.0f);
  const std::vector<float> no_volumes;
  const float scale = 1 / (p.kernel_radius * p.kernel_radius);
  workers.for_chunks(particles.blocks.size(), 16, [&](std::size_t from, std::size_t to, std::size_t) {
    NearParticles near, part;
    for (std::size_t b = from; b < to; ++b) {
      if (!wanted[b]) continue;
      const std::size_t begin = particles.begin[b], end = particles.begin[b + 1];
      const float here = static_cast<float>(end - begin);
      // A heap of particles in one place (a spacing that is wrong, say) must not take the square of its
      // number.
      if (here > 64 * (p.rest_count + 8)) {
        std::fill(volumes.begin() + std::ptrdiff_t(begin), volumes.begin() + std::ptrdiff_t(end),
                  p.rest_count / here);
        continue;
      }
      near.gather(particles, no_volumes, particles.blocks[b], 0, side, p.kernel_radius);
      for (int octant = 0; octant < 8; ++octant) {
        const std::array<float, 3> low = {octant & 1 ? half : 0, octant & 2 ? half : 0,
                                          octant & 4 ? half : 0};
        part.select(near, low, half, p.kernel_radius);
        for (std::size_t i = begin; i < end; ++i) {
          const std::array<float, 3> x = {particles.x[i], particles.y[i], particles.z[i]};
          if (octant_of(x) == octant) volumes[i] = 1 / (p.share * std::max(kernel_sum(part, x, scale), 1.0f));
        }
      }
    }
  });
  return volumes;
}

double max_real_eigenvalue(const Eigen::Matrix3d& a) {
  // λ³ − t λ² + m λ − d = 0 with λ = t/3 + μ: μ³ + p μ + q = 0.
  const double t = a.trace(), d = a.determinant();
  const double m = 0.5 * (t * t - (a * a).trace());
  const double third = t / 3, p = m - t * third, q = -2 * third * third * third + m * third - d;
  const double discriminant = q * q / 4 + p * p * p / 27;
  if (discriminant <= 0) {
    const double r = std::sqrt(std::max(0.0, -p / 3));
    if (r == 0) return third;
    return third + 2 * r * std::cos(std::acos(std::clamp(-q / (2 * r * r * r), -1.0, 1.0)) / 3);
  }
  const double root = std::sqrt(discriminant);
  return third + std::cbrt(-q / 2 + root) + std::cbrt(-q / 2 - root);
}

}  // namespace oilskin::reconstruction
