/// Checks the promise by other algorithms than contact: all pairs by sweep and prune, paths by additive
/// continuous collision detection [Li2021] and bisection, distances by another formula. Shares no code with
/// detection.
#include "contact/verify.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/assert.h"

namespace oilskin {

namespace {

double squared_distance_to_segment(const Vec3& a, const Vec3& b) {
  const Vec3 d = b - a;
  const double dd = d.dot(d);
  const double t = dd > 0 ? std::min(1.0, std::max(0.0, -a.dot(d) / dd)) : 0.0;
  return (a + t * d).squaredNorm();
}

// Distance of the origin from the triangle abc: to the plane if the origin projects inside, else to the
// nearest edge. A triangle without area has edges only.
double distance_to_triangle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double edges =
      std::sqrt(std::min({squared_distance_to_segment(a, b), squared_distance_to_segment(b, c),
                          squared_distance_to_segment(c, a)}));
  const Vec3 n = (b - a).cross(c - a);
  const double nn = n.norm();
  if (!(nn > 0)) return edges;
  const bool inside =
      (b - a).cross(n).dot(a) >= 0 && (c - b).cross(n).dot(b) >= 0 && (a - c).cross(n).dot(c) >= 0;
  return inside ? std::min(edges, std::abs(a.dot(n)) / nn) : edges;
}

// The bisection below distinguishes paths that pass a border from paths that touch it in the last bit, so it
// needs more bits than the differences of doubles have.
#if defined(__SIZEOF_FLOAT128__)
using Real = __float128;
constexpr double real_roundoff = 0x1p-113;
#else
using Real = long double;
constexpr double real_roundoff = 0.5 * static_cast<double>(std::numeric_limits<long double>::epsilon());
#endif

struct Vec {
  Real x, y, z;
};
Vec operator+(const Vec& a, const Vec& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
Vec operator-(const Vec& a, const Vec& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
Vec operator*(Real s, const Vec& a) {
  return {s * a.x, s * a.y, s * a.z};
}
Real dot(const Vec& a, const Vec& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
Vec cross(const Vec& a, const Vec& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Real sum_of_magnitudes(const Vec& a) {  // at least the length
  const auto magnitude = [](Real r) { return r < 0 ? -r : r; };
  return magnitude(a.x) + magnitude(a.y) + magnitude(a.z);
}
Vec exactly(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}

// The corners relative to the particle.
struct Corners {
  Vec at[3];
};

Corners between(const Corners& t0, const Corners& t1, Real t) {
  Corners c;
  for (int k = 0; k < 3; ++k) c.at[k] = (1 - t) * t0.at[k] + t * t1.at[k];
  return c;
}

// A separating direction to try: the offset of the origin from the closest point of the triangle, by the same
// cases as the distance.
Vec direction_from_triangle(const Corners& corners) {
  const Vec &a = corners.at[0], &b = corners.at[1], &c = corners.at[2];
  const Vec n = cross(b - a, c - a);
  const Real nn = dot(n, n);
  if (nn > 0 && dot(cross(b - a, n), a) >= 0 && dot(cross(c - b, n), b) >= 0 && dot(cross(a - c, n), c) >= 0)
    return (-dot(a, n) / nn) * n;
  Vec best{};
  Real min_square = -1;
  const Vec* corner[4] = {&a, &b, &c, &a};
  for (int k = 0; k < 3; ++k) {
    const Vec d = *corner[k + 1] - *corner[k];
    const Real dd = dot(d, d), along = -dot(*corner[k], d);
    const Real t = !(dd > 0) || along < 0 ? Real(0) : (along > dd ? Real(1) : along / dd);
    const Vec offset = Real(-1) * (*corner[k] + t * d);
    const Real square = dot(offset, offset);
    if (min_square >= 0 && square >= min_square) continue;
    min_square = square;
    best = offset;
  }
  return best;
}

// Are all three corners strictly on one side along n at both ends? Then they are in between, too, since they
// move linearly.
bool separated_along(const Vec& n, const Corners& begin, const Corners& end) {
  const Real error = 16 * Real(real_roundoff) * sum_of_magnitudes(n);
  for (const Corners* c : {&begin, &end})
    for (const Vec& x : c->at)
      if (!(-dot(n, x) > error * sum_of_magnitudes(x))) return false;
  return true;
}

// Do the four Bernstein coefficients of the signed volume certainly have one sign? Then the particle does not
// reach the triangle's plane.
bool plane_never_reached(const Corners& begin, const Corners& end) {
  const auto det = [](const Vec& x, const Vec& y, const Vec& z) { return dot(x, cross(y, z)); };
  const Vec &a0 = begin.at[0], &b0 = begin.at[1], &c0 = begin.at[2];
  const Vec &a1 = end.at[0], &b1 = end.at[1], &c1 = end.at[2];
  const Real k[4] = {det(a0, b0, c0), (det(a1, b0, c0) + det(a0, b1, c0) + det(a0, b0, c1)) / 3,
                     (det(a1, b1, c0) + det(a1, b0, c1) + det(a0, b1, c1)) / 3, det(a1, b1, c1)};
  const auto larger = [](const Vec& x, const Vec& y) {
    return std::max(sum_of_magnitudes(x), sum_of_magnitudes(y));
  };
  const Real error = 64 * Real(real_roundoff) * larger(a0, a1) * larger(b0, b1) * larger(c0, c1);
  return (k[0] > error && k[1] > error && k[2] > error && k[3] > error) ||
         (k[0] < -error && k[1] < -error && k[2] < -error && k[3] < -error);
}

// For paths on which additive advancement is slow (sliding along a sheet at a distance far below the
// displacement): bisects time until a direction or the triangle's plane separates each part.
bool touches_by_bisection(const Corners& t0, const Corners& t1) {
  struct Part {
    Real begin, end;
  };
  constexpr int max_parts = 200000;
  std::vector<Part> parts{{0, 1}};
  for (int count = 0; !parts.empty(); ++count) {
    if (count > max_parts) return true;
    const Part part = parts.back();
    parts.pop_back();
    const Real mid = (part.begin + part.end) / 2;
    const Corners begin = between(t0, t1, part.begin), end = between(t0, t1, part.end);
    if (separated_along(direction_from_triangle(between(t0, t1, mid)), begin, end) ||
        plane_never_reached(begin, end))
      continue;
    if (mid <= part.begin || mid >= part.end) return true;
    parts.push_back({part.begin, mid});
    parts.push_back({mid, part.end});
  }
  return false;
}

// A particle and a triangle at both ends.
struct Paths {
  Vec3 p_t0, p_t1, t0[3], t1[3];
};

// The distance is Lipschitz continuous in time; its constant is the largest displacement of a corner relative
// to the particle.
bool path_touches(const Paths& paths) {
  Vec3 t0[3], t1[3];
  Corners exact_t0, exact_t1;
  double lipschitz = 0, size = 0;
  for (int k = 0; k < 3; ++k) {
    t0[k] = paths.t0[k] - paths.p_t0;
    t1[k] = paths.t1[k] - paths.p_t1;
    exact_t0.at[k] = exactly(paths.t0[k]) - exactly(paths.p_t0);
    exact_t1.at[k] = exactly(paths.t1[k]) - exactly(paths.p_t1);
    lipschitz = std::max(lipschitz, (t1[k] - t0[k]).norm());
    size = std::max({size, t0[k].norm(), t1[k].norm()});
  }
  double t = 0, d = distance_to_triangle(t0[0], t0[1], t0[2]);
  constexpr int max_steps = 64;
  for (int step = 0; step < max_steps; ++step) {
    if (lipschitz == 0) return d <= 0;
    if (d < 1e-9 * size) break;  // within rounding of doubles
    t += 0.9 * d / lipschitz;
    if (t >= 1) return false;
    d = distance_to_triangle((1 - t) * t0[0] + t * t1[0], (1 - t) * t0[1] + t * t1[1],
                             (1 - t) * t0[2] + t * t1[2]);
  }
  return touches_by_bisection(exact_t0, exact_t1);
}

struct SweptBoxes {
  std::vector<Box> particle, triangle;
  Box all_triangles;
};

SweptBoxes swept_boxes(const ParticleMotion& particles, const SurfaceMotion& s, const Workers& workers) {
  constexpr std::size_t chunk = 1024;
  SweptBoxes boxes;
  boxes.particle.resize(particles.id.size());
  boxes.triangle.resize(s.triangles.size());
  workers.for_each(boxes.particle.size(), chunk, [&](std::size_t p) {
    if (particles.removed[p]) return;
    boxes.particle[p].add(particles.x_t0[p]);
    boxes.particle[p].add(particles.x_t1[p]);
  });
  workers.for_each(boxes.triangle.size(), chunk, [&](std::size_t t) {
    Box& box = boxes.triangle[t];
    for (std::uint32_t v : s.triangles[t]) {
      box.add(s.x_t0[v]);
      box.add(s.x_t1[v]);
    }
    box = box.inflated(1.001 * s.delta);
  });
  for (const Box& box : boxes.triangle) boxes.all_triangles.add(box);
  return boxes;
}

// A box projected onto the axis of the sweep.
struct Projection {
  double low, high;
  std::uint32_t index;
};

void sort_by_low(std::vector<Projection>& list) {
  std::sort(list.begin(), list.end(), [](const Projection& x, const Projection& y) { return x.low < y.low; });
}

// Calls visit(index in a, index in b) for all pairs of overlapping projections, both sorted by their lower
// ends: merges the lists and pairs each entry with the active entries of the other one.
template <class Visit>
void sweep(Span<const Projection> a, Span<const Projection> b, const Visit& visit) {
  const auto visit_active = [](std::vector<Projection>& active, double low, const auto& f) {
    std::size_t kept = 0;
    for (std::size_t k = 0; k < active.size(); ++k) {
      if (active[k].high < low) continue;
      f(active[k].index);
      active[kept++] = active[k];
    }
    active.resize(kept);
  };
  std::vector<Projection> active_a, active_b;
  std::size_t i = 0, j = 0;
  while (i < a.size() || j < b.size()) {
    if (j == b.size() || (i < a.size() && a[i].low <= b[j].low)) {
      visit_active(active_b, a[i].low, [&](std::uint32_t index) { visit(a[i].index, index); });
      active_a.push_back(a[i++]);
    } else {
      visit_active(active_a, b[j].low, [&](std::uint32_t index) { visit(index, b[j].index); });
      active_b.push_back(b[j++]);
    }
  }
}

bool violates_promise(const ParticleMotion& particles, const SurfaceMotion& s, std::uint32_t p,
                      std::uint32_t t) {
  Paths paths;
  paths.p_t0 = particles.x_t0[p];
  paths.p_t1 = particles.x_t1[p];
  Vec3 end[3];
  for (int k = 0; k < 3; ++k) {
    paths.t0[k] = s.x_t0[s.triangles[t][k]];
    paths.t1[k] = s.x_t1[s.triangles[t][k]];
    end[k] = paths.t1[k] - paths.p_t1;
  }
  const bool too_close = distance_to_triangle(end[0], end[1], end[2]) < s.delta * (1 - 1e-9);
  return too_close || path_touches(paths);
}

// The triangles that overlap the projections of some particles.
std::vector<Projection> triangles_beside(Span<const Projection> particles,
                                         const std::vector<Projection>& triangles) {
  double high = -std::numeric_limits<double>::infinity();
  for (const Projection& p : particles) high = std::max(high, p.high);
  std::vector<Projection> beside;
  for (const Projection& t : triangles)
    if (t.high >= particles[0].low && t.low <= high) beside.push_back(t);
  return beside;
}

void count_for_surface(const ParticleMotion& particles, const SurfaceMotion& s, const Workers& workers,
                       std::vector<std::uint8_t>& violates, std::uint64_t& pairs) {
  OILSKIN_ASSERT(s.delta >= 0 && s.x_t0.size() == s.x_t1.size());
  const SweptBoxes boxes = swept_boxes(particles, s, workers);
  int axis = 0;
  (boxes.all_triangles.max - boxes.all_triangles.min).maxCoeff(&axis);
  const auto project = [axis](const Box& box, std::uint32_t index) {
    return Projection{box.min[axis], box.max[axis], index};
  };
  std::vector<Projection> on_axis_p, on_axis_t;
  for (std::uint32_t p = 0; p < boxes.particle.size(); ++p)
    if (!particles.removed[p] && boxes.particle[p].overlaps(boxes.all_triangles))
      on_axis_p.push_back(project(boxes.particle[p], p));
  for (std::uint32_t t = 0; t < boxes.triangle.size(); ++t)
    on_axis_t.push_back(project(boxes.triangle[t], t));
  sort_by_low(on_axis_p);
  sort_by_low(on_axis_t);
  constexpr std::size_t chunk = 512;
  pairs +=
      workers.ordered_sum(on_axis_p.size(), chunk, std::uint64_t{0}, [&](std::size_t begin, std::size_t end) {
        const Span<const Projection> part(on_axis_p.data() + begin, end - begin);
        std::uint64_t tested = 0;
        sweep(part, triangles_beside(part, on_axis_t), [&](std::uint32_t p, std::uint32_t t) {
          if (!boxes.particle[p].overlaps(boxes.triangle[t])) return;
          ++tested;
          if (!violates[p] && violates_promise(particles, s, p, t)) violates[p] = 1;
        });
        return tested;
      });
}

}  // namespace

namespace contact {

std::uint64_t count_crossings(const ParticleMotion& particles, Span<SurfaceMotion* const> surfaces,
                              const Workers& workers, std::uint64_t* pairs_tested) {
  OILSKIN_ASSERT(particles.x_t0.size() == particles.id.size() &&
                 particles.x_t1.size() == particles.id.size());
  std::vector<std::uint8_t> violates(particles.id.size(), 0);
  std::uint64_t pairs = 0;
  for (const SurfaceMotion* s : surfaces) count_for_surface(particles, *s, workers, violates, pairs);
  if (pairs_tested) *pairs_tested = pairs;
  return static_cast<std::uint64_t>(std::count(violates.begin(), violates.end(), std::uint8_t{1}));
}

}  // namespace contact

std::uint64_t ContactSolver::count_crossings(const ParticleMotion& particles,
                                             Span<SurfaceMotion* const> surfaces,
                                             std::uint64_t* pairs_tested) {
  return contact::count_crossings(particles, surfaces, Workers(1), pairs_tested);
}

}  // namespace oilskin
