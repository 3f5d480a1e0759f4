/// The water's surface in a picture.
#pragma once

#include <vtkActor.h>
#include <vtkNew.h>
#include <vtkPolyData.h>
#include <vtkRenderer.h>

#include <optional>

#include "oilskin/reconstruction.h"
#include "scene/scene.h"

namespace oilskin::demo {

/// Physically based: what one sees of water is mostly the sky in it, the more the flatter one looks along it.
class DrawnWaterMesh {
 public:
  DrawnWaterMesh();
  void update(const WaterMesh* mesh);
  /// Opaque, or so that what lies behind shines through; in a cut, the line where it crosses the middle
  /// plane, moved by `lift` [m]. After update(), while its mesh lives.
  void show(WaterLook look, const std::optional<Slice>& slice, const Vec3& lift);
  vtkActor* actor() { return actor_; }
  vtkActor* cut() { return cut_; }

 private:
  const WaterMesh* mesh_ = nullptr;
  vtkNew<vtkPolyData> data_, cut_lines_;
  vtkNew<vtkActor> actor_, cut_;
};

/// The sky that water mirrors: pale above, dim below, with two bright windows.
void add_sky(vtkRenderer* renderer, const Vec3& up);

}  // namespace oilskin::demo
