/// The things in a picture, each as a VTK prop that is updated from frame to frame.
#pragma once

#include <vtkActor.h>
#include <vtkColorTransferFunction.h>
#include <vtkNew.h>
#include <vtkPolyData.h>
#include <vtkScalarBarActor.h>
#include <vtkSmartPointer.h>
#include <vtkTextActor.h>

#include <optional>

#include "geometry/particle_shapes.h"
#include "output/frames.h"

namespace oilskin::demo {

/// From deep blue to pale foam; lightness rises evenly, so that it reads in grey as well.
vtkSmartPointer<vtkColorTransferFunction> water_colours(double from, double to);

/// Particles coloured by the quantity of the view: balls away from sheets, and next to a sheet flat drops
/// that reach no farther towards it than the particle's distance. Whole balls would poke through and look
/// like a leak.
class DrawnWater {
 public:
  explicit DrawnWater(double spacing);
  void update(const FrameData& data);
  /// Shows what lies in the slab, or all without one; after update(), while its data lives.
  void show(const std::optional<Slice>& slice, WaterColour colour, vtkColorTransferFunction* colours);
  void hide();
  vtkActor* balls() { return balls_.actor; }
  vtkActor* film() { return film_.actor; }

 private:
  struct Part {
    vtkNew<vtkPolyData> data;
    vtkNew<vtkActor> actor;
  };
  struct Points;
  void fill(Part& part, const Points& points, vtkColorTransferFunction* colours);

  double spacing_;
  FrameData frame_;
  std::vector<ParticleShape> shapes_;
  Part balls_, film_;
};

enum class SurfaceLook { cloth, body, tank };

/// A cloth or a body, smoothly shaded, its two sides in two tints. Of a tank, only the walls that are seen
/// from inside are drawn, and the rim. In a cut it is the line where it crosses the middle plane.
class DrawnSurface {
 public:
  explicit DrawnSurface(SurfaceLook look);
  /// `wetness`: saturation per node, which darkens it; empty = dry.
  void update(const SurfaceMotion* motion, Span<const float> wetness);
  /// The whole surface, or its line, moved by `lift` [m]; after update(), while its data lives.
  void show(const std::optional<Slice>& slice, const Vec3& lift);
  vtkActor* actor() { return actor_; }
  vtkActor* outline() { return outline_; }
  vtkActor* pins() { return pins_; }
  vtkActor* cut() { return cut_; }

 private:
  void darken(Span<const float> wetness);

  bool is_cloth_, has_border_, built_ = false;
  const SurfaceMotion* motion_ = nullptr;
  vtkNew<vtkPolyData> data_, border_, pinned_, cut_lines_;
  vtkNew<vtkActor> actor_, outline_, pins_, cut_;
};

vtkSmartPointer<vtkScalarBarActor> water_legend(double text_scale);
vtkSmartPointer<vtkTextActor> label(double x, double y, int size, bool bold);

}  // namespace oilskin::demo
