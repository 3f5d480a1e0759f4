/// The promise checked by another route: all pairs by sweep and prune, paths by additive continuous collision
/// detection (Li, Kaufman, Jiang 2021) and halving, distances by their own formula. Shares no code with
/// detection.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "oilskin/contact.h"

namespace oilskin {

namespace {

double squared_distance_to_segment(const Vec3& a, const Vec3& b) {
  const Vec3 d = b - a;
  const double dd = d.dot(d);
  const double t = dd > 0 ? std::min(1.0, std::max(0.0, -a.dot(d) / dd)) : 0.0;
  return (a + t * d).squaredNorm();
}

// Distance of the origin from the triangle abc: to the plane where the origin projects inside, else to the
// nearest edge; the edges alone where the triangle has no area.
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

// The offset of the origin from the closest point of abc, by the same cases as above: a direction to look
// along.
Vec3 direction_from_triangle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 n = (b - a).cross(c - a);
  const double nn = n.squaredNorm();
  if (nn > 0 && (b - a).cross(n).dot(a) >= 0 && (c - b).cross(n).dot(b) >= 0 && (a - c).cross(n).dot(c) >= 0)
    return -n * (a.dot(n) / nn);
  Vec3 best = Vec3::Constant(std::numeric_limits<double>::infinity());
  const Vec3* corner[4] = {&a, &b, &c, &a};
  for (int k = 0; k < 3; ++k) {
    const Vec3 d = *corner[k + 1] - *corner[k];
    const double dd = d.dot(d);
    const double t = dd > 0 ? std::min(1.0, std::max(0.0, -corner[k]->dot(d) / dd)) : 0.0;
    const Vec3 offset = -(*corner[k] + t * d);
    if (offset.squaredNorm() < best.squaredNorm()) best = offset;
  }
  return best;
}

using Long = Eigen::Matrix<long double, 3, 1>;

struct Corners {
  Long at[3];
};

Corners corners_at(const Vec3 t0[3], const Vec3 t1[3], long double t) {
  Corners c;
  for (int k = 0; k < 3; ++k) c.at[k] = (1 - t) * t0[k].cast<long double>() + t * t1[k].cast<long double>();
  return c;
}

// One direction keeps all three corners strictly on one side at both ends: since they move on straight lines,
// also in between.
bool separated_along(const Long& n, const Corners& begin, const Corners& end) {
  if (!(n.squaredNorm() > 0)) return false;
  for (const Corners* c : {&begin, &end})
    for (const Long& x : c->at)
      if (!(-n.dot(x) > 1e-18L * n.norm() * x.norm())) return false;
  return true;
}

// The four Bernstein coefficients of the signed volume between two moments have one sign, clearly: the
// particle never reaches the triangle's plane.
bool plane_never_reached(const Corners& begin, const Corners& end) {
  const auto det = [](const Long& x, const Long& y, const Long& z) { return x.dot(y.cross(z)); };
  const Long &a0 = begin.at[0], &b0 = begin.at[1], &c0 = begin.at[2];
  const Long &a1 = end.at[0], &b1 = end.at[1], &c1 = end.at[2];
  const long double k[4] = {det(a0, b0, c0), (det(a1, b0, c0) + det(a0, b1, c0) + det(a0, b0, c1)) / 3,
                            (det(a1, b1, c0) + det(a1, b0, c1) + det(a0, b1, c1)) / 3, det(a1, b1, c1)};
  const long double size =
      std::max(a0.norm(), a1.norm()) * std::max(b0.norm(), b1.norm()) * std::max(c0.norm(), c1.norm());
  const long double error = 1e-17L * size;
  return (k[0] > error && k[1] > error && k[2] > error && k[3] > error) ||
         (k[0] < -error && k[1] < -error && k[2] < -error && k[3] < -error);
}

// Where additive advancement creeps (sliding along a sheet at a distance far below the way), halve the time
// until each part is free by a direction or by the triangle's plane.
bool touches_by_halving(const Vec3 t0[3], const Vec3 t1[3]) {
  struct Part {
    double begin, end;
  };
  std::vector<Part> parts{{0, 1}};
  for (int count = 0; !parts.empty(); ++count) {
    if (count > 20000) return true;
    const Part part = parts.back();
    parts.pop_back();
    const double mid = 0.5 * (part.begin + part.end);
    const Corners begin = corners_at(t0, t1, part.begin), end = corners_at(t0, t1, part.end);
    const Corners middle = corners_at(t0, t1, mid);
    const Vec3 n = direction_from_triangle(middle.at[0].cast<double>(), middle.at[1].cast<double>(),
                                           middle.at[2].cast<double>());
    if (separated_along(n.cast<long double>(), begin, end) || plane_never_reached(begin, end)) continue;
    if (mid <= part.begin || mid >= part.end) return true;
    parts.push_back({part.begin, mid});
    parts.push_back({mid, part.end});
  }
  return false;
}

// Corners relative to the particle at both ends. Distance is Lipschitz in time with the largest corner
// displacement.
bool path_touches(const Vec3 t0[3], const Vec3 t1[3]) {
  double lipschitz = 0;
  for (int k = 0; k < 3; ++k) lipschitz = std::max(lipschitz, (t1[k] - t0[k]).norm());
  double t = 0, d = distance_to_triangle(t0[0], t0[1], t0[2]);
  constexpr int most_steps = 64;
  for (int step = 0; step < most_steps; ++step) {
    if (lipschitz == 0) return d <= 0;
    t += 0.9 * d / lipschitz;
    if (t >= 1) return false;
    d = distance_to_triangle((1 - t) * t0[0] + t * t1[0], (1 - t) * t0[1] + t * t1[1],
                             (1 - t) * t0[2] + t * t1[2]);
  }
  return touches_by_halving(t0, t1);
}

struct Interval1 {
  double low, high;
  std::uint32_t index;
};

void count_for_surface(const ParticleMotion& particles, const SurfaceMotion& s,
                       std::vector<std::uint8_t>& bad, std::uint64_t& pairs) {
  std::vector<Box> particle_box(particles.id.size()), triangle_box(s.triangles.size());
  Box all;
  for (std::size_t p = 0; p < particle_box.size(); ++p) {
    if (particles.removed[p]) continue;
    particle_box[p].add(particles.x_t0[p]);
    particle_box[p].add(particles.x_t1[p]);
  }
  for (std::size_t t = 0; t < triangle_box.size(); ++t) {
    for (std::uint32_t v : s.triangles[t]) {
      triangle_box[t].add(s.x_t0[v]);
      triangle_box[t].add(s.x_t1[v]);
    }
    triangle_box[t] = triangle_box[t].inflated(1.001 * s.delta);
    all.add(triangle_box[t]);
  }
  int axis = 0;
  (all.max - all.min).maxCoeff(&axis);
  std::vector<Interval1> ps, ts;
  for (std::uint32_t p = 0; p < particle_box.size(); ++p)
    if (!particles.removed[p] && particle_box[p].overlaps(all))
      ps.push_back({particle_box[p].min[axis], particle_box[p].max[axis], p});
  for (std::uint32_t t = 0; t < triangle_box.size(); ++t)
    ts.push_back({triangle_box[t].min[axis], triangle_box[t].max[axis], t});
  const auto by_low = [](const Interval1& a, const Interval1& b) { return a.low < b.low; };
  std::sort(ps.begin(), ps.end(), by_low);
  std::sort(ts.begin(), ts.end(), by_low);

  const auto test = [&](std::uint32_t p, std::uint32_t t) {
    if (!particle_box[p].overlaps(triangle_box[t])) return;
    ++pairs;
    if (bad[p]) return;
    Vec3 t0[3], t1[3];
    for (int k = 0; k < 3; ++k) {
      t0[k] = s.x_t0[s.triangles[t][k]] - particles.x_t0[p];
      t1[k] = s.x_t1[s.triangles[t][k]] - particles.x_t1[p];
    }
    const bool too_near = distance_to_triangle(t1[0], t1[1], t1[2]) < s.delta * (1 - 1e-9);
    if (too_near || path_touches(t0, t1)) bad[p] = 1;
  };
  // Sweep: merge both lists by their lower ends; each newcomer meets the active members of the other list.
  std::vector<Interval1> active_p, active_t;
  std::size_t i = 0, j = 0;
  const auto meet = [](std::vector<Interval1>& active, double low, const auto& f) {
    std::size_t kept = 0;
    for (std::size_t k = 0; k < active.size(); ++k) {
      if (active[k].high < low) continue;
      f(active[k].index);
      active[kept++] = active[k];
    }
    active.resize(kept);
  };
  while (i < ps.size() || j < ts.size()) {
    if (j == ts.size() || (i < ps.size() && ps[i].low <= ts[j].low)) {
      meet(active_t, ps[i].low, [&](std::uint32_t t) { test(ps[i].index, t); });
      active_p.push_back(ps[i++]);
    } else {
      meet(active_p, ts[j].low, [&](std::uint32_t p) { test(p, ts[j].index); });
      active_t.push_back(ts[j++]);
    }
  }
}

}  // namespace

std::uint64_t ContactSolver::count_crossings(const ParticleMotion& particles,
                                             Span<SurfaceMotion* const> surfaces,
                                             std::uint64_t* pairs_tested) {
  std::vector<std::uint8_t> bad(particles.id.size(), 0);
  std::uint64_t pairs = 0;
  for (const SurfaceMotion* s : surfaces) count_for_surface(particles, *s, bad, pairs);
  if (pairs_tested) *pairs_tested = pairs;
  return static_cast<std::uint64_t>(std::count(bad.begin(), bad.end(), std::uint8_t{1}));
}

}  // namespace oilskin
