#include "render/picture_parts.h"

#include <vtkFloatArray.h>
#include <vtkGlyph3DMapper.h>
#include <vtkOpenGLSphereMapper.h>
#include <vtkPointData.h>
#include <vtkPolyDataMapper.h>
#include <vtkPolyDataNormals.h>
#include <vtkProperty.h>
#include <vtkSphereSource.h>
#include <vtkTextProperty.h>
#include <vtkUnsignedCharArray.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

#include "render/picture_cut.h"
#include "render/vtk_convert.h"
#include "scene/views.h"

namespace oilskin::demo {
namespace {

constexpr double ink[3] = {0.13, 0.15, 0.19};

/// Edges of one triangle only.
vtkSmartPointer<vtkCellArray> border_edges(const std::vector<Triangle>& triangles) {
  std::map<std::array<std::uint32_t, 2>, int> count;
  for (const Triangle& t : triangles)
    for (int k = 0; k < 3; ++k) ++count[{std::min(t[k], t[(k + 1) % 3]), std::max(t[k], t[(k + 1) % 3])}];
  auto cells = vtkSmartPointer<vtkCellArray>::New();
  for (const auto& [edge, times] : count)
    if (times == 1) cells->InsertNextCell({vtkIdType(edge[0]), vtkIdType(edge[1])});
  return cells;
}

void colour_surface(vtkActor* actor, bool is_cloth) {
  vtkProperty* front = actor->GetProperty();
  if (is_cloth) {
    front->SetColor(0.93, 0.76, 0.62);
  } else {
    front->SetColor(0.86, 0.87, 0.89);
  }
  front->SetInterpolationToPhong();
  front->SetAmbient(0.18);
  front->SetDiffuse(0.85);
  front->SetSpecular(0.12);
  front->SetSpecularPower(18);
  vtkNew<vtkProperty> back;
  back->DeepCopy(front);
  if (is_cloth) back->SetColor(0.86, 0.52, 0.40);
  actor->SetBackfaceProperty(back);
}

}  // namespace

vtkSmartPointer<vtkColorTransferFunction> water_colours(double from, double to) {
  auto colours = vtkSmartPointer<vtkColorTransferFunction>::New();
  colours->SetColorSpaceToLab();
  for (int i = 0; i < 6; ++i)
    colours->AddRGBPoint(from + (to - from) * i / 5, water_colour_stops[i][0], water_colour_stops[i][1],
                         water_colour_stops[i][2]);
  return colours;
}

namespace {

void colour_by_value(vtkMapper* mapper) {
  mapper->SetScalarModeToUsePointFieldData();
  mapper->SelectColorArray("value");
  mapper->UseLookupTableScalarRangeOn();
}

double value_of(const FrameData& frame, WaterColour colour, std::size_t i) {
  switch (colour) {
    case WaterColour::pressure:
      return frame.pressure[i];
    case WaterColour::density:
      return frame.density[i];
    case WaterColour::speed:
      break;
  }
  return frame.velocity[i].norm();
}

void shine(vtkActor* actor) {
  actor->GetProperty()->SetAmbient(0.25);
  actor->GetProperty()->SetDiffuse(0.8);
  actor->GetProperty()->SetSpecular(0.35);
  actor->GetProperty()->SetSpecularPower(30);
}

vtkSmartPointer<vtkGlyph3DMapper> drop_mapper(vtkPolyData* data) {
  vtkNew<vtkSphereSource> drop;
  drop->SetRadius(1);
  drop->SetThetaResolution(14);
  drop->SetPhiResolution(9);
  auto mapper = vtkSmartPointer<vtkGlyph3DMapper>::New();
  mapper->SetInputData(data);
  mapper->SetSourceConnection(drop->GetOutputPort());
  mapper->SetScaleArray("half_axes");
  mapper->SetScaleModeToScaleByVectorComponents();
  mapper->SetOrientationArray("normal");
  mapper->SetOrientationModeToDirection();
  return mapper;
}

}  // namespace

struct DrawnWater::Points {
  std::vector<Vec3> position;
  vtkNew<vtkFloatArray> value, shape, normal;

  Points(const char* shape_name, int components) {
    value->SetName("value");
    shape->SetName(shape_name);
    shape->SetNumberOfComponents(components);
    normal->SetName("normal");
    normal->SetNumberOfComponents(3);
  }
};

DrawnWater::DrawnWater(double spacing) : spacing_(spacing) {
  vtkNew<vtkOpenGLSphereMapper> balls;
  balls->SetInputData(balls_.data);
  balls->SetScaleArray("radius");
  colour_by_value(balls);
  balls_.actor->SetMapper(balls);
  const auto drops = drop_mapper(film_.data);
  colour_by_value(drops);
  film_.actor->SetMapper(drops);
  shine(balls_.actor);
  shine(film_.actor);
}

void DrawnWater::fill(Part& part, const Points& points, vtkColorTransferFunction* colours) {
  part.data->SetPoints(to_vtk(points.position, VTK_FLOAT));
  part.data->SetVerts(vertex_cells(points.position.size()));
  part.data->GetPointData()->AddArray(points.value);
  part.data->GetPointData()->AddArray(points.shape);
  part.data->GetPointData()->AddArray(points.normal);
  part.data->Modified();
  part.actor->GetMapper()->SetLookupTable(colours);
  part.actor->SetVisibility(!points.position.empty());
}

void DrawnWater::update(const FrameData& frame) {
  std::vector<const SurfaceMotion*> surfaces = frame.cloth;
  surfaces.insert(surfaces.end(), frame.bodies.begin(), frame.bodies.end());
  frame_ = frame;
  shapes_ = particle_shapes(frame.position, surfaces, spacing_);
}

void DrawnWater::hide() {
  balls_.actor->VisibilityOff();
  film_.actor->VisibilityOff();
}

void DrawnWater::show(const std::optional<Slice>& slice, WaterColour colour,
                      vtkColorTransferFunction* colours) {
  Points balls("radius", 1), film("half_axes", 3);
  for (std::size_t i = 0; i < shapes_.size(); ++i) {
    const Vec3& x = frame_.position[i];
    if (slice && std::abs(height_over(*slice, x)) > 0.5 * slice->thickness) continue;
    const ParticleShape& shape = shapes_[i];
    Points& points = shape.ball ? balls : film;
    points.position.push_back(x);
    points.value->InsertNextValue(static_cast<float>(value_of(frame_, colour, i)));
    if (shape.ball) {
      balls.shape->InsertNextValue(static_cast<float>(0.5 * spacing_));
      balls.normal->InsertNextTuple3(0, 1, 0);
    } else {
      film.shape->InsertNextTuple3(shape.height, shape.radius, shape.radius);
      film.normal->InsertNextTuple3(shape.normal.x(), shape.normal.y(), shape.normal.z());
    }
  }
  fill(balls_, balls, colours);
  fill(film_, film, colours);
}

DrawnSurface::DrawnSurface(SurfaceLook look)
    : is_cloth_(look == SurfaceLook::cloth), has_border_(look != SurfaceLook::body) {
  vtkNew<vtkPolyDataNormals> normals;
  normals->SetInputData(data_);
  normals->SplittingOff();
  normals->ConsistencyOff();
  if (!is_cloth_) {
    normals->SplittingOn();
    normals->SetFeatureAngle(40);
  }
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputConnection(normals->GetOutputPort());
  mapper->ScalarVisibilityOff();
  actor_->SetMapper(mapper);
  colour_surface(actor_, is_cloth_);
  actor_->GetProperty()->SetBackfaceCulling(look == SurfaceLook::tank);

  vtkNew<vtkPolyDataMapper> lines;
  lines->SetInputData(border_);
  outline_->SetMapper(lines);
  outline_->GetProperty()->SetColor(ink[0], ink[1], ink[2]);
  outline_->GetProperty()->SetLineWidth(3);
  outline_->GetProperty()->LightingOff();

  vtkNew<vtkPolyDataMapper> dots;
  dots->SetInputData(pinned_);
  pins_->SetMapper(dots);
  pins_->GetProperty()->SetColor(ink[0], ink[1], ink[2]);
  pins_->GetProperty()->SetPointSize(8);
  pins_->GetProperty()->RenderPointsAsSpheresOn();

  vtkNew<vtkPolyDataMapper> cuts;
  cuts->SetInputData(cut_lines_);
  cut_->SetMapper(cuts);
  cut_->GetProperty()->SetColor(is_cloth_ ? 0.78 : 0.45, is_cloth_ ? 0.30 : 0.46, is_cloth_ ? 0.16 : 0.50);
  cut_->GetProperty()->SetLineWidth(5);
  cut_->GetProperty()->SetPointSize(5);
  cut_->GetProperty()->LightingOff();
}

void DrawnSurface::show(const std::optional<Slice>& slice, const Vec3& lift) {
  const bool there = motion_ != nullptr;
  actor_->SetVisibility(there && !slice);
  outline_->SetVisibility(there && !slice && has_border_);
  pins_->SetVisibility(there && !slice && is_cloth_);
  cut_->SetVisibility(there && slice.has_value());
  if (!there || !slice) return;
  draw_cut(*slice, motion_->x_t1, motion_->triangles, lift, cut_lines_);
}

/// One colour for both sides: scalars replace that of the back, too.
void DrawnSurface::darken(Span<const float> wetness) {
  vtkMapper* const mapper = actor_->GetMapper();
  mapper->SetScalarVisibility(!wetness.empty());
  if (wetness.empty()) return;
  vtkNew<vtkUnsignedCharArray> colours;
  colours->SetNumberOfComponents(3);
  for (const float s : wetness) {
    const double light = 255 * (1 - 0.6 * static_cast<double>(std::min(std::max(s, 0.0f), 1.0f)));
    const double colour[3] = {light * 0.90, light * 0.68, light * 0.54};
    colours->InsertNextTuple(colour);
  }
  data_->GetPointData()->SetScalars(colours);
}

void DrawnSurface::update(const SurfaceMotion* motion, Span<const float> wetness) {
  motion_ = motion;
  if (motion == nullptr) return;
  darken(wetness);
  const auto points = to_vtk(motion->x_t1, VTK_FLOAT);
  data_->SetPoints(points);
  border_->SetPoints(points);
  pinned_->SetPoints(points);
  if (!built_) {
    data_->SetPolys(to_vtk(motion->triangles));
    if (has_border_) border_->SetLines(border_edges(motion->triangles));
    built_ = true;
  }
  auto pins = vtkSmartPointer<vtkCellArray>::New();
  for (std::size_t i = 0; i < motion->inverse_mass.size(); ++i)
    if (motion->inverse_mass[i] == 0) pins->InsertNextCell({vtkIdType(i)});
  pinned_->SetVerts(pins);
  data_->Modified();
}

vtkSmartPointer<vtkScalarBarActor> water_legend(double text_scale) {
  auto bar = vtkSmartPointer<vtkScalarBarActor>::New();
  bar->SetNumberOfLabels(5);
  bar->SetLabelFormat("%.4g");
  bar->UnconstrainedFontSizeOn();
  for (vtkTextProperty* text : {bar->GetTitleTextProperty(), bar->GetLabelTextProperty()}) {
    text->SetColor(ink[0], ink[1], ink[2]);
    text->SetFontFamilyToArial();
    text->SetFontSize(static_cast<int>(15 * text_scale));
    text->ItalicOff();
    text->BoldOff();
    text->ShadowOff();
  }
  bar->SetOrientationToHorizontal();
  bar->SetPosition(0.60, 0.025);
  bar->SetWidth(0.36);
  bar->SetHeight(0.10);
  bar->SetBarRatio(0.22);
  return bar;
}

vtkSmartPointer<vtkTextActor> label(double x, double y, int size, bool bold) {
  auto text = vtkSmartPointer<vtkTextActor>::New();
  text->GetPositionCoordinate()->SetCoordinateSystemToNormalizedViewport();
  text->SetPosition(x, y);
  text->GetTextProperty()->SetFontSize(size);
  text->GetTextProperty()->SetFontFamilyToArial();
  text->GetTextProperty()->SetBold(bold);
  text->GetTextProperty()->SetColor(ink[0], ink[1], ink[2]);
  text->GetTextProperty()->SetVerticalJustificationToTop();
  text->GetTextProperty()->SetBackgroundColor(0.97, 0.98, 1.0);  // legible in front of spray
  text->GetTextProperty()->SetBackgroundOpacity(0.75);
  return text;
}

}  // namespace oilskin::demo
