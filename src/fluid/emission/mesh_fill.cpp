/// Lattice points inside a closed mesh, by winding number along the rows of the lattice.
#include <algorithm>
#include <cmath>

#include "core/assert.h"
#include "core/refuse.h"
#include "core/row_crossing.h"
#include "fluid/emission/emission.h"
#include "fluid/kernels.h"

namespace oilskin::fluid {

namespace {

Status check_mesh(const MeshEmitter& mesh, double spacing) {
  if (!(std::isfinite(spacing) && spacing > 0))
    return refuse_value("mesh emitter: spacing", spacing, "a finite length > 0 m");
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    if (!mesh.vertices[i].allFinite())
      return refuse("mesh emitter: vertex ", i, " is ", mesh.vertices[i].transpose(), "; it must be finite");
  if (mesh.triangles.empty()) return refuse("mesh emitter: the mesh has no triangles");
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    for (const std::uint32_t v : mesh.triangles[i])
      if (v >= mesh.vertices.size())
        return refuse("mesh emitter: triangle ", i, " refers to vertex ", v, "; there are ",
                      mesh.vertices.size());
  return {};
}

/// Points first + (i, j, k) spacing that fill the box, centred.
struct Lattice {
  Vec3 first = Vec3::Zero();
  double spacing = 0;
  std::array<std::int64_t, 3> n{};

  Lattice(const Box& box, double dx) : spacing(dx) {
    for (int k = 0; k < 3; ++k) {
      const double cells = std::max(1.0, std::round((box.max[k] - box.min[k]) / dx));
      n[k] = static_cast<std::int64_t>(std::min(cells, 1e9));
      first[k] = 0.5 * (box.min[k] + box.max[k]) - 0.5 * dx * static_cast<double>(n[k] - 1);
    }
  }
  double at(int axis, std::int64_t i) const { return first[axis] + spacing * static_cast<double>(i); }
  double rows() const { return static_cast<double>(n[1]) * static_cast<double>(n[2]); }
  double size() const { return static_cast<double>(n[0]) * rows(); }
};

struct Crossing {
  double x;
  int sign;
};

/// Crossings of the mesh with all rows of the lattice; row (j, k) has the number j + n_y k.
class RowCrossings {
 public:
  RowCrossings(const MeshEmitter& mesh, const Lattice& lattice) : begin_(lattice.n[1] * lattice.n[2] + 1) {
    for_all(mesh, lattice, [&](std::size_t row, const Crossing&) { ++begin_[row + 1]; });
    for (std::size_t r = 1; r < begin_.size(); ++r) begin_[r] += begin_[r - 1];
    crossings_.resize(begin_.back());
    std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
    for_all(mesh, lattice, [&](std::size_t row, const Crossing& c) { crossings_[next[row]++] = c; });
  }

  Span<Crossing> row(std::size_t r) {
    OILSKIN_ASSERT(r + 1 < begin_.size());
    return {crossings_.data() + begin_[r], begin_[r + 1] - begin_[r]};
  }

 private:
  template <class F>
  static void for_all(const MeshEmitter& mesh, const Lattice& lattice, const F& f) {
    for (const Triangle& t : mesh.triangles) {
      const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
      std::array<std::int64_t, 3> low{}, high{};
      for (int k = 1; k < 3; ++k) {  // one more row on either side, against rounding
        const double min = std::min({a[k], b[k], c[k]}), max = std::max({a[k], b[k], c[k]});
        low[k] = std::max<std::int64_t>(0, std::llround((min - lattice.first[k]) / lattice.spacing - 1));
        high[k] =
            std::min(lattice.n[k] - 1,
                     static_cast<std::int64_t>(std::llround((max - lattice.first[k]) / lattice.spacing + 1)));
      }
      for (std::int64_t k = low[2]; k <= high[2]; ++k)
        for (std::int64_t j = low[1]; j <= high[1]; ++j) {
          const double y = lattice.at(1, j), z = lattice.at(2, k);
          if (const int s = row_sign(a, b, c, y, z); s != 0)
            f(static_cast<std::size_t>(j + lattice.n[1] * k), Crossing{row_x(a, b, c, y, z), s});
        }
    }
  }

  std::vector<std::size_t> begin_;
  std::vector<Crossing> crossings_;
};

/// Generalised winding number: Σ Ω/4π [Jacobson2013], solid angles by [Oosterom1983] (F.42).
double winding_number(const MeshEmitter& mesh, const Vec3& x) {
  double sum = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 a = mesh.vertices[t[0]] - x, b = mesh.vertices[t[1]] - x, c = mesh.vertices[t[2]] - x;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    sum += std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return sum / (2 * pi);
}

/// Along a row the winding number changes by ±1 at every crossing and must end at 0. Where it does not, as
/// the mesh is open or inconsistently oriented, each point of the row is decided by the generalised winding
/// number.
void fill_row(const MeshEmitter& mesh, const Lattice& lattice, Span<Crossing> crossings, double y, double z,
              std::vector<Vec3>& points) {
  int total = 0;
  for (const Crossing& c : crossings) total += c.sign;
  std::sort(crossings.begin(), crossings.end(),
            [](const Crossing& a, const Crossing& b) { return a.x < b.x; });
  int winding = 0;
  const Crossing* next = crossings.begin();
  for (std::int64_t i = 0; i < lattice.n[0]; ++i) {
    const Vec3 p(lattice.at(0, i), y, z);
    for (; next != crossings.end() && next->x < p[0]; ++next) winding += next->sign;
    const bool inside = total == 0 ? winding != 0 : std::abs(winding_number(mesh, p)) > 0.5;
    if (inside) points.push_back(p);
  }
}

}  // namespace

Status lattice_inside(const MeshEmitter& mesh, double spacing, std::vector<Vec3>* points) {
  points->clear();
  Status status = check_mesh(mesh, spacing);
  if (!status.ok()) return status;
  Box box;
  for (const Triangle& t : mesh.triangles)
    for (const std::uint32_t v : t) box.add(mesh.vertices[v]);
  const Lattice lattice(box, spacing);
  if (!(lattice.size() <= 1e9 && lattice.rows() <= 1e8)) {
    return refuse("mesh emitter: the box of the mesh holds ", lattice.size(),
                  " points of the lattice; at most 1e9");
  }
  RowCrossings crossings(mesh, lattice);
  for (std::int64_t k = 0; k < lattice.n[2]; ++k)
    for (std::int64_t j = 0; j < lattice.n[1]; ++j) {
      fill_row(mesh, lattice, crossings.row(static_cast<std::size_t>(j + lattice.n[1] * k)), lattice.at(1, j),
               lattice.at(2, k), *points);
      if (static_cast<double>(points->size()) <= most_points) continue;
      *points = {};
      return refuse("mesh emitter: more than 5e7 particles; use a smaller mesh or a larger spacing");
    }
  return {};
}

}  // namespace oilskin::fluid
