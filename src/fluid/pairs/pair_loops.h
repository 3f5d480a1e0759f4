/// The kernels for any type of eight lanes. `Lanes` names a type F8 and what belongs to it. Every function is
/// a template of it, so that versions compiled for different machines have different names.
#pragma once

#include "fluid/kernels.h"
#include "fluid/pairs/pair_kernels.h"

namespace oilskin::fluid {

template <class Lanes>
struct PairLoops {
  using F8 = typename Lanes::F8;
  using Sum8 = typename Lanes::Sum8;
  using Record8 = typename Lanes::Record8;

  /// Eight pairs of particle i.
  struct Pairs {
    F8 dx, dy, dz, q2;
    Pairs(const Record& i, const Record8& j)
        : dx(F8(i.x) - j.x), dy(F8(i.y) - j.y), dz(F8(i.z) - j.z), q2(dx * dx + dy * dy + dz * dz) {}
  };

  /// The neighbours of one particle, eight at a time.
  struct List {
    const std::uint32_t* j;
    std::uint32_t blocks;
    List(const PairTable& t, std::size_t i) : j(t.lists + t.list_begin[i]), blocks((t.count[i] + 7) / 8) {}
    explicit operator bool() const { return blocks > 0; }
    void operator++() {
      --blocks;
      j += 8;
    }
  };

  /// w'/q of the pairs: loaded where they are stored, else computed, with the same bits.
  template <bool stored>
  struct Slopes {
    const std::uint32_t* lists;
    const float* slopes;
    F8 of(const List& n, const Pairs& pairs) const {
      if constexpr (stored) return F8::load(slopes + (n.j - lists));
      return CubicSpline::dw_over_q(root(pairs.q2));
    }
  };

  /// Factors m_j, where masses differ.
  template <bool weighted>
  struct Masses {
    const float* ratio;
    F8 times(F8 a, const std::uint32_t* j) const {
      if constexpr (weighted) return a * F8::gather(ratio, j);
      return a;
    }
    void add(F8& sum, F8 a, const std::uint32_t* j) const { sum += times(a, j); }
    /// The product is exact: m_i times what j does to i is minus m_j times the reverse.
    void add(Sum8& sum, F8 a, const std::uint32_t* j) const {
      if constexpr (weighted)
        sum.add_product(a, F8::gather(ratio, j));
      else
        sum += a;
    }
    float own(std::size_t i) const { return weighted ? ratio[i] : 1; }
  };

  struct RateSums {
    F8 gx, gy, gz, squares, compression;
    F8 xx, yy, zz, xy, xz, yz;
    void add(const Pairs& pairs, F8 slope, F8 weighted, F8 dv_dot_delta) {
      const F8 x = weighted * pairs.dx, y = weighted * pairs.dy, z = weighted * pairs.dz;
      gx += x;
      gy += y;
      gz += z;
      squares += weighted * slope * pairs.q2;
      compression += weighted * dv_dot_delta;
      xx += x * pairs.dx;
      yy += y * pairs.dy;
      zz += z * pairs.dz;
      xy += x * pairs.dy;
      xz += x * pairs.dz;
      yz += y * pairs.dz;
    }
    PairRates sum() const {
      return {{total(gx), total(gy), total(gz), total(squares)},
              total(compression),
              {total(xx), total(yy), total(zz), total(xy), total(xz), total(yz)}};
    }
  };

  /// f(masses): one branch for a loop over many particles.
  template <class F>
  static void by_masses(const PairTable& t, const F& f) {
    if (t.mass_ratio)
      f(Masses<true>{t.mass_ratio});
    else
      f(Masses<false>{nullptr});
  }

  /// f(masses, slopes).
  template <class F>
  static void by_pairs(const PairTable& t, const F& f) {
    by_masses(t, [&](const auto& masses) {
      if (t.slopes)
        f(masses, Slopes<true>{t.lists, t.slopes});
      else
        f(masses, Slopes<false>{nullptr, nullptr});
    });
  }

  template <bool with_friction, bool with_rates, class M>
  static void start_of(const PairTable& t, const Record* x, const Record* v, const PairFriction& friction,
                       const M& masses, std::size_t i, std::size_t k, const StartSums& out) {
    const F8 by_slope(friction.by_slope), by_hat(friction.by_hat);
    const F8 by_laplacian(6 * friction.by_laplacian), smoothing(friction.smoothing);
    const F8 by_strain(friction.by_strain), most_by_strain(friction.most_by_strain);
    F8 density, least(1.0f);
    Sum8 sx, sy, sz;
    RateSums rates;
    for (List n(t, i); n; ++n) {
      const Pairs pairs(x[i], Record8(x, n.j));
      const F8 q = root(pairs.q2), w = CubicSpline::w(q), g = CubicSpline::dw_over_q(q);
      if (t.slopes) g.store(t.slopes + (n.j - t.lists));
      masses.add(density, w, n.j);
      least = smaller(least, pairs.q2);
      if constexpr (with_friction) {
        const Record8 u(v, n.j);
        const F8 vx = F8(v[i].x) - u.x, vy = F8(v[i].y) - u.y, vz = F8(v[i].z) - u.z;
        const F8 dv_dot_delta = vx * pairs.dx + vy * pairs.dy + vz * pairs.dz;
        if constexpr (with_rates) rates.add(pairs, g, masses.times(g, n.j), dv_dot_delta);
        const F8 hat = larger(F8(1.0f) - q, F8(0.0f));
        const F8 r2 = pairs.q2 + F8(0.01f);
        const F8 over_r2 = dv_dot_delta / r2;
        const F8 along = by_slope * g * over_r2 - by_hat * hat * hat * dv_dot_delta;
        const F8 approach = larger(over_r2, F8(0.0f) - over_r2) * root(r2);
        const F8 against =
            by_laplacian * hat + (smoothing + smaller(by_strain * approach, most_by_strain)) * w;
        masses.add(sx, along * pairs.dx - against * vx, n.j);
        masses.add(sy, along * pairs.dy - against * vy, n.j);
        masses.add(sz, along * pairs.dz - against * vz, n.j);
      }
    }
    out.density[k] = total(density);
    if (out.is_close) out.is_close[k] = greater_mask(F8(out.close_square), least) != 0;
    if constexpr (with_friction) out.friction[k] = {sx.total(), sy.total(), sz.total()};
    if constexpr (with_rates) {
      out.rates[k] = rates.sum();
      out.rates[k].gradient.w *= masses.own(i);
    }
  }

  static void start(const PairTable& t, const Record* x, const Record* v, const PairFriction& friction,
                    PairRange range, const StartSums& out) {
    by_masses(t, [&](const auto& masses) {
      for (std::size_t i = range.begin, k = 0; i < range.end; ++i, ++k)
        if (out.rates)
          start_of<true, true>(t, x, v, friction, masses, i, k, out);
        else if (out.friction)
          start_of<true, false>(t, x, v, friction, masses, i, k, out);
        else
          start_of<false, false>(t, x, v, friction, masses, i, k, out);
    });
  }

  static void density(const PairTable& t, const Record* x, PairRange range, float* out) {
    by_masses(t, [&](const auto& masses) {
      for (std::size_t i = range.begin; i < range.end; ++i) {
        F8 sum;
        for (List n(t, i); n; ++n)
          masses.add(sum, CubicSpline::w(root(Pairs(x[i], Record8(x, n.j)).q2)), n.j);
        *out++ = total(sum);
      }
    });
  }

  template <class Sum>
  struct Sum3 {
    Sum x, y, z;
  };
  template <class Sum, class M, class S>
  static Sum3<Sum> pressure_of(const PairTable& t, const Record* x, const M& masses, const S& slopes,
                               std::size_t i) {
    Sum3<Sum> sum;
    const F8 own(x[i].w);
    for (List n(t, i); n; ++n) {
      const Record8 other(x, n.j);
      const Pairs pairs(x[i], other);
      const F8 f = (own + other.w) * slopes.of(n, pairs);
      masses.add(sum.x, f * pairs.dx, n.j);
      masses.add(sum.y, f * pairs.dy, n.j);
      masses.add(sum.z, f * pairs.dz, n.j);
    }
    return sum;
  }

  static void pressure(const PairTable& t, const Record* x, PairRange range, Record* out) {
    by_pairs(t, [&](const auto& masses, const auto& slopes) {
      for (std::size_t i = range.begin; i < range.end; ++i) {
        const Sum3<F8> s = pressure_of<F8>(t, x, masses, slopes, i);
        *out++ = {total(s.x), total(s.y), total(s.z), 0};
      }
    });
  }

  static void pressure_exact(const PairTable& t, const Record* x, PairRange range, Change* out) {
    by_pairs(t, [&](const auto& masses, const auto& slopes) {
      for (std::size_t i = range.begin; i < range.end; ++i) {
        const Sum3<Sum8> s = pressure_of<Sum8>(t, x, masses, slopes, i);
        *out++ = {s.x.total(), s.y.total(), s.z.total()};
      }
    });
  }

  static void compression(const PairTable& t, const Record* x, const Record* y, PairRange range, float* out) {
    by_pairs(t, [&](const auto& masses, const auto& slopes) {
      for (std::size_t i = range.begin; i < range.end; ++i) {
        F8 sum;
        for (List n(t, i); n; ++n) {
          const Pairs pairs(x[i], Record8(x, n.j));
          const Record8 u(y, n.j);
          const F8 rate =
              (F8(y[i].x) - u.x) * pairs.dx + (F8(y[i].y) - u.y) * pairs.dy + (F8(y[i].z) - u.z) * pairs.dz;
          masses.add(sum, rate * slopes.of(n, pairs), n.j);
        }
        *out++ = total(sum);
      }
    });
  }

  static void columns(const Record* records, PairRange range, float* x, float* y, float* z) {
    for (std::size_t j = range.begin; j < range.end; j += 8, x += 8, y += 8, z += 8) {
      const Record8 r(records + j);
      r.x.store(x);
      r.y.store(y);
      r.z.store(z);
    }
  }

  static std::size_t near(const Candidates& c, const Record& p, std::uint32_t* out) {
    const F8 px(p.x), py(p.y), pz(p.z), one(1.0f);
    std::size_t found = 0;
    for (std::size_t k = 0; k < c.count; k += 8) {
      const F8 dx = F8::load(c.x + k) - px, dy = F8::load(c.y + k) - py, dz = F8::load(c.z + k) - pz;
      found += Lanes::select(greater_mask(one, dx * dx + dy * dy + dz * dz), c.particle + k, out + found);
    }
    return found;
  }
};

}  // namespace oilskin::fluid
