#include "reconstruction/vertex_data.h"

#include <algorithm>
#include <cmath>

#include "core/assert.h"
#include "reconstruction/block_parts.h"

namespace oilskin::reconstruction {

namespace {

/// Added to the particles' covariance [dx²]: if they lie in a plane, the slope across it becomes 0.
constexpr double ridge = 0.002;

/// How far a value may lie outside of those of the particles, over their range: a vertex is half a spacing
/// beyond particles that are spread over two and more.
constexpr double beyond_range = 0.35;

/// Particles that a vertex sees, with their weights.
struct Sample {
  std::vector<std::uint32_t> particle;  ///< number in the input
  std::vector<Vec3> offset;             ///< from the vertex [cells]
  std::vector<double> weight;

  void clear() {
    particle.clear();
    offset.clear();
    weight.clear();
  }
  void make_linear(double ridge_in_cells) {
    double sum = 0;
    Vec3 first = Vec3::Zero();
    double xx = 0, yy = 0, zz = 0, xy = 0, yz = 0, zx = 0;
    for (std::size_t i = 0; i < weight.size(); ++i) {
      const Vec3 &o = offset[i], w = weight[i] * o;
      sum += weight[i];
      first += w;
      xx += w.x() * o.x();
      yy += w.y() * o.y();
      zz += w.z() * o.z();
      xy += w.x() * o.y();
      yz += w.y() * o.z();
      zx += w.z() * o.x();
    }
    if (!(sum > 0)) return;
    const Vec3 mean = first / sum;
    Eigen::Matrix3d covariance;
    covariance << xx, xy, zx, xy, yy, yz, zx, yz, zz;
    covariance = covariance / sum - mean * mean.transpose() + ridge_in_cells * Eigen::Matrix3d::Identity();
    const Vec3 slope = covariance.inverse() * (-mean);
    const double at_mean = 1 - slope.dot(mean);
    for (std::size_t i = 0; i < weight.size(); ++i) weight[i] *= (at_mean + slope.dot(offset[i])) / sum;
  }
  /// The smallest number among the particles with the smallest distance.
  std::uint32_t nearest() const {
    std::uint32_t best = WaterMesh::no_particle;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < particle.size(); ++i) {
      const double squared = offset[i].squaredNorm();
      if (squared > least || (squared == least && particle[i] > best)) continue;
      least = squared;
      best = particle[i];
    }
    return best;
  }
  /// The weighted sum of value(particle); 0 without particles.
  template <class F>
  float of(const F& value) const {
    if (weight.empty()) return 0;
    double result = 0, low = std::numeric_limits<double>::infinity(), high = -low;
    for (std::size_t i = 0; i < weight.size(); ++i) {
      const double v = value(particle[i]);
      result += weight[i] * v;
      low = std::min(low, v);
      high = std::max(high, v);
    }
    const double margin = beyond_range * (high - low);
    return static_cast<float>(std::min(std::max(result, low - margin), high + margin));
  }
};

/// Samples the particles around the vertices of one block, a part of the vertices at a time.
class BlockSampler {
 public:
  BlockSampler(const ParticleBlocks& particles, const FieldParameters& field)
      : particles_(particles), field_(field) {}

  void set(const Grid& grid, const Block& block, const Obstacles& obstacles, bool use_visibility) {
    at_ = block.at;
    // Vertices lie on edges of the block; smoothing may have moved them by a cell.
    in_block_.gather(particles_, {}, block.at, low, high, field_.kernel_radius);
    is_obstructed_ = use_visibility && block.near != none;
    if (!is_obstructed_) return;
    visibility_.set(obstacles, grid.nears[block.near].triangles, grid.origin(block), grid.cell,
                    field_.kernel_radius + 3);
    is_obstructed_ = !visibility_.empty();
    open_.resize(visibility_.words());
  }
  void set(const BlockParts::Part& part) {
    std::array<float, 3> from = part.low, to = part.high;
    for (std::size_t a = 0; a < 3; ++a) {
      from[a] = std::max(from[a], low);
      to[a] = std::min(to[a], high);
    }
    gathered_.select(in_block_, from, to, field_.kernel_radius);
    if (!is_obstructed_) return;
    front_.clear();
    back_.clear();
    for (std::size_t c = 0; c < gathered_.count; ++c) {
      const std::array<float, 3> q = {gathered_.x[c], gathered_.y[c], gathered_.z[c]};
      visibility_.sides(q, own_front_, own_back_);
      front_.insert(front_.end(), own_front_.begin(), own_front_.end());
      back_.insert(back_.end(), own_back_.begin(), own_back_.end());
    }
  }
  /// `x` relative to the block [cells].
  void sample(const std::array<float, 3>& x, Sample& out) {
    out.clear();
    if (is_around_block(x)) {
      collect(x, is_obstructed_, out);
      // A vertex between close sheets may see no particle: then those nearby count.
      if (out.weight.empty()) collect(x, false, out);
    }
    if (out.weight.empty()) take_nearest(x, out);
    const double s = std::cbrt(field_.rest_count) / side;  // cell / dx
    out.make_linear(ridge / (s * s));
  }

 private:
  void collect(const std::array<float, 3>& x, bool visible_only, Sample& out) {
    out.clear();
    const F8 scale = 1 / (field_.kernel_radius * field_.kernel_radius);
    if (visible_only) visibility_.sides(x, own_front_, own_back_);
    last_hit_ = none;
    for (std::size_t c = 0; c < gathered_.padded(); c += 8) {
      const F8 dx = F8::load(&gathered_.x[c]) - x[0], dy = F8::load(&gathered_.y[c]) - x[1],
               dz = F8::load(&gathered_.z[c]) - x[2];
      const F8 u = F8(1.0f) - (dx * dx + dy * dy + dz * dz) * scale;
      std::uint32_t bits = greater_mask(u, 0.0f);
      if (bits == 0) continue;
      float weight[8];
      u.store(weight);
      for (; bits != 0; bits &= bits - 1) {
        const auto lane = std::size_t(__builtin_ctz(bits));
        add(c + lane, x, weight[lane], visible_only, out);
      }
    }
  }
  /// Adds a particle in reach, if the vertex sees it.
  void add(std::size_t c, const std::array<float, 3>& x, float u, bool visible_only, Sample& out) {
    const std::array<float, 3> q = {gathered_.x[c], gathered_.y[c], gathered_.z[c]};
    if (visible_only) {
      const std::size_t at = c * visibility_.words();
      if (visibility_.may_hide(own_front_.data(), own_back_.data(), &front_[at], &back_[at],
                               {std::min(q[0], x[0]), std::min(q[1], x[1]), std::min(q[2], x[2])},
                               {std::max(q[0], x[0]), std::max(q[1], x[1]), std::max(q[2], x[2])},
                               open_.data()) &&
          visibility_.hides(x, q, open_.data(), last_hit_))
        return;
    }
    out.particle.push_back(particles_.source[gathered_.particle[c]]);
    out.offset.emplace_back(q[0] - x[0], q[1] - x[1], q[2] - x[2]);
    out.weight.push_back(double(u) * u * u);
  }

  /// Within a cell of the block, where all particles in reach have been gathered.
  static constexpr float low = -1, high = side + 1;
  static bool is_around_block(const std::array<float, 3>& x) {
    return std::all_of(x.begin(), x.end(), [](float v) { return v >= low && v <= high; });
  }
  /// A vertex that the fit has moved far from its block, or out of the kernel radius of all particles.
  void take_nearest(const std::array<float, 3>& x, Sample& out) {
    constexpr float farthest = 1 << 12;  // no vertex is
    const auto blocks = [&](std::size_t axis) { return static_cast<int>(std::floor(x[axis] / side)); };
    const Int3 to{blocks(0), blocks(1), blocks(2)};
    const Eigen::Vector3f here(x[0] - float(side * to.x), x[1] - float(side * to.y),
                               x[2] - float(side * to.z));
    float least = std::numeric_limits<float>::infinity();
    // Those within `gathered` have been seen.
    for (float gathered = 0, reach = field_.kernel_radius; least > gathered * gathered && reach < farthest;
         gathered = reach, reach *= 2) {
      far_.gather(particles_, {}, at_ + to, 0, side, reach);
      for (std::size_t c = 0; c < far_.count; ++c) {
        const Eigen::Vector3f offset = Eigen::Vector3f(far_.x[c], far_.y[c], far_.z[c]) - here;
        const std::uint32_t particle = particles_.source[far_.particle[c]];
        const float squared = offset.squaredNorm();
        if (squared > least || (squared == least && particle > out.particle[0])) continue;
        least = squared;
        out.particle.assign(1, particle);
        out.offset.assign(1, offset.cast<double>());
        out.weight.assign(1, 1.0);
      }
    }
  }

  const ParticleBlocks& particles_;
  const FieldParameters& field_;
  Int3 at_;  // the block
  NearParticles in_block_, gathered_, far_;
  bool is_obstructed_ = false;
  BlockVisibility visibility_;
  Words front_, back_, own_front_, own_back_, open_;
  std::uint32_t last_hit_ = none;
};

}  // namespace

void vertex_normals(const RawMesh& mesh, const SurfaceBlocks& blocks, const Workers& workers,
                    std::vector<std::array<float, 3>>& normals) {
  normals.assign(mesh.positions.size(), {0, 0, 0});
  blocks.for_each(workers, [&](std::uint32_t block) {
    for (std::uint32_t n = mesh.first_triangle[block]; n < mesh.first_triangle[block + 1]; ++n) {
      const Triangle& t = mesh.triangles[n];
      const auto &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
      const float u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]},
                  v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
      const float cross[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2],
                              u[0] * v[1] - u[1] * v[0]};
      for (std::uint32_t corner : t)
        for (std::size_t k = 0; k < 3; ++k) normals[corner][k] += cross[k];
    }
  });
  workers.for_each(normals.size(), 1 << 12, [&](std::size_t v) {
    std::array<float, 3>& n = normals[v];
    const double length = std::sqrt(double(n[0]) * n[0] + double(n[1]) * n[1] + double(n[2]) * n[2]);
    if (length > 0)
      for (float& x : n) x = static_cast<float>(x / length);
    else
      n = {0, 0, 1};
  });
}

void interpolate(const ReconstructionInput& input, const ParticleBlocks& particles,
                 const FieldParameters& field, const Obstacles& obstacles, bool use_visibility,
                 bool wants_nearest, const Grid& grid, const RawMesh& raw, WaterMesh& mesh,
                 const Workers& workers) {
  const std::size_t n = raw.positions.size();
  OILSKIN_ASSERT(raw.first_vertex.size() == grid.blocks.size() + 1 && raw.first_vertex.back() == n);
  mesh.velocities.resize(input.velocities.empty() ? 0 : n);
  mesh.attributes.resize(input.attributes.size());
  for (std::size_t a = 0; a < input.attributes.size(); ++a) {
    mesh.attributes[a].components = input.attributes[a].components;
    mesh.attributes[a].values.resize(n * std::size_t(input.attributes[a].components));
  }
  mesh.nearest.resize(wants_nearest ? n : 0);
  if (mesh.velocities.empty() && mesh.attributes.empty() && !wants_nearest) return;
  const auto store = [&](std::uint32_t v, const Sample& sample) {
    if (wants_nearest) mesh.nearest[v] = sample.nearest();
    if (!mesh.velocities.empty())
      for (int k = 0; k < 3; ++k)
        mesh.velocities[v][std::size_t(k)] =
            sample.of([&](std::uint32_t i) { return input.velocities[i][k]; });
    for (std::size_t a = 0; a < input.attributes.size(); ++a) {
      const std::size_t m = std::size_t(input.attributes[a].components);
      for (std::size_t k = 0; k < m; ++k)
        mesh.attributes[a].values[v * m + k] =
            sample.of([&](std::uint32_t i) { return double(input.attributes[a].values[i * m + k]); });
    }
  };
  workers.for_chunks(grid.blocks.size(), 8, [&](std::size_t from, std::size_t to, std::size_t) {
    BlockSampler sampler(particles, field);
    Sample sample;
    BlockParts parts;
    for (std::size_t b = from; b < to; ++b) {
      const std::uint32_t begin = raw.first_vertex[b], end = raw.first_vertex[b + 1];
      if (begin == end) continue;
      sampler.set(grid, grid.blocks[b], obstacles, use_visibility);
      const Vec3 origin = grid.origin(grid.blocks[b]);
      parts.clear();
      for (std::uint32_t v = begin; v < end; ++v) parts.add(v, (vec(raw.positions[v]) - origin) / grid.cell);
      parts.for_each([&](const BlockParts::Part& part) {
        sampler.set(part);
        for (std::size_t i = 0; i < part.numbers.size(); ++i) {
          sampler.sample(part.places[i], sample);
          store(part.numbers[i], sample);
        }
      });
    }
  });
}

}  // namespace oilskin::reconstruction
