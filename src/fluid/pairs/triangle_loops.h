/// The kernels `hide`, `touching` and `closest` for any type of lanes; see pair_loops.h.
#pragma once

#include "fluid/pairs/wall_kernels.h"

namespace oilskin::fluid {

template <class Lanes>
struct TriangleLoops {
  using F8 = typename Lanes::F8;
  using D4 = typename Lanes::D4;
  using Mask4 = typename Lanes::Mask4;

  /// A plane nearer to the particle than this is seen edge-on and hides nothing [H].
  static constexpr float edge_on = 1e-5f;
  /// Cones of which the cosines say that they are apart by less than this count as touching.
  static constexpr float rounding_of_cosines = 1e-4f;

  static F8 dot(const float (&a)[3][8], const float (&b)[3]) {
    return F8::load(a[0]) * F8(b[0]) + (F8::load(a[1]) * F8(b[1]) + F8::load(a[2]) * F8(b[2]));
  }

  static void hide(const OccluderBlock* block, std::size_t count, const Occluded& own, std::uint8_t* bits) {
    for (std::size_t k = 0; k < count; ++k) bits[k] = static_cast<std::uint8_t>(hide(block[k], own));
  }

  /// Bit k: a ray from the particle may lie in both cones, and the occluder's plane is not seen edge-on.
  static std::uint32_t cones_touch(const OccluderBlock& o, const Occluded& own) {
    const F8 offset = F8::load(o.offset), distance = larger(offset, F8(0.0f) - offset);
    const F8 cosine = F8::load(o.cosine);
    const F8 limit = cosine * F8(own.cosine) - F8::load(o.sine) * F8(own.sine) - F8(rounding_of_cosines);
    std::uint32_t touch = greater_mask(dot(o.axis, own.axis), limit) | ~greater_mask(cosine, F8(0.0f));
    if (!(own.cosine > 0)) touch = 0xff;
    return touch & ~greater_mask(F8(edge_on), distance) & 0xff;
  }

  /// Bit k: one of three heights is above in_plane.
  template <class F>
  static std::uint32_t reach_inwards(const F& height_of) {
    return greater_mask(larger(larger(height_of(0), height_of(1)), height_of(2)), F8(in_plane));
  }

  static std::uint32_t hide(const OccluderBlock& o, const Occluded& own) {
    std::uint32_t may = cones_touch(o, own);
    if (may == 0) return 0;
    const F8 offset = F8::load(o.offset), toward = choose_positive(offset, F8(-1.0f), F8(1.0f));
    F8 height[3];  // above the occluder's plane, on whose upper side the particle is
    for (int k = 0; k < 3; ++k) height[k] = toward * (dot(o.normal, own.corner[k]) - offset);
    const F8 lowest = smaller(smaller(height[0], height[1]), height[2]);
    const F8 highest = larger(larger(height[0], height[1]), height[2]);
    const std::uint32_t above = greater_mask(lowest, F8(-in_plane));
    const std::uint32_t lies_on_it = above & greater_mask(F8(in_plane), highest);
    const std::uint32_t earlier = greater_mask(F8(own.number), F8::load(o.number));
    may &= (lies_on_it & earlier) | (~lies_on_it & ~above);
    // Pyramids that are apart are on different sides of a face of one of them.
    for (int side = 0; side < 3 && may != 0; ++side) {
      may &= reach_inwards([&](int corner) { return dot(o.side[side], own.corner[corner]); });
      may &= reach_inwards([&](int corner) { return dot(o.corner[corner], own.side[side]); });
    }
    return may;
  }

  /// The spheres that contain p, and whose planes are not farther than `plane_reach`.
  static std::size_t touching(const TriangleColumns& c, const float* p, float plane_reach,
                              std::uint32_t* out) {
    const F8 px(p[0]), py(p[1]), pz(p[2]), reach(plane_reach);
    std::size_t found = 0;
    for (std::size_t k = 0; k < c.count; k += 8) {
      const F8 dx = F8::load(c.x + k) - px, dy = F8::load(c.y + k) - py, dz = F8::load(c.z + k) - pz;
      const F8 height = F8::load(c.nx + k) * px + F8::load(c.ny + k) * py + F8::load(c.nz + k) * pz -
                        F8::load(c.offset + k);
      const std::uint32_t far = greater_mask(dx * dx + dy * dy + dz * dz, F8::load(c.radius2 + k)) |
                                greater_mask(larger(height, F8(0.0f) - height), reach);
      found += Lanes::select(~far & 0xff, c.number + k, out + found);
    }
    return found;
  }

  struct Vector {
    D4 x, y, z;
    Vector operator+(const Vector& o) const { return {x + o.x, y + o.y, z + o.z}; }
    Vector operator-(const Vector& o) const { return {x - o.x, y - o.y, z - o.z}; }
    Vector times(const D4& f) const { return {f * x, f * y, f * z}; }
    D4 dot(const Vector& o) const { return x * o.x + y * o.y + z * o.z; }
    Vector cross(const Vector& o) const { return {y * o.z - z * o.y, z * o.x - x * o.z, x * o.y - y * o.x}; }
  };

  /// Of four triangles, relative to p.
  static Vector corner(const Corners* triangles, const std::uint32_t* index, int first, const double* p) {
    const double *a = triangles[index[0]].x + first, *b = triangles[index[1]].x + first;
    const double *c = triangles[index[2]].x + first, *d = triangles[index[3]].x + first;
    return {D4(a[0], b[0], c[0], d[0]) - D4(p[0]), D4(a[1], b[1], c[1], d[1]) - D4(p[1]),
            D4(a[2], b[2], c[2], d[2]) - D4(p[2])};
  }

  static D4 max(const D4& a, const D4& b) { return choose(a > b, a, b); }

  /// Parameter of the point of the segment u → v that is closest to the origin; 0 without length.
  static D4 segment_parameter(const Vector& u, const Vector& v) {
    const Vector e = v - u;
    const D4 l2 = e.dot(e);
    const Mask4 has_length = l2 > D4(0.0);
    const D4 t = D4(-1.0) * u.dot(e) / choose(has_length, l2, D4(1.0));
    const D4 clamped = choose(t > D4(0.0), choose(D4(1.0) > t, t, D4(1.0)), D4(0.0));
    return choose(has_length, clamped, D4(0.0));
  }

  struct Weights {
    D4 a, b, c;
  };

  static Weights choose_weights(const Mask4& mask, const Weights& x, const Weights& y) {
    return {choose(mask, x.a, y.a), choose(mask, x.b, y.b), choose(mask, x.c, y.c)};
  }

  static Weights closest_of_segments(const Vector& a, const Vector& b, const Vector& c) {
    const D4 one(1.0), zero(0.0);
    const D4 s = segment_parameter(a, b), t = segment_parameter(b, c), u = segment_parameter(c, a);
    const auto square = [&](const Vector& from, const Vector& to, const D4& at) {
      const Vector p = from.times(one - at) + to.times(at);
      return p.dot(p);
    };
    const D4 ab = square(a, b, s), bc = square(b, c, t), ca = square(c, a, u);
    const Mask4 second = ab > bc;
    const Weights best = choose_weights(second, {zero, one - t, t}, {one - s, s, zero});
    return choose_weights(choose(second, bc, ab) > ca, {u, zero, one - u}, best);
  }

  /// closest_point() of four triangles; the same operations.
  static void closest(const Corners* triangles, const std::uint32_t* index, std::size_t count,
                      const double* p, ClosestBlock* out) {
    for (std::size_t k = 0; k < count; k += 4) {
      const Vector a = corner(triangles, index + k, 0, p), b = corner(triangles, index + k, 3, p),
                   c = corner(triangles, index + k, 6, p);
      const Vector ab = b - a, ac = c - a, bc = c - b, n = ab.cross(ac);
      const D4 longest2 = max(max(ab.dot(ab), ac.dot(ac)), bc.dot(bc)), n2 = n.dot(n);
      const D4 wa = n.dot(b.cross(c)), wb = n.dot(c.cross(a)), wc = n.dot(a.cross(b));
      const Mask4 has_area = n2 > D4(1e-14) * longest2 * longest2;
      const Mask4 on_face = has_area & (wa > D4(0.0)) & (wb > D4(0.0)) & (wc > D4(0.0));
      const D4 sum = choose(on_face, wa + wb + wc, D4(1.0)), u = wa / sum, v = wb / sum;
      const D4 rest = D4(1.0) - u - v;
      const Weights face = {u, v, choose(rest > D4(0.0), rest, D4(0.0))};
      const Weights w = choose_weights(on_face, face, closest_of_segments(a, b, c));
      write(w, a, b, c, *out);
      const D4 height = n.dot(a);
      (height * height / choose(n2 > D4(0.0), n2, D4(1.0))).store(out->height2);
      ++out;
    }
  }

  static void write(const Weights& w, const Vector& a, const Vector& b, const Vector& c, ClosestBlock& out) {
    const Vector foot = a.times(w.a) + b.times(w.b) + c.times(w.c);
    const Vector offset = foot.times(D4(-1.0));
    w.a.store(out.weight[0]);
    w.b.store(out.weight[1]);
    w.c.store(out.weight[2]);
    offset.x.store(out.offset[0]);
    offset.y.store(out.offset[1]);
    offset.z.store(out.offset[2]);
    root(offset.dot(offset)).store(out.distance);
  }
};

}  // namespace oilskin::fluid
