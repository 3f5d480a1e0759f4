/// The loops with corrected gradients for any type of eight lanes; see pair_loops.h.
#pragma once

#include "fluid/pairs/pair_loops.h"

namespace oilskin::fluid {

template <class Lanes>
struct GradientLoops {
  using F8 = typename Lanes::F8;
  using Sum8 = typename Lanes::Sum8;
  using Record8 = typename Lanes::Record8;
  using Base = PairLoops<Lanes>;
  using Pairs = typename Base::Pairs;
  using List = typename Base::List;
  template <class Sum>
  using Sum3 = typename Base::template Sum3<Sum>;

  /// Of one particle, or of eight neighbours.
  struct Tensor8 {
    F8 xx, yy, zz, xy, xz, yz;

    Tensor8(const Tensors& k, std::size_t i)
        : xx(k.diagonal[i].x),
          yy(k.diagonal[i].y),
          zz(k.diagonal[i].z),
          xy(k.rest[i].x),
          xz(k.rest[i].y),
          yz(k.rest[i].z) {}
    Tensor8(const Tensors& k, const std::uint32_t* j) : Tensor8(Record8(k.diagonal, j), Record8(k.rest, j)) {}

    /// slope K Δ. Both sides of a pair get the same number with opposite signs, bit for bit.
    Sum3<F8> slope_times(F8 slope, const Pairs& d) const {
      return {slope * (xx * d.dx + xy * d.dy + xz * d.dz), slope * (xy * d.dx + yy * d.dy + yz * d.dz),
              slope * (xz * d.dx + yz * d.dy + zz * d.dz)};
    }

   private:
    Tensor8(const Record8& d, const Record8& r) : xx(d.x), yy(d.y), zz(d.z), xy(r.x), xz(r.y), yz(r.z) {}
  };

  static void pressure(const PairTable& t, const Record* x, const Tensors& k, PairRange range, Record* out) {
    Base::by_pairs(t, [&](const auto& masses, const auto& slopes) {
      for (std::size_t i = range.begin; i < range.end; ++i) {
        Sum3<F8> sum;
        for (List n(t, i); n; ++n) {
          const Record8 other(x, n.j);
          const Pairs pairs(x[i], other);
          const Sum3<F8> g = Tensor8(k, n.j).slope_times(slopes.of(n, pairs) * other.w, pairs);
          masses.add(sum.x, g.x, n.j);
          masses.add(sum.y, g.y, n.j);
          masses.add(sum.z, g.z, n.j);
        }
        *out++ = {total(sum.x), total(sum.y), total(sum.z), 0};
      }
    });
  }

  static void pressure_exact(const PairTable& t, const Record* x, const Tensors& k, PairRange range,
                             Change* out) {
    Base::by_pairs(t, [&](const auto& masses, const auto& slopes) {
      for (std::size_t i = range.begin; i < range.end; ++i) {
        Sum3<Sum8> sum;
        const Tensor8 tensor(k, i);
        const F8 own(x[i].w);
        for (List n(t, i); n; ++n) {
          const Record8 other(x, n.j);
          const Pairs pairs(x[i], other);
          const F8 slope = slopes.of(n, pairs);
          const Sum3<F8> of_own = tensor.slope_times(slope, pairs);
          const Sum3<F8> of_other = Tensor8(k, n.j).slope_times(slope, pairs);
          masses.add(sum.x, own * of_own.x + other.w * of_other.x, n.j);
          masses.add(sum.y, own * of_own.y + other.w * of_other.y, n.j);
          masses.add(sum.z, own * of_own.z + other.w * of_other.z, n.j);
        }
        *out++ = {sum.x.total(), sum.y.total(), sum.z.total()};
      }
    });
  }

  static void compression(const PairTable& t, const Record* x, const Tensors& k, const Record* y,
                          PairRange range, float* out) {
    Base::by_pairs(t, [&](const auto& masses, const auto& slopes) {
      for (std::size_t i = range.begin; i < range.end; ++i) {
        F8 sum;
        const Tensor8 tensor(k, i);
        for (List n(t, i); n; ++n) {
          const Pairs pairs(x[i], Record8(x, n.j));
          const Record8 u(y, n.j);
          const Sum3<F8> g = tensor.slope_times(slopes.of(n, pairs), pairs);
          masses.add(sum, (F8(y[i].x) - u.x) * g.x + (F8(y[i].y) - u.y) * g.y + (F8(y[i].z) - u.z) * g.z,
                     n.j);
        }
        *out++ = total(sum);
      }
    });
  }

  static constexpr GradientKernels kernels() { return {pressure, pressure_exact, compression}; }
};

}  // namespace oilskin::fluid
