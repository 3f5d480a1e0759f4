#include "reconstruction/cell_volume.h"

namespace oilskin::reconstruction {

namespace {

/// The area of the part on the high face of an axis. Runs of inside corners are cut off separately, as by the
/// table.
double area_on_face(std::uint8_t part, int axis, const std::array<Vec3, 12>& at) {
  const FaceCorners corners = face_corners(2 * axis + 1);
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const auto is_inside = [&](std::size_t c) { return part >> corners[c % 4] & 1; };
  const auto place = [&](std::size_t c) {
    const int corner = corners[c % 4];
    return std::array<double, 2>{double(corner >> u & 1), double(corner >> v & 1)};
  };
  const auto crossing = [&](std::size_t c) {  // between corners c and c + 1
    const Vec3& x = at[std::size_t(edge_between(corners[c % 4], corners[(c + 1) % 4]))];
    return std::array<double, 2>{x[u], x[v]};
  };
  const auto cross = [](const std::array<double, 2>& a, const std::array<double, 2>& b,
                        const std::array<double, 2>& c) {
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
  };
  if (is_inside(0) && is_inside(1) && is_inside(2) && is_inside(3)) return 1;
  double twice = 0;
  for (std::size_t first = 0; first < 4; ++first) {
    if (!is_inside(first) || is_inside(first + 3)) continue;
    std::size_t last = first;
    while (is_inside(last + 1)) ++last;
    const auto start = crossing(first + 3);
    auto before = place(first);
    for (std::size_t c = first + 1; c <= last; ++c) {
      twice += cross(start, before, place(c));
      before = place(c);
    }
    twice += cross(start, before, crossing(last));
  }
  return twice / 2;
}

}  // namespace

double part_volume(std::uint8_t part, const std::array<Vec3, 12>& at) {
  // The divergence theorem for x/3. Faces through the first corner contribute nothing.
  double six = 0;
  const CellCase& c = marching_cubes_table()[part];
  for (std::size_t t = 0; t < c.count; ++t)
    six += at[c.triangles[t][0]].dot(at[c.triangles[t][1]].cross(at[c.triangles[t][2]]));
  double areas = 0;
  for (int axis = 0; axis < 3; ++axis) areas += area_on_face(part, axis, at);
  return six / 6 + areas / 3;
}

}  // namespace oilskin::reconstruction
