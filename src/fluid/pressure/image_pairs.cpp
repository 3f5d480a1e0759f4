#include "fluid/pressure/image_pairs.h"

#include <cmath>

#include "core/assert.h"
#include "fluid/kernels.h"

namespace oilskin::fluid {

namespace {

constexpr std::size_t point_chunk = 64;

/// Σ_T S_T w'(q')/q' over the walls of a particle, q' being its distance from the image of the particle at −Δ
/// (B.32).
float image_slope(Span<const ImagePlane> planes, const Eigen::Vector3f& delta, float q2) {
  float sum = 0;
  for (const ImagePlane& plane : planes) {
    const float other = plane.distance - plane.normal.dot(delta);
    const float square = q2 + 4 * plane.distance * other;
    if (other > 0 && square < 1) sum += plane.share * CubicSpline::dw_over_q(std::sqrt(square));
  }
  return sum;
}

/// add(i, k, f, Δ) for each pair of particles at walls, k counting the neighbours of i. Both orders of a pair
/// have the same f, bit for bit.
template <class Add>
void for_image_pairs(StepState& state, const Add& add) {
  const Boundary& boundary = state.boundary;
  if (boundary.empty()) return;
  OILSKIN_ASSERT(state.slope.size() * Neighbours::chunk_size >= state.size());
  const std::vector<Record>& x = state.position();
  state.workers.for_each(boundary.points().size(), point_chunk, [&](std::size_t p) {
    const std::uint32_t i = boundary.points()[p].particle;
    const Span<const ImagePlane> own = boundary.images_of(p);
    const std::uint32_t* list = state.neighbours.list(i);
    for (std::uint32_t k = 0; k < state.neighbours.count(i); ++k) {
      const std::uint32_t j = list[k], other = boundary.point_of(j);
      if (other == Boundary::none) continue;
      const Eigen::Vector3f delta(x[i].x - x[j].x, x[i].y - x[j].y, x[i].z - x[j].z);
      const float q2 = delta.x() * delta.x() + delta.y() * delta.y() + delta.z() * delta.z();
      if (!(q2 < 1)) continue;
      const float slope =
          0.5f * (image_slope(own, delta, q2) + image_slope(boundary.images_of(other), -delta, q2));
      if (slope != 0) add(i, k, slope, delta);
    }
  });
}

}  // namespace

void add_image_slopes(StepState& state) {
  for_image_pairs(state, [&](std::uint32_t i, std::uint32_t k, float slope, const Eigen::Vector3f&) {
    state.slope[i / Neighbours::chunk_size][state.neighbours.pair_begin(i) + k] += slope;
  });
}

void add_image_slopes(StepState& state, std::vector<Record>& sums, TensorArray& moments) {
  const float* masses = state.mass_ratio.empty() ? nullptr : state.mass_ratio.data();
  for_image_pairs(state, [&](std::uint32_t i, std::uint32_t k, float slope, const Eigen::Vector3f& delta) {
    float& at = state.slope[i / Neighbours::chunk_size][state.neighbours.pair_begin(i) + k];
    const float before = at, after = before + slope;
    at = after;
    Record& sum = sums[i];
    const float other = masses ? masses[state.neighbours.list(i)[k]] : 1, own = masses ? masses[i] : 1;
    const Eigen::Vector3f change = other * slope * delta;
    sum.x += change.x();
    sum.y += change.y();
    sum.z += change.z();
    sum.w += own * other * (after * after - before * before) * delta.squaredNorm();
    if (moments.empty()) return;
    SecondMoments m = moments[i];
    m.xx += change.x() * delta.x();
    m.yy += change.y() * delta.y();
    m.zz += change.z() * delta.z();
    m.xy += change.x() * delta.y();
    m.xz += change.x() * delta.z();
    m.yz += change.y() * delta.z();
    moments.set(i, m);
  });
}

}  // namespace oilskin::fluid
