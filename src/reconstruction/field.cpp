#include "reconstruction/field.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/assert.h"
#include "reconstruction/water.h"

namespace oilskin::reconstruction {

namespace {

constexpr double pi = 3.14159265358979323846;

/// Thresholds of (R.5): the radius decreases to 0 as w decreases from full_above to zero_below. w ≥ 0.5 at a
/// flat surface; w = 0.23 in the middle of a gap of 1.5 dx between two bodies of water.
constexpr float full_above = 0.5f, zero_below = 0.2f;

/// Thresholds of the largest eigenvalue [Solenthaler2007].
constexpr float eigenvalue_low = 0.4f, eigenvalue_high = 3.5f;

/// Deep water: w ≥ min_solid_density and |x − x̄| < max_solid_offset · r.
constexpr float min_solid_density = 0.75f, max_solid_offset = 0.5f;

/// Nodes with even coordinates; one row of eight holds two rows of four.
constexpr int coarse = side / 2;
constexpr float coarse_x[side] = {0, 2, 4, 6, 0, 2, 4, 6}, coarse_y[side] = {0, 0, 0, 0, 4, 4, 4, 4};

/// Volumes of particles [dx³] in water and in sheets of one layer, see FieldParameters::sparse_radius.
constexpr float dense_below = 1.5f, sparse_above = 2.5f;

/// The radius that a cell needs to see a particle wherever it lies [cells], nearly √3/2.
constexpr double seen_radius = 0.88;

/// Particles may see films of the grid higher than their planes tell, where obstacles bend [dx].
constexpr double top_slack = 0.3;

/// Below its plane a disc follows an obstacle that bends by this, per radius: what is farther down, beside a
/// border, is another layer.
constexpr float bend = 0.75f;

/// Films thin out over about half a cell; so that they keep their area, discs are larger by this [cells].
constexpr float rim = 0.25f;

struct Range {
  int first, last;
};

/// Nodes within `reach` of x, in a row of `count` nodes with distance `step`.
Range range(float x, float reach, int step, int count) {
  const float low = (x - reach) / static_cast<float>(step), high = (x + reach) / static_cast<float>(step);
  return {low <= 0 ? 0 : static_cast<int>(std::ceil(low)),
          high >= static_cast<float>(count - 1) ? count - 1 : static_cast<int>(std::floor(high))};
}

/// Decay of the radius with w (R.5), in the form of [Onderik2011].
float density_decay(float w) {
  const float t = std::clamp((full_above - w) / (full_above - zero_below), 0.0f, 1.0f);
  const float u = 1 - t * t;
  return u * u;
}

}  // namespace

float kernel_norm(double radius) {
  return static_cast<float>(315 / (64 * pi * std::pow(radius, 3)));
}

FieldParameters field_parameters(const ReconstructionOptions& o) {
  FieldParameters p;
  p.kind = o.field;
  p.kernel_radius = static_cast<float>(o.kernel_radius / o.cell);
  p.particle_radius = static_cast<float>(o.particle_radius / o.cell);
  p.kernel_norm = kernel_norm(o.kernel_radius);
  p.rest_count = static_cast<float>(std::pow(side * o.cell, 3));
  if (keeps_volume(o) && p.needs_volumes())
    p.sparse_radius = std::max(0.0f, static_cast<float>(seen_radius) - p.particle_radius);
  OILSKIN_ASSERT(p.kernel_radius > 0 && p.rest_count > 0);
  return p;
}

/// Adds a particle at q to a row with the weights at its eight nodes.
inline void FieldBlock::add(const F8& weight, const std::array<float, 3>& q, Row& row) {
  (F8::load(row.weight) + weight).store(row.weight);
  (F8::load(row.x) + weight * q[0]).store(row.x);
  (F8::load(row.y) + weight * q[1]).store(row.y);
  (F8::load(row.z) + weight * q[2]).store(row.z);
}

/// How much of the radius for sparse water a particle brings.
float FieldBlock::sparse_share(float volume) const {
  if (!(p_.sparse_radius > 0)) return 0;
  return std::clamp((volume - dense_below) / (sparse_above - dense_below), 0.0f, 1.0f);
}

/// Adds a particle's share of the radius for sparse water.
inline void FieldBlock::add_sparse(const F8& weight, float share, int row) {
  float* const at = &sparse_[std::size_t(row) * side];
  (F8::load(at) + weight * share).store(at);
}

/// Calls f(j, k, rest) for the rows of nodes that a particle at q reaches; rest = 1 − (dy² + dz²)/R².
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

/// Calls f(j, k, weights) for the rows of nodes that a particle reaches; weights: V k (R.1) at their nodes.
template <class F>
void FieldBlock::for_weights(const std::array<float, 3>& q, float volume, const F& f) const {
  const float scale = 1 / (p_.kernel_radius * p_.kernel_radius);
  const F8 dx = F8(q[0]) - F8::load(row_nodes), dx2 = dx * dx * scale, v = volume;
  for_rows(q, [&](int j, int k, float rest) {
    const F8 u = positive_part(F8(rest) - dx2);
    f(j, k, u * u * u * v);
  });
}

void FieldBlock::scatter(const NearParticles& near) {
  std::memset(rows_, 0, sizeof rows_);
  if (p_.sparse_radius > 0) sparse_.fill(0);
  for (std::size_t c = 0; c < near.count; ++c) {
    const std::array<float, 3> q = {near.x[c], near.y[c], near.z[c]};
    const float sparse = sparse_share(near.volume[c]);
    for_weights(q, near.volume[c], [&](int j, int k, const F8& weights) {
      add(weights, q, rows_[j + side * k]);
      if (sparse > 0) add_sparse(weights, sparse, j + side * k);
    });
  }
}

/// The same for the 4³ nodes with even coordinates. A row holds two rows of four, at y = 2j and 2j + 4.
void FieldBlock::scatter_coarse(const NearParticles& near) {
  std::memset(rows_, 0, sizeof(Row) * coarse * coarse / 2);
  const float scale = 1 / (p_.kernel_radius * p_.kernel_radius);
  const F8 x = F8::load(coarse_x), y = F8::load(coarse_y);
  for (std::size_t c = 0; c < near.count; ++c) {
    const std::array<float, 3> q = {near.x[c], near.y[c], near.z[c]};
    const F8 dx = F8(q[0]) - x, dy0 = F8(q[1]) - y, dy1 = dy0 - 2.0f;
    const F8 in0 = F8(1.0f) - (dx * dx + dy0 * dy0) * scale, in1 = F8(1.0f) - (dx * dx + dy1 * dy1) * scale;
    const Range ks = range(q[2], p_.kernel_radius, 2, coarse);
    for (int k = ks.first; k <= ks.last; ++k) {
      const float dz = q[2] - static_cast<float>(2 * k);
      const F8 z2 = dz * dz * scale, u0 = positive_part(in0 - z2), u1 = positive_part(in1 - z2);
      add(u0 * u0 * u0, q, rows_[2 * k]);
      add(u1 * u1 * u1, q, rows_[2 * k + 1]);
    }
  }
}

std::uint64_t FieldBlock::coarse_inside(const NearParticles& near) {
  scatter_coarse(near);
  std::uint64_t solid = 0;
  const float max_offset = max_solid_offset * p_.particle_radius;
  for (int k = 0; k < coarse; ++k)
    for (int j = 0; j < coarse; ++j)
      for (int i = 0; i < coarse; ++i) {
        const Row& row = rows_[2 * k + j % 2];
        const int lane = i + coarse * (j / 2);
        const float w = row.weight[lane];
        if (!(w * p_.kernel_norm >= min_solid_density)) continue;
        const float dx = row.x[lane] / w - static_cast<float>(2 * i),
                    dy = row.y[lane] / w - static_cast<float>(2 * j),
                    dz = row.z[lane] / w - static_cast<float>(2 * k);
        if (dx * dx + dy * dy + dz * dz < max_offset * max_offset)
          solid |= 1ull << (i + coarse * (j + coarse * k));
      }
  return solid;
}

void FieldBlock::prepare_rows(const BlockVisibility& visibility) {
  visibility.row_sides(row_front_, row_back_);
  block_front_.assign(visibility.words(), ~0ull);
  block_back_.assign(visibility.words(), ~0ull);
  for (std::size_t w = 0; w < row_front_.size(); ++w) {
    block_front_[w % visibility.words()] &= row_front_[w];
    block_back_[w % visibility.words()] &= row_back_[w];
  }
  between_.resize((1 + 2 * side) * visibility.words());
  open_.resize(visibility.words());
}

/// May a triangle be between the particle at q and a node of the block in its reach? If so, hidden() is ready
/// for this particle.
bool FieldBlock::may_be_hidden(const BlockVisibility& visibility, const std::array<float, 3>& q) {
  const float reach = p_.kernel_radius, last = side - 1;
  std::array<float, 3> low, high;
  for (std::size_t a = 0; a < 3; ++a) {
    low[a] = std::min(q[a], std::max(0.0f, q[a] - reach));
    high[a] = std::max(q[a], std::min(last, q[a] + reach));
  }
  if (!visibility.may_overlap(low, high)) return false;
  visibility.sides(q, front_, back_);
  if (!visibility.may_hide(block_front_.data(), block_back_.data(), front_.data(), back_.data(), low, high,
                           open_.data()))
    return false;
  std::uint64_t* const out = between_.data();
  visibility.overlapping(0, low[0], high[0], out);
  for (std::size_t axis = 1; axis < 3; ++axis) {
    const Range rows = range(q[axis], reach, 1, side);
    for (int i = rows.first; i <= rows.last; ++i) {
      const float x = static_cast<float>(i);
      visibility.overlapping(axis, std::min(q[axis], x), std::max(q[axis], x),
                             out + (1 + (axis - 1) * side + std::size_t(i)) * visibility.words());
    }
  }
  shadows_.set(visibility, q);
  return true;
}

/// Which of the `queried` nodes of a row are hidden from the particle of may_be_hidden().
std::uint32_t FieldBlock::hidden(int j, int k, std::uint32_t queried) {
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
  return any == 0 ? 0 : shadows_.hidden(j, k, queried, open_.data());
}

void FieldBlock::scatter_visible(const NearParticles& near, const BlockVisibility& visibility) {
  std::memset(rows_, 0, sizeof rows_);
  if (p_.sparse_radius > 0) sparse_.fill(0);
  prepare_rows(visibility);
  for (std::size_t c = 0; c < near.count; ++c) {
    const std::array<float, 3> q = {near.x[c], near.y[c], near.z[c]};
    const bool check = may_be_hidden(visibility, q);
    const float sparse = sparse_share(near.volume[c]);
    for_weights(q, near.volume[c], [&](int j, int k, F8 weights) {
      if (check)
        if (const std::uint32_t bits = hidden(j, k, greater_mask(weights, 0.0f)); bits != 0)
          weights = cleared(weights, bits);
      add(weights, q, rows_[j + side * k]);
      if (sparse > 0) add_sparse(weights, sparse, j + side * k);
    });
  }
}

bool FieldBlock::evaluate_films(const NearParticles& near, const BlockVisibility& visibility,
                                const Film& film, const float* distances, FilmPlace place, float* values) {
  bool any = false;
  if (!visibility.empty()) prepare_rows(visibility);
  const F8 nodes_x = F8::load(row_nodes);
  const FilmRule& rule = film.rule();
  const auto high = static_cast<float>(rule.clearance + rule.grid_height),
             // A node at another layer, which faces the particle, is not on its film.
      highest = static_cast<float>(rule.clearance + rule.grid_height + top_slack * rule.spacing);
  for (std::size_t c = 0; c < near.count; ++c) {
    const FilmParticle* const p = film.find(near.particle[c]);
    if (!p || !(p->radius > 0)) continue;
    if (!any) std::fill(values, values + nodes, p_.outside());
    any = true;
    const std::array<float, 3> q = {near.x[c], near.y[c], near.z[c]};
    const bool sinks = place == FilmPlace::on_obstacle, is_between = p->other != none;
    const float radius = p->radius + rim, half_height = p->grid_height / 2,
                lowest = static_cast<float>(rule.clearance) + half_height,
                middle =
                    is_between
                        ? static_cast<float>(
                              FilmLayer(*p, sinks ? 1 : 0).middle(double(p->grid_height), rule.clearance))
                        : std::max(p->height, lowest);
    const bool reaches_down = sinks && (!is_between || middle <= lowest * 1.0001f);
    const float bottom = reaches_down ? -static_cast<float>(top_slack * rule.spacing) - bend * radius
                                      : middle - half_height,
                top = sinks && !is_between ? highest : middle + half_height;
    const bool check = !visibility.empty() && may_be_hidden(visibility, q);
    for_rows(q, [&](int j, int k, float) {
      const float dy = static_cast<float>(j) - q[1], dz = static_cast<float>(k) - q[2];
      const F8 dx = nodes_x - q[0], along = dx * p->normal[0] + (dy * p->normal[1] + dz * p->normal[2]);
      const F8 rho2 = positive_part(dx * dx + (dy * dy + dz * dz) - along * along);
      F8 value = (rho2 - radius * radius) * (0.5f / radius);
      const F8 at = along + p->height;
      value = larger(value, larger(at - top, bottom - at));
      const int first = node_index(0, j, k);
      if (sinks && !is_between) value = larger(value, F8::load(&distances[first]) - high);
      float* const row = &values[first];
      const F8 now = F8::load(row);
      std::uint32_t improves = greater_mask(now, value);
      if (improves == 0) return;
      if (check) improves &= ~hidden(j, k, improves);
      float next[side], before[side];
      value.store(next);
      now.store(before);
      for (int i = 0; i < side; ++i) row[i] = improves >> i & 1 ? next[i] : before[i];
    });
  }
  return any;
}

/// For the eigenvalue decay. Not vectorised.
void FieldBlock::scatter_moments(const NearParticles& near, const BlockVisibility* visibility) {
  moments_.assign(side * side, Moments{});
  const float scale = 1 / (p_.kernel_radius * p_.kernel_radius);
  if (visibility) prepare_rows(*visibility);
  for (std::size_t c = 0; c < near.count; ++c) {
    const std::array<float, 3> q = {near.x[c], near.y[c], near.z[c]};
    const bool check = visibility && may_be_hidden(*visibility, q);
    for_rows(q, [&](int j, int k, float) {
      const std::uint32_t out = check ? hidden(j, k, 0xff) : 0;
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
  const double e = max_real_eigenvalue(a);
  if (e < eigenvalue_low) return 1;
  const float g = static_cast<float>((eigenvalue_high - e) / (eigenvalue_high - eigenvalue_low));
  return std::clamp(g * g * g - 3 * g * g + 3 * g, 0.0f, 1.0f);
}

float FieldBlock::value_of(int node) const {
  const int r = node / side, i = node % side;
  const Row& row = rows_[r];
  const float w = row.weight[i];
  // At the kernel's edge the quotient of the sums is inaccurate.
  if (!(w > 1e-9f)) return p_.outside();
  if (p_.kind == ReconstructionField::density) {
    const float inverse_slope = 0.8127f * p_.kernel_radius;  // (R.7)
    return (0.5f - w * p_.kernel_norm) * inverse_slope;
  }
  const int j = r % side, k = r / side;
  const float dx = row.x[i] / w - static_cast<float>(i), dy = row.y[i] / w - static_cast<float>(j),
              dz = row.z[i] / w - static_cast<float>(k);
  const float distance = std::sqrt(dx * dx + dy * dy + dz * dz);
  float radius = p_.particle_radius;
  if (p_.sparse_radius > 0) radius += p_.sparse_radius * sparse_[std::size_t(node)] / w;
  if (p_.kind == ReconstructionField::density_decay) radius *= density_decay(w * p_.kernel_norm);
  if (p_.kind == ReconstructionField::eigenvalue_decay) radius *= eigenvalue_decay(node, Vec3(dx, dy, dz));
  return std::min(distance - radius, p_.outside());
}

void FieldBlock::evaluate(const NearParticles& near, const BlockVisibility* visibility, float* values) {
  OILSKIN_ASSERT(near.padded() <= near.x.size());
  if (visibility && visibility->empty()) visibility = nullptr;
  if (visibility)
    scatter_visible(near, *visibility);
  else
    scatter(near);
  if (p_.kind == ReconstructionField::eigenvalue_decay) scatter_moments(near, visibility);
  for (int n = 0; n < nodes; ++n) values[n] = value_of(n);
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
