#include "reconstruction/triangle_oracle.h"

#include <algorithm>
#include <cmath>

#include "proximity/surface_tree.h"
#include "support/exact.h"

namespace oilskin::test {

namespace {

using exact::Integer;

constexpr int shift = 400;  // makes every double of the tests whole

Integer whole(double x) {
  return Integer::from_double(x, shift);
}

/// Sign of the area of a, b, c seen along the axis that is left out.
int turn(const Vec3& a, const Vec3& b, const Vec3& c, int u, int v) {
  const double left = (b[u] - a[u]) * (c[v] - a[v]), right = (b[v] - a[v]) * (c[u] - a[u]);
  const double area = left - right;
  if (std::abs(area) > 1e-14 * (std::abs(left) + std::abs(right))) return area > 0 ? 1 : -1;
  const Integer au = whole(a[u]), av = whole(a[v]);
  return ((whole(b[u]) - au) * (whole(c[v]) - av) - (whole(b[v]) - av) * (whole(c[u]) - au)).sign();
}

/// Sign of the volume over a, b, c up to d.
int side_of(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 x = b - a, y = c - a, z = d - a;
  double volume = 0, size = 0;
  for (int k = 0; k < 3; ++k) {
    const int u = (k + 1) % 3, v = (k + 2) % 3;
    volume += x[k] * (y[u] * z[v] - y[v] * z[u]);
    size += std::abs(x[k]) * (std::abs(y[u] * z[v]) + std::abs(y[v] * z[u]));
  }
  if (std::abs(volume) > 1e-14 * size) return volume > 0 ? 1 : -1;
  Integer p[3], q[3], r[3];
  for (int k = 0; k < 3; ++k) {
    const Integer o = whole(a[k]);
    p[k] = whole(b[k]) - o;
    q[k] = whole(c[k]) - o;
    r[k] = whole(d[k]) - o;
  }
  Integer sum;
  for (int k = 0; k < 3; ++k) {
    const int u = (k + 1) % 3, v = (k + 2) % 3;
    sum = sum + p[k] * (q[u] * r[v] - q[v] * r[u]);
  }
  return sum.sign();
}

bool one_sign(int a, int b, int c) {
  return (a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0);
}

/// All in one plane; u, v: axes in which the triangle has an area.
bool segment_meets_in_plane(const Vec3& p, const Vec3& q, const Corners3& c, int u, int v) {
  for (const Vec3& x : {p, q})
    if (one_sign(turn(c[0], c[1], x, u, v), turn(c[1], c[2], x, u, v), turn(c[2], c[0], x, u, v)))
      return true;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 &a = c[k], &b = c[(k + 1) % 3];
    const int pa = turn(p, q, a, u, v), pb = turn(p, q, b, u, v), ap = turn(a, b, p, u, v),
              aq = turn(a, b, q, u, v);
    if (pa * pb <= 0 && ap * aq <= 0 && (pa != 0 || pb != 0 || ap != 0 || aq != 0)) return true;
  }
  return false;
}

bool segment_meets(const Vec3& p, const Vec3& q, const Corners3& c) {
  int u = 0, v = 1;
  if (turn(c[0], c[1], c[2], 0, 1) == 0) {
    u = turn(c[0], c[1], c[2], 1, 2) != 0 ? 1 : 2;
    v = u == 1 ? 2 : 0;
    if (turn(c[0], c[1], c[2], u, v) == 0) return false;  // no area: its edges are asked instead
  }
  const int at_p = side_of(c[0], c[1], c[2], p), at_q = side_of(c[0], c[1], c[2], q);
  if (at_p * at_q > 0) return false;
  if (at_p == 0 && at_q == 0) return segment_meets_in_plane(p, q, c, u, v);
  return one_sign(side_of(p, q, c[0], c[1]), side_of(p, q, c[1], c[2]), side_of(p, q, c[2], c[0]));
}

using Long3 = Eigen::Matrix<long double, 3, 1>;

long double point_segment(const Long3& p, const Long3& a, const Long3& b) {
  const Long3 e = b - a;
  const long double l = e.squaredNorm();
  const long double t = l > 0 ? std::clamp<long double>((p - a).dot(e) / l, 0, 1) : 0;
  return (p - a - t * e).norm();
}

long double point_triangle(const Long3& p, const std::array<Long3, 3>& c) {
  long double minimum =
      std::min({point_segment(p, c[0], c[1]), point_segment(p, c[1], c[2]), point_segment(p, c[2], c[0])});
  const Long3 n = (c[1] - c[0]).cross(c[2] - c[0]);
  if (!(n.squaredNorm() > 0)) return minimum;
  bool in = true;
  for (std::size_t k = 0; k < 3; ++k) in &= n.dot((c[(k + 1) % 3] - c[k]).cross(p - c[k])) >= 0;
  return in ? std::min(minimum, std::abs(n.dot(p - c[0])) / n.norm()) : minimum;
}

long double segment_segment(const Long3& p, const Long3& p1, const Long3& q, const Long3& q1) {
  const long double minimum = std::min(
      {point_segment(p, q, q1), point_segment(p1, q, q1), point_segment(q, p, p1), point_segment(q1, p, p1)});
  const Long3 u = p1 - p, v = q1 - q, r = p - q, n = u.cross(v);
  const long double l = n.squaredNorm();
  if (!(l > 0)) return minimum;
  const long double s = v.cross(r).dot(n) / l, t = u.cross(r).dot(n) / l;
  if (s < 0 || s > 1 || t < 0 || t > 1) return minimum;
  return std::min(minimum, std::abs(n.dot(r)) / std::sqrt(l));
}

}  // namespace

bool triangles_meet(const Corners3& t, const Corners3& c) {
  for (std::size_t k = 0; k < 3; ++k)
    if (segment_meets(t[k], t[(k + 1) % 3], c) || segment_meets(c[k], c[(k + 1) % 3], t)) return true;
  return false;
}

double triangle_distance(const Corners3& t, const Corners3& c) {
  if (triangles_meet(t, c)) return 0;
  std::array<Long3, 3> a, b;
  for (std::size_t k = 0; k < 3; ++k) {
    a[k] = t[k].cast<long double>();
    b[k] = c[k].cast<long double>();
  }
  long double minimum = std::numeric_limits<long double>::infinity();
  for (std::size_t i = 0; i < 3; ++i) {
    minimum = std::min({minimum, point_triangle(a[i], b), point_triangle(b[i], a)});
    for (std::size_t j = 0; j < 3; ++j)
      minimum = std::min(minimum, segment_segment(a[i], a[(i + 1) % 3], b[j], b[(j + 1) % 3]));
  }
  return static_cast<double>(minimum);
}

PairAudit audit_pairs(const WaterMesh& mesh, const ObstacleMesh& obstacle, double reach) {
  PairAudit audit;
  proximity::SurfaceTree tree;
  tree.update(obstacle.triangles, obstacle.vertices, obstacle.vertices, Workers(1));
  std::vector<std::uint32_t> near;
  for (const Triangle& t : mesh.triangles) {
    Corners3 own;
    Box box;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto& p = mesh.positions[t[k]];
      own[k] = Vec3(p[0], p[1], p[2]);
      box.add(own[k]);
    }
    near.clear();
    tree.query(box.inflated(reach), near);
    for (std::uint32_t n : near) {
      const Triangle& i = obstacle.triangles[n];
      const Corners3 other = {obstacle.vertices[i[0]], obstacle.vertices[i[1]], obstacle.vertices[i[2]]};
      const double d = triangle_distance(own, other);
      ++audit.pairs;
      audit.meeting += d == 0 && triangles_meet(own, other);
      audit.minimum = std::min(audit.minimum, d);
    }
  }
  return audit;
}

}  // namespace oilskin::test
