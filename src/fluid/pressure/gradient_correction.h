/// First-order consistent divergence of velocities, and the pressure force that is its transpose
/// (docs/theory/fluid.md, (F.56) to (F.59)).
///
/// The sum D Σ w'/q Δ·(v_i − v_j) of a disordered or sheared arrangement mistakes shear for compression, by a
/// tenth and more at H = 2 dx. A pressure that has to prevent this apparent compression resists shear like
/// a friction that grows with the pressure: waves and vortices die. With K_i = M_i⁻¹ the divergence of a
/// linear velocity field is exact. The force Σ (φ_i K_i + φ_j K_j) w'/q Δ [Bonet1999] is antisymmetric, so
/// that momentum stays exact, and, as the transpose, does no work on flow without divergence.
#pragma once

#include "fluid/pressure/pair_gradients.h"

namespace oilskin::fluid {

/// Σ w'/q Δ ⊗ Δ over the pairs of a particle.
struct SecondMoments {
  F4 xx, yy, zz, xy, xz, yz;

  void add(const Pairs& pairs, F4 slope) {
    const F4 x = slope * pairs.dx, y = slope * pairs.dy, z = slope * pairs.dz;
    xx += x * pairs.dx;
    yy += y * pairs.dy;
    zz += z * pairs.dz;
    xy += x * pairs.dy;
    xz += x * pairs.dz;
    yz += y * pairs.dz;
  }
  Eigen::Matrix3f sum() const {
    const float a = total(xy), b = total(xz), c = total(yz);
    Eigen::Matrix3f m;
    m << total(xx), a, b, a, total(yy), c, b, c, total(zz);
    return m;
  }
};

class GradientCorrection {
 public:
  void resize(std::size_t particles);
  /// Of the first pass over the pairs; `scale` is D.
  void keep(std::size_t i, const SecondMoments& moments, float scale) {
    moments_[i] = -scale * moments.sum();
  }
  /// The pair with an image adds slope Δ ⊗ Δ.
  void add(std::size_t i, float slope, const Eigen::Vector3f& delta, float scale) {
    moments_[i] -= scale * slope * delta * delta.transpose();
  }
  /// K_i of all particles, from what keep() stored and from the walls.
  void build(const StepState& state);

  const Eigen::Matrix3f& at(std::size_t i) const { return moments_[i]; }
  /// The largest eigenvalue of K_i.
  float largest(std::size_t i) const { return largest_[i]; }

  /// Sets the tensors φ_i K_i that displacement() uses.
  void set_pressures(const StepState& state, const std::vector<float>& phi);
  /// −Σ_j (φ_i K_i + φ_j K_j) w'/q Δ [H].
  template <class Sum>
  Vec3 displacement(const StepState& state, std::size_t i) const;
  /// Σ_j (K_i w'/q Δ)·(y_i − y_j).
  float compression(const StepState& state, const std::vector<Record>& y, std::size_t i) const;

 private:
  std::vector<Eigen::Matrix3f> moments_;  // M_i, after build() K_i
  std::vector<float> largest_;
  std::vector<Record> diagonal_, other_;  // of φ_i K_i: xx yy zz, and xy xz yz; with one more for the padding
};

template <class Sum>
Vec3 GradientCorrection::displacement(const StepState& state, std::size_t i) const {
  const std::uint32_t* j = state.neighbours.list(i);
  const float* gradient = gradients(state, i);
  const Record &d = diagonal_[i], &o = other_[i];
  Sum sx, sy, sz;
  for (std::uint32_t b = state.neighbours.blocks(i); b > 0; --b, j += 4, gradient += 12) {
    const Record4 p(diagonal_.data(), j), q(other_.data(), j);
    const F4 x = load(gradient), y = load(gradient + 4), z = load(gradient + 8);
    const F4 xy = F4(o.x) + q.x, xz = F4(o.y) + q.y, yz = F4(o.z) + q.z;
    sx += (F4(d.x) + p.x) * x + xy * y + xz * z;
    sy += xy * x + (F4(d.y) + p.y) * y + yz * z;
    sz += xz * x + yz * y + (F4(d.z) + p.z) * z;
  }
  return -total(sx, sy, sz);
}

}  // namespace oilskin::fluid
