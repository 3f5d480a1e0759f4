/// Particles near obstacles around one block, for searches eight at a time.
#pragma once

#include "core/simd.h"
#include "reconstruction/film.h"
#include "reconstruction/film_kernel.h"

namespace oilskin::reconstruction {

/// Lengths in cells, places relative to the block.
class NearFilm {
 public:
  /// Those of `near` that are near an obstacle, in the same order.
  void set(const Film& film, const NearParticles& near);

  Vec3 place(std::size_t c) const { return {x_[c], y_[c], z_[c]}; }
  const FilmParticle& item(std::size_t c) const { return *items_[c]; }
  std::uint32_t particle(std::size_t c) const { return particles_[c]; }

  /// Calls f(c, rho²) for the particles on the same film as `own`, which is at x: with normals within 60°, at
  /// a distance along its plane of at most `reach`, and as high over the obstacle as over its plane.
  template <class F>
  void for_same_film(const FilmRule& rule, const FilmParticle& own, const Vec3& x, double reach,
                     const F& f) const {
    const auto most = static_cast<float>(reach * reach);
    for (std::size_t c = 0; c < x_.size(); c += 8) {
      const Offset o(*this, c, x);
      const F8 along = o.along(own.normal), rho2 = positive_part(o.squared() - along * along);
      std::uint32_t mask = ~greater_mask(rho2, most);
      if ((mask & 0xff) == 0) continue;
      mask &= ~(greater_mask(0.5f, alike(c, own.normal)) |
                greater_mask(size(along + own.height - F8::load(&height_[c])), slack(rule, rho2)));
      float at[8];
      rho2.store(at);
      for_bits(c, mask, [&](std::size_t lane) { f(c + lane, double(at[lane])); });
    }
  }
  /// Calls f(c) for the particles with normals more than 60° from this one, at a distance from x along the
  /// plane with this normal of at most `reach`.
  template <class F>
  void for_beside(const std::array<float, 3>& normal, const Vec3& x, double reach, const F& f) const {
    const auto most = static_cast<float>(reach * reach);
    for (std::size_t c = 0; c < x_.size(); c += 8) {
      const std::uint32_t beside = greater_mask(0.5f, alike(c, normal));
      if (beside == 0) continue;
      const Offset o(*this, c, x);
      const F8 along = o.along(normal);
      for_bits(c, beside & ~greater_mask(o.squared() - along * along, most),
               [&](std::size_t lane) { f(c + lane); });
    }
  }
  /// Calls f(c, rho², height of x over the plane) for the particles of films, whose distance from x along
  /// their own plane is less than the link, and over whose plane x is as high as `height`.
  template <class F>
  void for_over(const FilmRule& rule, const Vec3& x, double height, const F& f) const {
    const auto most = static_cast<float>(rule.link * rule.link), expected = static_cast<float>(height);
    for (std::size_t c = 0; c < x_.size(); c += 8) {
      const Offset o(*this, c, x);
      const F8 along = o.x * F8::load(&nx_[c]) + o.y * F8::load(&ny_[c]) + o.z * F8::load(&nz_[c]),
               rho2 = positive_part(o.squared() - along * along);
      std::uint32_t mask = greater_mask(most, rho2);
      if (mask == 0) continue;
      const F8 above = F8::load(&height_[c]) - along;  // the offset is that of the particle
      mask &= ~greater_mask(size(above - expected), slack(rule, rho2));
      float at[8], heights[8];
      rho2.store(at);
      above.store(heights);
      for_bits(c, mask, [&](std::size_t lane) { f(c + lane, double(at[lane]), double(heights[lane])); });
    }
  }

 private:
  using F8 = simd::F8;
  /// Of eight particles from a place.
  struct Offset {
    F8 x, y, z;
    Offset(const NearFilm& n, std::size_t c, const Vec3& from)
        : x(F8::load(&n.x_[c]) - float(from.x())),
          y(F8::load(&n.y_[c]) - float(from.y())),
          z(F8::load(&n.z_[c]) - float(from.z())) {}
    F8 squared() const { return x * x + y * y + z * z; }
    F8 along(const std::array<float, 3>& n) const { return x * n[0] + y * n[1] + z * n[2]; }
  };
  static F8 size(const F8& a) { return larger(a, 0.0f - a); }
  static F8 slack(const FilmRule& rule, const F8& rho2) {
    return root(rho2) * static_cast<float>(slope_slack) + static_cast<float>(height_slack * rule.spacing);
  }
  /// Cosines of the angles between normals.
  F8 alike(std::size_t c, const std::array<float, 3>& n) const {
    return F8::load(&nx_[c]) * n[0] + F8::load(&ny_[c]) * n[1] + F8::load(&nz_[c]) * n[2];
  }
  /// Calls f(lane) for the bits. The padding never counts: differences of its squares say nothing.
  template <class F>
  void for_bits(std::size_t c, std::uint32_t mask, const F& f) const {
    const std::uint32_t there = items_.size() - c < 8 ? (1u << (items_.size() - c)) - 1 : 0xff;
    for (std::uint32_t bits = mask & there; bits != 0; bits &= bits - 1) f(std::size_t(__builtin_ctz(bits)));
  }

  // Padded to a multiple of 8
  std::vector<float> x_, y_, z_, nx_, ny_, nz_, height_;
  std::vector<const FilmParticle*> items_;
  std::vector<std::uint32_t> particles_;
};

}  // namespace oilskin::reconstruction
