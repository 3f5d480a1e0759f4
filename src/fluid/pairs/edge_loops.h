/// The kernel `edges` for any type of lanes; see pair_loops.h.
#pragma once

#include "fluid/kernels.h"
#include "fluid/pairs/wall_kernels.h"

namespace oilskin::fluid {

/// ∫ [Λ(ζ) − ζ Λ(r)/r] dϕ along edges (docs/theory/boundary.md, B.9). The line of an edge passes the foot at
/// the distance d; along it t runs from a to b. With dϕ = d dt/(d² + t²) the integrand is smooth in t. Beyond
/// r = 1 it is constant, and the integral is an angle.
template <class Lanes>
struct EdgeLoops {
  using F8 = typename Lanes::F8;
  using D4 = typename Lanes::D4;

  static constexpr std::size_t batch_size = 64;

  /// Of a batch of edges: d with a sign, and the part [low, high] of [a, b] within r < 1.
  struct Lines {
    alignas(32) float d[batch_size], a[batch_size], b[batch_size], low[batch_size], high[batch_size];
  };

  /// Angles to compute, of (x, y) from the first axis; y ≥ 0.
  struct Angles {
    // Space for one more than there are
    alignas(32) double x[2 * batch_size + 4], y[2 * batch_size + 4];
    alignas(32) double angle[2 * batch_size + 4];
    std::uint8_t edge[2 * batch_size + 4];
    std::size_t count = 0;
    /// Between (d, from) and (d, to), from ≤ to, d > 0, as seen from the origin.
    void add_if(bool wanted, std::size_t of_edge, float d, float from, float to) {
      edge[count] = static_cast<std::uint8_t>(of_edge);
      x[count] = static_cast<double>(d * d + from * to);
      y[count] = static_cast<double>(d * (to - from));
      count += wanted;
    }
  };

  /// Integrals to compute, in columns.
  struct Integrals {
    static constexpr std::size_t size = batch_size + 8;
    alignas(32) float z[size], mass[size], d[size], middle[size], half[size];
    alignas(32) float value[size];
    std::uint8_t edge[size];
    std::size_t count = 0;
    void add_if(bool wanted, std::size_t of_edge, float of_z, float of_mass, float of_d, float low,
                float high) {
      edge[count] = static_cast<std::uint8_t>(of_edge);
      z[count] = of_z;
      mass[count] = of_mass;
      d[count] = of_d;
      middle[count] = 0.5f * (low + high);
      half[count] = 0.5f * (high - low);
      count += wanted;
    }
  };

  struct Work {
    Lines lines;
    Angles angles;
    Integrals few, many;  // nodes
    alignas(32) float outside[batch_size], inside[batch_size];
  };

  static void edges(const EdgeBlock* block, std::size_t count, float* out) {
    Work work;
    while (count > 0) {
      const std::size_t n = count < batch_size ? count : batch_size;
      work.angles.count = work.few.count = work.many.count = 0;
      for (std::size_t k = 0; k < n; k += 8) find_lines(block[k / 8], k, work.lines);
      for (std::size_t k = 0; k < n; ++k) sort(block[k / 8], k, work);
      find_angles(work.angles);
      integrate<4>(work.few);
      integrate<8>(work.many);
      collect(work);
      for (std::size_t k = 0; k < n; k += 8) join(block[k / 8], k, n, work, out);
      block += batch_size / 8;
      out += n;
      count -= n;
    }
  }

  static F8 dot(const F8& ax, const F8& ay, const F8& az, const F8& bx, const F8& by, const F8& bz) {
    return ax * bx + (ay * by + az * bz);
  }

  static void find_lines(const EdgeBlock& e, std::size_t first, Lines& lines) {
    const F8 ux = F8::load(e.from[0]), uy = F8::load(e.from[1]), uz = F8::load(e.from[2]);
    const F8 vx = F8::load(e.to[0]), vy = F8::load(e.to[1]), vz = F8::load(e.to[2]);
    const F8 nx = F8::load(e.normal[0]), ny = F8::load(e.normal[1]), nz = F8::load(e.normal[2]);
    F8 x = vx - ux, y = vy - uy, z = vz - uz;
    const F8 square = dot(x, y, z, x, y, z), length = choose_positive(square, root(square), F8(1.0f));
    x = x / length;
    y = y / length;
    z = z / length;
    const F8 d = F8(0.0f) - dot(ux, uy, uz, ny * z - nz * y, nz * x - nx * z, nx * y - ny * x);
    const F8 a = dot(ux, uy, uz, x, y, z), b = dot(vx, vy, vz, x, y, z), height = F8::load(e.distance);
    const F8 reach = root(larger(F8(1.0f) - height * height - d * d, F8(0.0f))), lowest = F8(0.0f) - reach;
    d.store(lines.d + first);
    a.store(lines.a + first);
    b.store(lines.b + first);
    smaller(larger(a, lowest), reach).store(lines.low + first);
    smaller(larger(b, lowest), reach).store(lines.high + first);
  }

  /// What is to be computed of edge k. Without branches, which nothing could predict.
  static void sort(const EdgeBlock& block, std::size_t k, Work& work) {
    const Lines& lines = work.lines;
    const float d = lines.d[k] < 0 ? -lines.d[k] : lines.d[k], z = block.distance[k % 8];
    const float a = lines.a[k], b = lines.b[k], low = lines.low[k], high = lines.high[k];
    const bool crosses = high > low, starts_outside = !crosses | (a < low);
    work.angles.add_if(starts_outside, k, d, a, crosses ? low : b);
    work.angles.add_if(crosses & (b > high), k, d, high, b);
    // The integrand varies over a length of √(d² + ζ²): 4 nodes are enough on an edge that is short beside
    // it.
    const float half = 0.5f * (high - low);
    const bool is_short = half * half < 0.25f * (d * d + z * z);
    work.few.add_if(crosses & is_short, k, z, block.mass[k % 8], d, low, high);
    work.many.add_if(crosses & !is_short, k, z, block.mass[k % 8], d, low, high);
  }

  /// Not std::atan2, whose last bits depend on the C library: this has the same bits everywhere. The angle is
  /// halved twice, so that the series converges by 0.17 a term.
  static D4 angle_of(const D4& x, const D4& y) {
    const D4 length = root(x * x + y * y), size = choose(D4(0.0) > x, D4(0.0) - x, x);
    const D4 sum = length + size;
    // Tangent of half the angle from ±x, 0 … 1. Without a direction 0, not 0/0, which a host may trap.
    const D4 half = y / choose(sum > D4(0.0), sum, D4(1.0));
    const D4 t = half / (D4(1.0) + root(D4(1.0) + half * half)), t2 = t * t;
    D4 series(0.0);
    for (int k = 21; k >= 1; k -= 2) series = D4(1.0 / k) - t2 * series;
    const D4 angle = D4(4.0) * t * series;
    return choose(D4(0.0) > x, D4(pi) - angle, angle);
  }

  static void find_angles(Angles& all) {
    for (std::size_t k = all.count; k % 4 != 0; ++k) all.x[k] = all.y[k] = 1;
    for (std::size_t k = 0; k < all.count; k += 4)
      angle_of(D4::load(all.x + k), D4::load(all.y + k)).store(all.angle + k);
  }

  /// Λ (B.1).
  static F8 half_space_mass(const F8& z) {
    const F8 u = larger(F8(1.0f) - z, F8(0.0f)), v = larger(F8(0.5f) - z, F8(0.0f));
    const F8 u2 = u * u, v2 = v * v;
    return F8(8.0f / 15) *
           (u2 * u2 * u * (F8(1.0f) + F8(2.0f) * z) - v2 * v2 * v * (F8(2.0f) + F8(8.0f) * z));
  }

  /// Gauss–Legendre on [−1, 1].
  template <int nodes>
  static void integrate(Integrals& all) {
    constexpr float abscissa[] = {-0.861136312f, -0.339981044f, 0.339981044f,  0.861136312f,
                                  -0.960289856f, -0.796666477f, -0.525532410f, -0.183434642f,
                                  0.183434642f,  0.525532410f,  0.796666477f,  0.960289856f};
    constexpr float weight[] = {0.347854845f, 0.652145155f, 0.652145155f, 0.347854845f,
                                0.101228536f, 0.222381034f, 0.313706646f, 0.362683783f,
                                0.362683783f, 0.313706646f, 0.222381034f, 0.101228536f};
    constexpr int first = nodes == 4 ? 0 : 4;
    for (std::size_t k = all.count; k % 8 != 0; ++k)
      all.z[k] = all.mass[k] = all.d[k] = all.middle[k] = all.half[k] = 1;
    for (std::size_t k = 0; k < all.count; k += 8) {
      const F8 z = F8::load(all.z + k), mass = F8::load(all.mass + k), d = F8::load(all.d + k);
      const F8 middle = F8::load(all.middle + k), half = F8::load(all.half + k);
      F8 sum[4];
      for (int n = 0; n < nodes; ++n) {
        const F8 t = middle + half * F8(abscissa[first + n]), square = t * t + d * d;
        const F8 r = root(z * z + square);
        sum[n % 4] += F8(weight[first + n]) * (mass * r - z * half_space_mass(r)) / (square * r);
      }
      (half * d * ((sum[0] + sum[2]) + (sum[1] + sum[3]))).store(all.value + k);
    }
  }

  static void collect(Work& work) {
    for (std::size_t k = 0; k < batch_size; ++k) work.outside[k] = work.inside[k] = 0;
    for (std::size_t k = 0; k < work.angles.count; ++k)
      work.outside[work.angles.edge[k]] += static_cast<float>(work.angles.angle[k]);
    for (const Integrals* of : {&work.few, &work.many})
      for (std::size_t k = 0; k < of->count; ++k) work.inside[of->edge[k]] = of->value[k];
  }

  static void join(const EdgeBlock& block, std::size_t first, std::size_t n, const Work& work, float* out) {
    const F8 zero(0.0f), d = F8::load(work.lines.d + first);
    const F8 edge = F8::load(work.outside + first) * F8::load(block.mass) + F8::load(work.inside + first);
    // d > 0: the foot lies on the inner side of the edge.
    const F8 sum = choose_positive(d, edge, choose_positive(zero - d, zero - edge, zero));
    float all[8];
    sum.store(all);
    for (std::size_t k = 0; k < 8 && first + k < n; ++k) out[first + k] = all[k];
  }
};

}  // namespace oilskin::fluid
