#include "render/picture_cut.h"

#include "render/vtk_convert.h"

namespace oilskin::demo {
namespace {

/// Where the edge from a to b crosses the middle plane; false when it does not.
bool meets_plane(const Slice& slice, const Vec3& a, const Vec3& b, Vec3* point) {
  const double ha = height_over(slice, a), hb = height_over(slice, b);
  if ((ha < 0) == (hb < 0)) return false;
  *point = a + (b - a) * (ha / (ha - hb));
  return true;
}

}  // namespace

double height_over(const Slice& slice, const Vec3& x) {
  return (x - slice.point).dot(slice.normal.normalized());
}

void draw_cut(const Slice& slice, Span<const Vec3> vertices, Span<const Triangle> triangles, const Vec3& lift,
              vtkPolyData* drawn) {
  std::vector<Vec3> points;
  auto lines = vtkSmartPointer<vtkCellArray>::New();
  for (const Triangle& t : triangles) {
    const std::size_t first = points.size();
    Vec3 point;
    for (int k = 0; k < 3; ++k)
      if (meets_plane(slice, vertices[t[k]], vertices[t[(k + 1) % 3]], &point))
        points.push_back(point + lift);
    if (points.size() == first + 2) lines->InsertNextCell({vtkIdType(first), vtkIdType(first + 1)});
  }
  drawn->SetPoints(to_vtk(points, VTK_FLOAT));
  drawn->SetLines(lines);
  drawn->SetVerts(vertex_cells(points.size()));  // closes the seams between thick lines
  drawn->Modified();
}

}  // namespace oilskin::demo
