/// Particles near obstacles around one block, for searches eight at a time.
#pragma once

#include "core/simd.h"
#include "reconstruction/film.h"

namespace oilskin::reconstruction {

/// Lengths in cells, places relative to the block. The searches may name a particle too many by rounding, so
/// what needs the limit tests it again.
class NearFilm {
 public:
  /// Those of `near` that are near an obstacle, in the same order.
  void set(const Film& film, const NearParticles& near);

  Vec3 place(std::size_t c) const { return {x_[c], y_[c], z_[c]}; }
  const FilmParticle& item(std::size_t c) const { return *items_[c]; }
  std::uint32_t particle(std::size_t c) const { return particles_[c]; }

  /// Calls f(c) for the particles whose distance from x along the plane with this normal is at most `reach`.
  template <class F>
  void for_along(const std::array<float, 3>& normal, const Vec3& x, double reach, const F& f) const {
    const auto most = static_cast<float>(reach * reach * rounding);
    for (std::size_t c = 0; c < x_.size(); c += 8) {
      const Offset o(*this, c, x);
      const F8 height = o.x * normal[0] + o.y * normal[1] + o.z * normal[2];
      call(c, ~greater_mask(o.squared() - height * height, most), f);
    }
  }
  /// Calls f(c) for the particles whose distance from x along their own plane is at most `reach`, and over
  /// whose plane the height of x is within `slack` of `height`.
  template <class F>
  void for_over(const Vec3& x, double height, double slack, double reach, const F& f) const {
    const auto most = static_cast<float>(reach * reach * rounding), at = static_cast<float>(height),
               limit = static_cast<float>(slack * rounding);
    for (std::size_t c = 0; c < x_.size(); c += 8) {
      const Offset o(*this, c, x);
      const F8 along = o.x * F8::load(&nx_[c]) + o.y * F8::load(&ny_[c]) + o.z * F8::load(&nz_[c]),
               above = F8::load(&height_[c]) - along - at;  // the offset is that of the particle
      call(c,
           ~(greater_mask(o.squared() - along * along, most) |
             greater_mask(larger(above, 0.0f - above), limit)),
           f);
    }
  }

 private:
  using F8 = simd::F8;
  static constexpr double rounding = 1.0001;
  struct Offset {
    F8 x, y, z;
    Offset(const NearFilm& n, std::size_t c, const Vec3& from)
        : x(F8::load(&n.x_[c]) - float(from.x())),
          y(F8::load(&n.y_[c]) - float(from.y())),
          z(F8::load(&n.z_[c]) - float(from.z())) {}
    F8 squared() const { return x * x + y * y + z * z; }
  };
  /// The padding never counts: differences of its squares say nothing.
  template <class F>
  void call(std::size_t c, std::uint32_t mask, const F& f) const {
    const std::uint32_t there = items_.size() - c < 8 ? (1u << (items_.size() - c)) - 1 : 0xff;
    for (std::uint32_t bits = mask & there; bits != 0; bits &= bits - 1)
      f(c + std::size_t(__builtin_ctz(bits)));
  }

  // Padded to a multiple of 8
  std::vector<float> x_, y_, z_, nx_, ny_, nz_, height_;
  std::vector<const FilmParticle*> items_;
  std::vector<std::uint32_t> particles_;
};

}  // namespace oilskin::reconstruction
