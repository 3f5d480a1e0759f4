/// Our arrays as VTK's.
#pragma once

#include <vtkCellArray.h>
#include <vtkPoints.h>
#include <vtkSmartPointer.h>

#include "oilskin/types.h"

namespace oilskin::demo {

inline vtkSmartPointer<vtkPoints> to_vtk(Span<const Vec3> x, int scalar_type) {
  auto points = vtkSmartPointer<vtkPoints>::New();
  points->SetDataType(scalar_type);
  points->SetNumberOfPoints(static_cast<vtkIdType>(x.size()));
  for (std::size_t i = 0; i < x.size(); ++i) points->SetPoint(static_cast<vtkIdType>(i), x[i].data());
  return points;
}

inline vtkSmartPointer<vtkCellArray> to_vtk(Span<const Triangle> triangles) {
  auto cells = vtkSmartPointer<vtkCellArray>::New();
  for (const Triangle& t : triangles)
    cells->InsertNextCell({vtkIdType(t[0]), vtkIdType(t[1]), vtkIdType(t[2])});
  return cells;
}

inline vtkSmartPointer<vtkCellArray> vertex_cells(std::size_t count) {
  auto cells = vtkSmartPointer<vtkCellArray>::New();
  for (std::size_t i = 0; i < count; ++i) cells->InsertNextCell({vtkIdType(i)});
  return cells;
}

}  // namespace oilskin::demo
