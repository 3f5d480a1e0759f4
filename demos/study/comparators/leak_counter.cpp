#include "study/comparators/leak_counter.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace oilskin::study {
namespace {

/// A point that moves straight from x0 by dx in a unit of time.
struct Line {
  Vec3 x0, dx;
  Vec3 at(double t) const { return x0 + t * dx; }
};

/// c₀ + c₁ t + c₂ t² + c₃ t³
struct Cubic {
  std::array<double, 4> c;
  double at(double t) const { return c[0] + t * (c[1] + t * (c[2] + t * c[3])); }
};

/// Six times the volume of the tetrahedron of the point and the corners, over time.
Cubic volume(const Line& q, const Line& u, const Line& w) {
  const auto det = [](const Vec3& a, const Vec3& b, const Vec3& d) { return a.dot(b.cross(d)); };
  return {{det(q.x0, u.x0, w.x0), det(q.dx, u.x0, w.x0) + det(q.x0, u.dx, w.x0) + det(q.x0, u.x0, w.dx),
           det(q.dx, u.dx, w.x0) + det(q.dx, u.x0, w.dx) + det(q.x0, u.dx, w.dx), det(q.dx, u.dx, w.dx)}};
}

/// 0, 1 and where the slope vanishes between them, ascending: the cubic is monotone from one to the next.
std::vector<double> turning_points(const Cubic& f) {
  std::vector<double> t = {0, 1};
  const double a = 3 * f.c[3], b = f.c[2], c = f.c[1], root = b * b - a * c;
  if (root > 0) {
    const double s = -(b + std::copysign(std::sqrt(root), b));
    for (double candidate : {s / a, c / s})
      if (candidate > 0 && candidate < 1) t.push_back(candidate);
  }
  std::sort(t.begin(), t.end());
  return t;
}

/// The root in [begin, end], at the ends of which the signs differ.
double bisect(const Cubic& f, double begin, double end) {
  const bool positive = f.at(begin) >= 0;
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (begin + end);
    (positive == (f.at(middle) >= 0) ? begin : end) = middle;
  }
  return 0.5 * (begin + end);
}

/// Whether a point in the plane of the triangle 0, u, w lies in it, borders included.
bool inside(const Vec3& q, const Vec3& u, const Vec3& w) {
  constexpr double tolerance = 1e-9;
  const Vec3 normal = u.cross(w);
  const double area = normal.squaredNorm();
  const double a = q.cross(w).dot(normal), b = u.cross(q).dot(normal);
  return a >= -tolerance * area && b >= -tolerance * area && a + b <= (1 + tolerance) * area;
}

Line line(const Vec3& begin, const Vec3& end) {
  return {begin, end - begin};
}
Line relative(const Line& a, const Line& b) {
  return {a.x0 - b.x0, a.dx - b.dx};
}

/// Passages of one pair.
void add_passages(const Line& p, const std::array<Line, 3>& corner, Passage passage,
                  std::vector<Passage>& found) {
  const Line q = relative(p, corner[0]), u = relative(corner[1], corner[0]),
             w = relative(corner[2], corner[0]);
  const Cubic f = volume(q, u, w);
  const std::vector<double> t = turning_points(f);
  for (std::size_t k = 0; k + 1 < t.size(); ++k) {
    const bool before = f.at(t[k]) >= 0, after = f.at(t[k + 1]) >= 0;
    if (before == after) continue;
    passage.t = bisect(f, t[k], t[k + 1]);
    passage.direction = after ? 1 : -1;
    if (inside(q.at(passage.t), u.at(passage.t), w.at(passage.t))) found.push_back(passage);
  }
}

Box box_of(const Vec3& a, const Vec3& b) {
  Box box;
  box.add(a);
  box.add(b);
  return box;
}

/// A surface over an interval.
struct Sheet {
  explicit Sheet(const SurfaceMotion& m) : motion(m) {
    std::vector<Box> boxes;
    for (const Triangle& triangle : m.triangles) {
      Box box;
      for (std::uint32_t node : triangle) box.add(box_of(m.x_t0[node], m.x_t1[node]));
      // The roots are found within rounding: so are the boxes.
      boxes.push_back(box.inflated(1e-9));
    }
    tree.build(std::move(boxes));
  }
  std::array<Line, 3> corners(std::size_t triangle) const {
    std::array<Line, 3> c;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t node = motion.triangles[triangle][k];
      c[k] = line(motion.x_t0[node], motion.x_t1[node]);
    }
    return c;
  }
  const SurfaceMotion& motion;
  BoxTree tree;
};

/// Sorts by time and joins those that triangles with a common edge or vertex report together.
void join_shared(std::vector<Passage>& passages) {
  constexpr double same_time = 1e-7;
  std::sort(passages.begin(), passages.end(), [](const Passage& a, const Passage& b) { return a.t < b.t; });
  const auto is_same = [&](const Passage& a, const Passage& b) {
    return b.t - a.t < same_time && a.direction == b.direction;
  };
  passages.erase(std::unique(passages.begin(), passages.end(), is_same), passages.end());
}

}  // namespace

std::vector<Passage> count_leaks(const Interval& interval) {
  std::vector<Passage> all, own;
  for (std::size_t s = 0; s < interval.surfaces.size(); ++s) {
    const Sheet sheet(*interval.surfaces[s]);
    for (std::size_t i = 0; i < interval.id.size(); ++i) {
      own.clear();
      const Line path = line(interval.x_t0[i], interval.x_t1[i]);
      sheet.tree.for_each_overlap(box_of(interval.x_t0[i], interval.x_t1[i]), [&](std::uint32_t triangle) {
        add_passages(path, sheet.corners(triangle), {i, s, 0, 0}, own);
      });
      join_shared(own);
      all.insert(all.end(), own.begin(), own.end());
    }
  }
  return all;
}

void LeakCounter::on_interval(const Interval& interval) {
  for (const Passage& passage : count_leaks(interval)) {
    ++passages_;
    net_[{interval.id[passage.particle], interval.surfaces[passage.surface]->id}] += passage.direction;
  }
}

LeakCount LeakCounter::count() const {
  std::set<std::uint64_t> particles, beyond;
  for (const auto& [key, net] : net_) {
    particles.insert(key.first);
    if (net != 0) beyond.insert(key.first);
  }
  return {passages_, particles.size(), beyond.size()};
}

}  // namespace oilskin::study
