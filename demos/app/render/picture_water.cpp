#include "render/picture_water.h"

#include <vtkCellArray.h>
#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkPointData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkTexture.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "render/picture_cut.h"
#include "render/vtk_convert.h"

namespace oilskin::demo {
namespace {

/// How bright a window in the sky is at the angle between `direction` and its middle.
double window_light(const Vec3& direction, const Vec3& middle, double width) {
  const double angle = std::acos(std::clamp(direction.dot(middle.normalized()), -1.0, 1.0));
  return 1 / (1 + std::exp((angle - width) / 0.05));
}

/// Colour of the sky in a direction, y up.
Vec3 sky(const Vec3& d) {
  const double height = 0.5 * (1 + d.y());
  const Vec3 ground(0.30, 0.32, 0.35), horizon(0.80, 0.86, 0.92), zenith(0.45, 0.62, 0.85);
  Vec3 colour = height < 0.5 ? Vec3(ground + (horizon - ground) * std::pow(2 * height, 3))
                             : Vec3(horizon + (zenith - horizon) * (2 * height - 1));
  colour += 5 * window_light(d, Vec3(-0.7, 0.8, 0.5), 0.38) * Vec3(1, 0.97, 0.92);
  colour += 2 * window_light(d, Vec3(0.9, 0.5, -0.3), 0.28) * Vec3(0.85, 0.93, 1);
  return colour;
}

}  // namespace

void add_sky(vtkRenderer* renderer, const Vec3& up) {
  constexpr int width = 512, height = 256;
  constexpr double pi = 3.14159265358979323846;
  vtkNew<vtkImageData> image;
  image->SetDimensions(width, height, 1);
  image->AllocateScalars(VTK_FLOAT, 3);
  auto* pixel = static_cast<float*>(image->GetScalarPointer());
  for (int j = 0; j < height; ++j)
    for (int i = 0; i < width; ++i) {
      const double around = 2 * pi * (i + 0.5) / width, over = pi * ((j + 0.5) / height - 0.5);
      const Vec3 colour =
          sky({std::cos(over) * std::cos(around), std::sin(over), std::cos(over) * std::sin(around)});
      for (int k = 0; k < 3; ++k) *pixel++ = static_cast<float>(colour[k]);
    }
  vtkNew<vtkTexture> texture;
  texture->SetInputData(image);
  texture->SetColorModeToDirectScalars();
  texture->MipmapOn();
  texture->InterpolateOn();
  renderer->UseImageBasedLightingOn();
  renderer->SetEnvironmentTexture(texture);
  const Vec3 n = up.normalized();
  const Vec3 right = n.unitOrthogonal();
  renderer->SetEnvironmentUp(n.x(), n.y(), n.z());
  renderer->SetEnvironmentRight(right.x(), right.y(), right.z());
}

DrawnWaterMesh::DrawnWaterMesh() {
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(data_);
  mapper->ScalarVisibilityOff();
  actor_->SetMapper(mapper);
  vtkProperty* water = actor_->GetProperty();
  water->SetInterpolationToPBR();
  water->SetColor(0.02, 0.16, 0.30);
  water->SetMetallic(0);
  water->SetRoughness(0.08);
  water->SetBaseIOR(1.5);  // more than water's: a mirror makes up for the depth that opaque water lacks

  vtkNew<vtkPolyDataMapper> lines;
  lines->SetInputData(cut_lines_);
  cut_->SetMapper(lines);
  cut_->GetProperty()->SetColor(0.05, 0.30, 0.62);
  cut_->GetProperty()->SetLineWidth(3);
  cut_->GetProperty()->SetPointSize(3);
  cut_->GetProperty()->LightingOff();
}

void DrawnWaterMesh::update(const WaterMesh* mesh) {
  mesh_ = mesh;
  if (mesh == nullptr) return;
  vtkNew<vtkPoints> points;
  points->SetDataType(VTK_FLOAT);
  points->SetNumberOfPoints(static_cast<vtkIdType>(mesh->positions.size()));
  vtkNew<vtkFloatArray> normals;
  normals->SetNumberOfComponents(3);
  normals->SetNumberOfTuples(static_cast<vtkIdType>(mesh->positions.size()));
  for (std::size_t i = 0; i < mesh->positions.size(); ++i) {
    const WaterMesh::Float3 &x = mesh->positions[i], &n = mesh->normals[i];
    points->SetPoint(static_cast<vtkIdType>(i), x[0], x[1], x[2]);
    normals->SetTuple3(static_cast<vtkIdType>(i), n[0], n[1], n[2]);
  }
  data_->SetPoints(points);
  data_->SetPolys(to_vtk(mesh->triangles));
  data_->GetPointData()->SetNormals(normals);
  data_->Modified();
}

void DrawnWaterMesh::show(WaterLook look, const std::optional<Slice>& slice, const Vec3& lift) {
  const bool there = mesh_ != nullptr && !mesh_->triangles.empty() && look != WaterLook::balls;
  actor_->SetVisibility(there && !slice);
  cut_->SetVisibility(there && slice.has_value());
  actor_->GetProperty()->SetOpacity(look == WaterLook::clear ? 0.42 : 1);
  if (!there || !slice) return;
  std::vector<Vec3> vertices;
  vertices.reserve(mesh_->positions.size());
  for (const WaterMesh::Float3& x : mesh_->positions) vertices.emplace_back(x[0], x[1], x[2]);
  draw_cut(*slice, vertices, mesh_->triangles, lift, cut_lines_);
}

}  // namespace oilskin::demo
