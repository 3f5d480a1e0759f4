/// A cut through a mesh.
#pragma once

#include <vtkPolyData.h>

#include "oilskin/types.h"
#include "scene/scene.h"

namespace oilskin::demo {

/// Height over the middle plane of a cut [m].
double height_over(const Slice& slice, const Vec3& x);

/// The lines where triangles cross the middle plane of a cut, moved by `lift` [m].
void draw_cut(const Slice& slice, Span<const Vec3> vertices, Span<const Triangle> triangles, const Vec3& lift,
              vtkPolyData* lines);

}  // namespace oilskin::demo
