#include "reconstruction/obstacle_distance.h"

#include <algorithm>
#include <cmath>

#include "core/assert.h"
#include "core/closest_point.h"
#include "core/simd.h"

namespace oilskin::reconstruction {

using simd::F8;

namespace {

struct Bounds {
  double low[3], high[3];

  explicit Bounds(const Corners& c) {
    for (int a = 0; a < 3; ++a) {
      low[a] = std::min({c[0][a], c[1][a], c[2][a]});
      high[a] = std::max({c[0][a], c[1][a], c[2][a]});
    }
  }
  /// Squares of lower bounds of the distance from the rows j = 0 … 7 of a slice.
  F8 squared_from_rows(int k) const {
    const F8 j = F8::load(row_nodes);
    const double x = std::max({0.0, low[0] - (side - 1), -high[0]}),
                 z = std::max({0.0, low[2] - k, k - high[2]});
    const F8 y = positive_part(larger(static_cast<float>(low[1]) - j, j - static_cast<float>(high[1])));
    return y * y + static_cast<float>(x * x + z * z);
  }
  bool reaches_block(double by) const {
    for (int a = 0; a < 3; ++a)
      if (low[a] - by > side || high[a] + by < 0) return false;
    return true;
  }
};

/// Nodes 0 … 7 of the block in the inflated box.
struct Covered {
  int first[3], last[3];

  Covered(const Bounds& b, double by) : Covered(b, Vec3::Constant(by)) {}
  Covered(const Bounds& b, const Vec3& by) {
    for (int a = 0; a < 3; ++a) {
      const double low = b.low[a] - by[a], high = b.high[a] + by[a];
      first[a] = low <= 0 ? 0 : (low > side - 1 ? side : static_cast<int>(std::ceil(low)));
      last[a] = high >= side - 1 ? side - 1 : (high < 0 ? -1 : static_cast<int>(std::floor(high)));
    }
  }
  bool empty() const { return first[0] > last[0] || first[1] > last[1] || first[2] > last[2]; }
};

/// Distances of a row of nodes from a triangle.
struct RowView {
  F8 min_squared;           ///< lower bounds of the squared distances
  std::uint32_t over_face;  ///< bit i: the distance is that from the plane
};

/// The triangle's plane, and the planes through its edges that are perpendicular to it, with outward normals.
class TrianglePlanes {
 public:
  explicit TrianglePlanes(const Corners& c) {
    const std::array<Vec3, 3> edges = {c[1] - c[0], c[2] - c[1], c[0] - c[2]};
    const Vec3 cross = edges[0].cross(edges[1]);
    double size = 2 * side, longest_squared = 0;
    std::array<double, 3> squared{};
    for (std::size_t k = 0; k < 3; ++k) {
      size = std::max(size, c[k].cwiseAbs().maxCoeff());
      squared[k] = edges[k].squaredNorm();
      longest_squared = std::max(longest_squared, squared[k]);
    }
    const double smallest = 1e-9 * size * size, cross_squared = cross.squaredNorm();
    // The planes of a sliver are too inaccurate; zeros give the bound 0.
    if (!(cross_squared > smallest * smallest * longest_squared)) return;
    const Vec3 n = cross * (1 / std::sqrt(cross_squared));
    planes_[0] = {n, n.dot(c[0])};
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 out = edges[k].cross(n) * (1 / std::sqrt(squared[k]));
      planes_[k + 1] = {out, out.dot(c[k])};
    }
  }
  /// Of the nodes of a slice: heights over the planes at j = 0.
  struct Slice {
    F8 above[4];
  };
  Slice slice(int k) const {
    Slice s;
    for (std::size_t p = 0; p < 4; ++p)
      s.above[p] = F8::load(row_nodes) * static_cast<float>(planes_[p].normal.x()) +
                   static_cast<float>(planes_[p].at(0, 0, k));
    return s;
  }
  RowView row(const Slice& slice, int j) const {
    F8 above[4];
    for (std::size_t p = 0; p < 4; ++p)
      above[p] = slice.above[p] + static_cast<float>(planes_[p].normal.y()) * static_cast<float>(j);
    const F8 beyond = larger(larger(above[1], above[2]), above[3]),
             off = positive_part(larger(above[0], 0.0f - above[0]) - rounding),
             beside = positive_part(beyond - rounding);
    return {off * off + beside * beside, greater_mask(-rounding, beyond)};
  }
  /// Of the rows j = 0 … 7 of a slice, lower bounds for all of their nodes: the distance from the layer, and
  /// how far they are beyond a side (negative within all).
  struct Rows {
    F8 off, beside;
  };
  Rows rows(int k) const {
    F8 low[4], high;
    for (std::size_t p = 0; p < 4; ++p) {
      const Vec3& n = planes_[p].normal;
      const double along = (side - 1) * n.x(), at = planes_[p].at(0, 0, k);
      const F8 at_rows = F8::load(row_nodes) * static_cast<float>(n.y());
      low[p] = at_rows + static_cast<float>(at + std::min(0.0, along));
      if (p == 0) high = at_rows + static_cast<float>(at + std::max(0.0, along));
    }
    return {larger(low[0], 0.0f - high), larger(larger(low[1], low[2]), low[3])};
  }
  double distance_to_plane(int i, int j, int k) const { return std::abs(planes_[0].at(i, j, k)); }
  const Vec3& normal() const { return planes_[0].normal; }

 private:
  static constexpr float rounding = 1e-5f;  // of the sums in floats
  struct Plane {
    Vec3 normal = Vec3::Zero();
    double offset = 0;
    double at(int i, int j, int k) const { return normal.x() * i + normal.y() * j + normal.z() * k - offset; }
  };
  std::array<Plane, 4> planes_;
};

/// Distances of a block's nodes. First those over faces: they are the nearest ones of most nodes, and as
/// bounds exclude most of the other pairs.
class NodeDistances {
 public:
  NodeDistances(double band, std::vector<float>& distance) : band_(band), distance_(distance) {
    farthest_.fill(static_cast<float>(band));
  }

  void add(const Corners& c, const Bounds& bounds) {
    const Covered covered(bounds, band_);
    if (covered.empty()) return;
    if (distance_.empty()) distance_.assign(nodes, std::numeric_limits<float>::infinity());
    measure_face(near_.emplace_back(c, bounds, covered));
  }
  void finish() {
    for (const Near& n : near_) measure_beside(n);
  }

 private:
  struct Near {
    Corners c;
    Bounds bounds;
    Covered covered;
    TrianglePlanes planes;

    Near(const Corners& corners, const Bounds& b, const Covered& nodes)
        : c(corners), bounds(b), covered(nodes), planes(corners) {}
  };
  static unsigned bits(int first, int last) { return (2u << last) - (1u << first); }

  void measure_face(const Near& n) {
    const Covered over_face(n.bounds,
                            band_ * n.planes.normal().cwiseAbs() + Vec3::Constant(double(rounding)));
    if (over_face.empty()) return;
    measure(
        n, over_face, true,
        [&](int k, std::uint32_t, F8 most) {
          const TrianglePlanes::Rows from = n.planes.rows(k);
          return greater_mask(from.beside, rounding) | greater_mask(from.off, most);
        },
        [&](int i, int j, int k) { return n.planes.distance_to_plane(i, j, k); });
  }
  void measure_beside(const Near& n) {
    measure(
        n, n.covered, false,
        [&](int k, std::uint32_t rows, F8 most) {
          const std::uint32_t far = greater_mask(n.bounds.squared_from_rows(k), most * most);
          if ((rows & ~far) == 0) return far;
          const TrianglePlanes::Rows from = n.planes.rows(k);
          return far | greater_mask(larger(from.off, from.beside), most);
        },
        [&](int i, int j, int k) { return closest_point(Vec3(i, j, k), n.c[0], n.c[1], n.c[2]).distance; });
  }
  /// Of the nodes `s`. `too_far(k, rows, farthest)`: of these rows of slice k those without a node that
  /// counts; `distance_to(i, j, k)` of a node over the face, or of the others.
  template <class TooFar, class DistanceTo>
  void measure(const Near& n, const Covered& s, bool over_face, const TooFar& too_far,
               const DistanceTo& distance_to) {
    for (int k = s.first[2]; k <= s.last[2]; ++k) {
      const F8 most = F8::load(&farthest_[std::size_t(side * k)]) + rounding;
      std::uint32_t rows = bits(s.first[1], s.last[1]);
      rows &= ~too_far(k, rows, most);
      if (rows == 0) continue;
      const TrianglePlanes::Slice slice = n.planes.slice(k);
      for (; rows != 0; rows &= rows - 1) {
        const int j = __builtin_ctz(rows);
        float* const row = &distance_[std::size_t(node_index(0, j, k))];
        const std::uint32_t may = may_be_nearer(s, n.planes.row(slice, j), row, over_face);
        for (std::uint32_t at = may; at != 0; at &= at - 1) {
          const int i = __builtin_ctz(at);
          lower(row[i], distance_to(i, j, k));
        }
        if (may != 0) set_farthest(j, k, row);
      }
    }
  }
  /// The nodes of a row for which the triangle may be the nearest one: those over its face, or the others.
  std::uint32_t may_be_nearer(const Covered& s, const RowView& view, const float* row, bool over_face) const {
    const F8 now = F8::load(row);
    const std::uint32_t chosen = over_face ? view.over_face : ~view.over_face;
    return bits(s.first[0], s.last[0]) & chosen &
           ~(greater_mask(view.min_squared, now * now) | greater_mask(view.min_squared, band_squared_));
  }
  void set_farthest(int j, int k, const float* row) {
    farthest_[std::size_t(j + side * k)] =
        std::min(static_cast<float>(band_), *std::max_element(row, row + side));
  }
  void lower(float& d, double to) const {
    if (to <= band_) d = std::min(d, static_cast<float>(to));
  }
  static constexpr float rounding = 1e-3f;
  double band_;
  float band_squared_ = static_cast<float>(band_ * band_ * (1 + 1e-6));
  std::vector<float>& distance_;
  std::array<float, side * side> farthest_;  // per row: no node has a distance above this that counts
  std::vector<Near> near_;
};

struct Hit {
  int edge;
  float at;
};

/// Crossings of the closed triangle with grid lines along `axis`, on edges that the block owns. A line
/// through an edge of the mesh crosses both triangles there.
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

/// Triangles closer than the nearest one by less than this are as near [cells]: rounding of distances.
constexpr double as_near = 1e-4;

/// Raises the wetness of the nodes that a triangle influences.
class NodeWetness {
 public:
  NodeWetness(const WetRule& rule, NearBlock& near) : rule_(rule), near_(near) {}

  void add(const Corners& c, const std::array<float, 3>& saturation) {
    const Bounds bounds(c);
    if (!bounds.reaches_block(rule_.range + rule_.fade)) return;
    const Covered s(bounds, rule_.range + rule_.fade);
    if (s.empty()) return;
    const TrianglePlanes planes(c);
    const unsigned covered = (2u << s.last[0]) - (1u << s.first[0]);
    for (int k = s.first[2]; k <= s.last[2]; ++k) {
      const TrianglePlanes::Slice slice = planes.slice(k);
      for (int j = s.first[1]; j <= s.last[1]; ++j) {
        const F8 farthest = F8::load(&near_.distance[std::size_t(node_index(0, j, k))]) +
                            static_cast<float>(rule_.fade + 2 * as_near);
        const std::uint32_t may =
            covered & ~greater_mask(planes.row(slice, j).min_squared, farthest * farthest);
        for (std::uint32_t bits = may; bits != 0; bits &= bits - 1)
          raise(__builtin_ctz(bits), j, k, c, saturation);
      }
    }
  }

 private:
  void raise(int i, int j, int k, const Corners& c, const std::array<float, 3>& saturation) {
    const auto n = std::size_t(node_index(i, j, k));
    const double nearest = near_.distance[n];
    if (!(nearest < rule_.range)) return;
    const ClosestPoint at = closest_point(Vec3(i, j, k), c[0], c[1], c[2]);
    const double beyond = std::max(0.0, at.distance - nearest - as_near);
    if (!(beyond < rule_.fade)) return;
    double s = 0;
    for (std::size_t corner = 0; corner < 3; ++corner) s += at.weights[corner] * double(saturation[corner]);
    const double wet = rule_.share(s) * (1 - beyond / rule_.fade);
    if (near_.wetness.empty()) near_.wetness.assign(nodes, 0.0f);
    near_.wetness[n] = std::max(near_.wetness[n], static_cast<float>(wet));
  }

  const WetRule& rule_;
  NearBlock& near_;
};

}  // namespace

double WetRule::share(double saturation) const {
  if (saturation >= wet_from) return 1;
  if (saturation <= dry_to) return 0;
  const double t = (saturation - dry_to) / (wet_from - dry_to);
  return t * t * (3 - 2 * t);
}

void measure_wetness(const Obstacles& obstacles, const Vec3& origin, double cell, const WetRule& rule,
                     NearBlock& near) {
  OILSKIN_ASSERT(near.wetness.empty() && rule.range >= 0);
  if (near.distance.empty() || rule.range == 0) return;
  OILSKIN_ASSERT(rule.fade > 0);
  NodeWetness wetness(rule, near);
  for (std::uint32_t t : near.triangles) {
    const Triangle& i = obstacles.indices(t);
    const std::array<float, 3> s = {obstacles.saturation(i[0]), obstacles.saturation(i[1]),
                                    obstacles.saturation(i[2])};
    if (rule.share(std::max({s[0], s[1], s[2]})) == 0) continue;
    Corners c = obstacles.corners(t);
    for (Vec3& x : c) x = (x - origin) / cell;
    wetness.add(c, s);
  }
}

void measure_obstacles(const Obstacles& obstacles, const Vec3& origin, double cell, double band,
                       bool cut_edges, NearBlock& near) {
  OILSKIN_ASSERT(band >= 0 && near.cut_edges.empty());
  std::vector<Hit> hits;
  NodeDistances distances(band, near.distance);
  for (std::uint32_t t : near.triangles) {
    Corners c = obstacles.corners(t);
    for (Vec3& x : c) x = (x - origin) / cell;
    const Bounds bounds(c);
    if (!bounds.reaches_block(band)) continue;
    distances.add(c, bounds);
    if (!cut_edges || !bounds.reaches_block(0)) continue;
    const Covered covered(bounds, 0);
    for (int axis = 0; axis < 3; ++axis) add_crossings(c, bounds, covered, axis, hits);
  }
  distances.finish();
  keep_crossings(hits, near);
}

}  // namespace oilskin::reconstruction
