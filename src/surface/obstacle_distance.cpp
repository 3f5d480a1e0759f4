#include "surface/obstacle_distance.h"

#include <algorithm>
#include <cmath>

#include "core/assert.h"
#include "core/closest_point.h"

namespace oilskin::surface {

namespace {

/// Bounds of a triangle [cells].
struct Bounds {
  double low[3], high[3];

  explicit Bounds(const Corners& c) {
    for (int a = 0; a < 3; ++a) {
      low[a] = std::min({c[0][a], c[1][a], c[2][a]});
      high[a] = std::max({c[0][a], c[1][a], c[2][a]});
    }
  }
  bool reaches_block(double by) const {
    for (int a = 0; a < 3; ++a)
      if (low[a] - by > side || high[a] + by < 0) return false;
    return true;
  }
};

/// Nodes 0 … 7 of the block that the inflated box covers.
struct Covered {
  int first[3], last[3];

  Covered(const Bounds& b, double by) {
    for (int a = 0; a < 3; ++a) {
      const double low = b.low[a] - by, high = b.high[a] + by;
      first[a] = low <= 0 ? 0 : (low > side - 1 ? side : static_cast<int>(std::ceil(low)));
      last[a] = high >= side - 1 ? side - 1 : (high < 0 ? -1 : static_cast<int>(std::floor(high)));
    }
  }
  bool empty() const { return first[0] > last[0] || first[1] > last[1] || first[2] > last[2]; }
};

void lower_distances(const Corners& c, const Bounds& bounds, double band, std::vector<float>& distance) {
  const Covered s(bounds, band);
  if (s.empty()) return;
  if (distance.empty()) distance.assign(nodes, std::numeric_limits<float>::infinity());
  Vec3 n = (c[1] - c[0]).cross(c[2] - c[0]);
  const double length = n.norm();
  n = length > 0 ? Vec3(n / length) : Vec3::Zero();
  const double offset = n.dot(c[0]);
  for (int k = s.first[2]; k <= s.last[2]; ++k)
    for (int j = s.first[1]; j <= s.last[1]; ++j) {
      const double row = n.y() * j + n.z() * k - offset;
      const double start = row + n.x() * s.first[0], end = row + n.x() * s.last[0];
      if (std::min(start, end) > band || std::max(start, end) < -band) continue;  // on one side, too far
      for (int i = s.first[0]; i <= s.last[0]; ++i) {
        const Vec3 x(i, j, k);
        float& d = distance[std::size_t(node_index(i, j, k))];
        // Neither through the plane nor through the box can it be nearer than the nearest so far.
        const double least = std::min<double>(band, d), plane = std::abs(n.dot(x) - offset);
        if (plane > least) continue;
        double box = 0;
        for (int a = 0; a < 3; ++a) {
          const double out = std::max({bounds.low[a] - x[a], x[a] - bounds.high[a], 0.0});
          box += out * out;
        }
        if (box > least * least) continue;
        const double now = closest_point(x, c[0], c[1], c[2]).distance;
        if (now <= band) d = std::min(d, static_cast<float>(now));
      }
    }
}

struct Hit {
  int edge;
  float at;
};

/// Crossings of the triangle with the grid lines along `axis`, as long as they lie on the block's edges. The
/// closed triangle counts: a line through an edge meets both triangles there.
void add_crossings(const Corners& c, const Bounds& bounds, const Covered& s, int axis,
                   std::vector<Hit>& hits) {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const double low = bounds.low[axis], high = bounds.high[axis];
  if (low >= side || high < 0) return;
  for (int q = s.first[v]; q <= s.last[v]; ++q)
    for (int p = s.first[u]; p <= s.last[u]; ++p) {
      double area[3];
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 &a = c[(k + 1) % 3], &b = c[(k + 2) % 3];
        area[k] = (a[u] - p) * (b[v] - q) - (a[v] - q) * (b[u] - p);
      }
      const bool in =
          (area[0] >= 0 && area[1] >= 0 && area[2] >= 0) || (area[0] <= 0 && area[1] <= 0 && area[2] <= 0);
      const double sum = area[0] + area[1] + area[2];
      if (!in || sum == 0) continue;
      double x = (area[0] * c[0][axis] + area[1] * c[1][axis] + area[2] * c[2][axis]) / sum;
      x = std::min(std::max(x, low), high);
      if (!(x >= 0 && x < side)) continue;
      const int i = static_cast<int>(x);
      int at[3];
      at[axis] = i;
      at[u] = p;
      at[v] = q;
      hits.push_back({axis * nodes + node_index(at[0], at[1], at[2]), static_cast<float>(x - i)});
    }
}

void keep_crossings(std::vector<Hit>& hits, NearBlock& near) {
  std::sort(hits.begin(), hits.end(),
            [](const Hit& a, const Hit& b) { return a.edge != b.edge ? a.edge < b.edge : a.at < b.at; });
  for (std::size_t h = 0; h < hits.size(); ++h) {
    if (h == 0 || hits[h].edge != hits[h - 1].edge) {
      near.cut_edges.push_back({static_cast<std::uint16_t>(hits[h].edge), hits[h].at, hits[h].at});
      const int axis = hits[h].edge / nodes, node = hits[h].edge % nodes;
      near.cut[std::size_t(axis)][std::size_t(node >> 6)] |= 1ull << (node & 63);
    }
    near.cut_edges.back().last = hits[h].at;
  }
}

}  // namespace

void measure_obstacles(const Obstacles& obstacles, const Vec3& origin, double cell, double band,
                       bool cut_edges, NearBlock& near) {
  OILSKIN_ASSERT(band >= 0 && near.cut_edges.empty());
  std::vector<Hit> hits;
  for (std::uint32_t t : near.triangles) {
    Corners c = obstacles.corners(t);
    for (Vec3& x : c) x = (x - origin) / cell;
    const Bounds bounds(c);
    if (!bounds.reaches_block(band)) continue;
    lower_distances(c, bounds, band, near.distance);
    if (!cut_edges || !bounds.reaches_block(0)) continue;
    const Covered covered(bounds, 0);
    for (int axis = 0; axis < 3; ++axis) add_crossings(c, bounds, covered, axis, hits);
  }
  keep_crossings(hits, near);
}

}  // namespace oilskin::surface
