/// A surface that stands still: walls and floors for tests and benchmarks.
#pragma once

#include "oilskin/surface_motion.h"

namespace oilskin::test {

class StaticMesh : public SurfaceHost {
 public:
  std::vector<Vec3> nodes;
  std::vector<Triangle> triangles;
  /// Whether the nodes change while attached: it compares them in every step; they do not; or it gives
  /// them no number, and the world reads them in every step.
  enum class Changes { compared, never, unknown } changes = Changes::compared;
  bool solid = false;  ///< SurfaceMotion::solid

  /// Two triangles a cell over corner + s·u + t·v.
  void add_rectangle(const Vec3& corner, const Vec3& u, const Vec3& v, std::uint32_t nu = 1,
                     std::uint32_t nv = 1) {
    const auto first = static_cast<std::uint32_t>(nodes.size());
    for (std::uint32_t j = 0; j <= nv; ++j)
      for (std::uint32_t i = 0; i <= nu; ++i)
        nodes.push_back(corner + u * (double(i) / nu) + v * (double(j) / nv));
    for (std::uint32_t j = 0; j < nv; ++j)
      for (std::uint32_t i = 0; i < nu; ++i) {
        const std::uint32_t a = first + i + (nu + 1) * j, b = a + 1, c = a + nu + 1, d = c + 1;
        triangles.push_back({a, b, d});
        triangles.push_back({a, d, c});
      }
  }
  /// The six sides of a box, cells no larger than `cell`.
  void add_box(const Box& box, double cell) {
    const Vec3 e = box.max - box.min, x(e.x(), 0, 0), y(0, e.y(), 0), z(0, 0, e.z());
    const auto cells = [&](double length) {
      return static_cast<std::uint32_t>(std::max(1.0, std::ceil(length / cell)));
    };
    for (const Vec3& at : {box.min, Vec3(box.min + z)}) add_rectangle(at, x, y, cells(e.x()), cells(e.y()));
    for (const Vec3& at : {box.min, Vec3(box.min + y)}) add_rectangle(at, x, z, cells(e.x()), cells(e.z()));
    for (const Vec3& at : {box.min, Vec3(box.min + x)}) add_rectangle(at, y, z, cells(e.y()), cells(e.z()));
  }

  Gathered gather(double, SurfaceMotion& m) override {
    const std::uint64_t number = changes == Changes::unknown ? 0 : present_revision();
    if (number != 0 && m.revision == number) return {Status{}, false, true};
    m.revision = number;
    const bool is_new = m.triangles.size() != triangles.size();
    if (is_new) m.triangles = triangles;
    m.storage = Storage::float64;
    m.solid = solid;
    m.x_t1 = nodes;
    m.velocity.assign(nodes.size(), Vec3::Zero());
    m.inverse_mass.assign(nodes.size(), 0);
    m.holdable.assign(nodes.size(), 0);
    return {Status{}, is_new};
  }
  void scatter(SurfaceMotion&) override {}

 private:
  std::uint64_t present_revision() {
    if (revision_ == 0 ||
        (changes == Changes::compared && (seen_ != nodes || seen_triangles_ != triangles))) {
      ++revision_;
      seen_ = nodes;
      seen_triangles_ = triangles;
    }
    return revision_;
  }

  std::uint64_t revision_ = 0;
  std::vector<Vec3> seen_;
  std::vector<Triangle> seen_triangles_;
};

/// A sheet that slides along x at a constant speed.
class SlidingMesh : public StaticMesh {
 public:
  double speed = 0;  ///< [m/s]

  Gathered gather(double dt, SurfaceMotion& m) override {
    for (Vec3& x : nodes) x.x() += dt * speed;
    Gathered gathered = StaticMesh::gather(dt, m);
    m.velocity.assign(nodes.size(), Vec3(speed, 0, 0));
    return gathered;
  }
};

}  // namespace oilskin::test
