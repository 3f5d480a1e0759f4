/// The things in a picture, each as a VTK prop that is updated from frame to frame.
#pragma once

#include <vtkActor.h>
#include <vtkColorTransferFunction.h>
#include <vtkNew.h>
#include <vtkPolyData.h>
#include <vtkScalarBarActor.h>
#include <vtkSmartPointer.h>
#include <vtkTextActor.h>

#include "frames.h"

namespace oilskin::demo {

/// From deep blue to pale foam; lightness rises evenly, so that it reads in grey as well.
vtkSmartPointer<vtkColorTransferFunction> speed_colours(double max_speed);

/// Particles coloured by speed: balls where there is room, and next to a sheet flat drops that reach no
/// farther towards it than the particle's distance. Whole balls would poke through and look like a leak.
class DrawnWater {
 public:
  DrawnWater(double spacing, vtkColorTransferFunction* colours);
  void update(const FrameData& data);
  vtkActor* balls() { return balls_.actor; }
  vtkActor* film() { return film_.actor; }

 private:
  struct Part {
    vtkNew<vtkPolyData> data;
    vtkNew<vtkActor> actor;
  };
  struct Points;
  void show(Part& part, const Points& points);

  double spacing_;
  Part balls_, film_;
};

/// A cloth or a body, smoothly shaded, its two sides in two tints.
class DrawnSurface {
 public:
  explicit DrawnSurface(bool is_cloth);
  void update(const SurfaceMotion* motion);
  vtkActor* actor() { return actor_; }
  vtkActor* outline() { return outline_; }
  vtkActor* pins() { return pins_; }

 private:
  bool is_cloth_, built_ = false;
  vtkNew<vtkPolyData> data_, border_, pinned_;
  vtkNew<vtkActor> actor_, outline_, pins_;
};

vtkSmartPointer<vtkScalarBarActor> speed_legend(vtkColorTransferFunction* colours, double text_scale);
vtkSmartPointer<vtkTextActor> label(double x, double y, int size, bool bold);

}  // namespace oilskin::demo
