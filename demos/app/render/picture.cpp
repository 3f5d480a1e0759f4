#include "render/picture.h"

#include <vtkCamera.h>
#include <vtkImageAppend.h>
#include <vtkImageData.h>
#include <vtkImageResize.h>
#include <vtkInteractorStyleTrackballCamera.h>
#include <vtkLight.h>
#include <vtkPNGWriter.h>
#include <vtkProperty.h>
#include <vtkRenderWindow.h>
#include <vtkRenderWindowInteractor.h>
#include <vtkRenderer.h>
#include <vtkWindowToImageFilter.h>

#include <algorithm>
#include <cstdio>

#include "output/output_error.h"
#include "render/picture_parts.h"
#include "render/picture_water.h"
#include "scene/views.h"

namespace oilskin::demo {
namespace {

constexpr int height = 800;       // of a picture [pixels]; two views are 1600 wide
constexpr int supersampling = 2;  // balls are drawn per pixel, so multisampling would not smooth their rims

constexpr int view_width = height;

/// From below, or nearly.
bool looks_up(const View& view) {
  return (view.target - view.eye).dot(view.up) > 0;
}

/// A colour scale and the title of its legend.
struct Scale {
  vtkSmartPointer<vtkColorTransferFunction> colours;
  const char* title;
};

/// In order of WaterColour.
std::vector<Scale> scales_of(const Scene& scene) {
  const double density = scene.fluid.rest_density;
  return {{water_colours(0, colour_end(scene)), "speed [m/s]"},
          {water_colours(0, scene.pictures.max_pressure), "pressure [Pa]"},
          {water_colours(0.9 * density, 1.1 * density), "density [kg/m\u00b3]"}};
}

void add_light(vtkRenderer* renderer, const Vec3& from, double intensity, double r, double g, double b) {
  vtkNew<vtkLight> light;
  light->SetLightTypeToSceneLight();
  light->PositionalOff();
  light->SetPosition(from.x(), from.y(), from.z());
  light->SetFocalPoint(0, 0, 0);
  light->SetIntensity(intensity);
  light->SetColor(r, g, b);
  renderer->AddLight(light);
}

/// A key light from the left of the eye, a fill from the right, and a faint one from the eye itself: light
/// that comes from the side is what makes folds visible.
void add_lights(vtkRenderer* renderer, const View& view) {
  renderer->AutomaticLightCreationOff();
  const Vec3 sight = (view.eye - view.target).normalized();
  const Vec3 right = view.up.cross(sight).normalized();
  const Vec3 over =
      sight.cross(right) * (sight.dot(view.up) >= 0 ? 1 : -1);  // the side of the sheet that is seen
  add_light(renderer, 0.9 * sight - 0.9 * right + 0.45 * over, 0.80, 1.0, 0.98, 0.94);
  add_light(renderer, 0.8 * sight + 1.1 * right - 0.1 * over, 0.35, 0.85, 0.92, 1.0);
  add_light(renderer, sight, 0.25, 1, 1, 1);
}

void look_from(vtkRenderer* renderer, const View& view) {
  vtkCamera* camera = renderer->GetActiveCamera();
  camera->SetPosition(view.eye.data());
  camera->SetFocalPoint(view.target.data());
  camera->SetViewUp(view.up.data());
  camera->SetViewAngle(view.angle);
  camera->SetParallelProjection(view.orthographic > 0);
  if (view.orthographic > 0) camera->SetParallelScale(0.5 * view.orthographic);
  renderer->RemoveAllLights();
  add_lights(renderer, view);
}

}  // namespace

/// One renderer that takes the views in turn. Without VTK's ambient occlusion: on Mesa's software rasterizer
/// its pass leaves tiles that are too dark, and takes half of the time of a picture.
struct Picture::Impl {
  std::vector<View> views;
  double gravity;             // [m/s²]
  std::vector<Scale> scales;  // per colour
  double spacing;             // of the particles [m]
  DrawnWater water;
  DrawnWaterMesh water_mesh;
  bool has_water_mesh;
  std::vector<std::unique_ptr<DrawnSurface>> cloth, bodies;
  vtkNew<vtkRenderer> renderer;
  vtkNew<vtkRenderWindow> window;
  vtkSmartPointer<vtkRenderWindowInteractor> interactor;
  vtkSmartPointer<vtkTextActor> status, title;
  vtkSmartPointer<vtkScalarBarActor> legend;
  std::string name;
  bool interactive;

  Impl(const Scene& scene, bool is_window);
  void add_props(int scale);
  void set_up(const View& view);
  Vec3 in_front(const View& view) const;
  WaterLook look_of(const View& view) const;
  void open_window();
  bool ends_colours(std::size_t view) const;
  vtkSmartPointer<vtkImageData> draw(std::size_t view);
};

Picture::Impl::Impl(const Scene& scene, bool is_window)
    : views(views_of(scene)),
      scales(scales_of(scene)),
      spacing(scene.fluid.spacing),
      water(scene.fluid.spacing),
      has_water_mesh(scene.water_mesh.has_value()),
      name(scene.name),
      interactive(is_window) {
  for (std::size_t i = 0; i < scene.cloth.size(); ++i)
    cloth.push_back(std::make_unique<DrawnSurface>(SurfaceLook::cloth));
  for (const Body& body : scene.bodies) {
    const bool is_tank = std::holds_alternative<TankShape>(body.shape);
    bodies.push_back(std::make_unique<DrawnSurface>(is_tank ? SurfaceLook::tank : SurfaceLook::body));
  }
  renderer->GradientBackgroundOn();
  renderer->SetBackground(0.84, 0.87, 0.90);
  renderer->SetBackground2(0.98, 0.985, 0.99);
  renderer->AutomaticLightCreationOff();
  const int scale = interactive ? 1 : supersampling;
  add_props(scale);
  if (has_water_mesh) {
    add_sky(renderer, views.front().up);
    renderer->UseDepthPeelingOn();  // clear water behind clear water
    renderer->SetMaximumNumberOfPeels(8);
    // Layers on fewer pixels than this part are left out: in `jet` half of the time of a clear picture.
    renderer->SetOcclusionRatio(0.005);
  }
  window->AddRenderer(renderer);
  window->SetSize(view_width * scale, height * scale);
  window->SetMultiSamples(0);
  window->SetAlphaBitPlanes(1);
  window->SetWindowName(("oilskin: " + name).c_str());
  look_from(renderer, views.front());
  interactive ? open_window() : window->OffScreenRenderingOn();
}

void Picture::Impl::add_props(int scale) {
  renderer->AddActor(water.balls());
  renderer->AddActor(water.film());
  renderer->AddActor(water_mesh.actor());
  renderer->AddActor(water_mesh.cut());
  for (auto& c : cloth) {
    renderer->AddActor(c->actor());
    renderer->AddActor(c->outline());
    renderer->AddActor(c->pins());
    renderer->AddActor(c->cut());
  }
  for (auto& b : bodies) {
    renderer->AddActor(b->actor());
    renderer->AddActor(b->outline());
    renderer->AddActor(b->cut());
  }
  status = label(0.03, 0.965, 20 * scale, true);
  title = label(0.03, 0.915, 17 * scale, false);
  legend = water_legend(scale);
  renderer->AddViewProp(status);
  renderer->AddViewProp(title);
  renderer->AddViewProp(legend);
}

void Picture::Impl::open_window() {
  interactor = vtkSmartPointer<vtkRenderWindowInteractor>::New();
  interactor->SetRenderWindow(window);
  vtkNew<vtkInteractorStyleTrackballCamera> style;
  interactor->SetInteractorStyle(style);
  window->Render();
  interactor->Initialize();
}

/// From the middle of a cut to the eye's side of its water, which would hide the lines.
Vec3 Picture::Impl::in_front(const View& view) const {
  if (!view.slice) return Vec3::Zero();
  const Vec3 n = view.slice->normal.normalized();
  const double displacement = 0.5 * view.slice->thickness + spacing;
  return n.dot(view.eye - view.slice->point) > 0 ? Vec3(displacement * n) : Vec3(-displacement * n);
}

WaterLook Picture::Impl::look_of(const View& view) const {
  if (!has_water_mesh) return WaterLook::balls;
  return view.water == WaterLook::automatic ? WaterLook::surface : view.water;
}

/// Shows the water and the surfaces as the view asks for.
void Picture::Impl::set_up(const View& view) {
  const Scale& scale = scales[static_cast<std::size_t>(view.colour)];
  const WaterLook look = look_of(view);
  look == WaterLook::balls ? water.show(view.slice, view.colour, scale.colours) : water.hide();
  const Vec3 lift = in_front(view);
  water_mesh.show(look, view.slice, lift);
  for (auto& c : cloth) c->show(view.slice, lift);
  for (auto& b : bodies) b->show(view.slice, lift);
  legend->SetLookupTable(scale.colours);
  // The empty line keeps the title off the label below it: VTK leaves no gap between the two.
  legend->SetTitle((std::string(scale.title) + "\n ").c_str());
}

/// The next view shows no balls, or other colours of them.
bool Picture::Impl::ends_colours(std::size_t view) const {
  return view + 1 == views.size() || look_of(views[view + 1]) != WaterLook::balls ||
         views[view + 1].colour != views[view].colour;
}

/// One view, smoothed. The first carries the numbers, the last of each run of equal colours their legend.
vtkSmartPointer<vtkImageData> Picture::Impl::draw(std::size_t view) {
  set_up(views[view]);
  look_from(renderer, views[view]);
  renderer->ResetCameraClippingRange();
  title->SetInput(views[view].title.c_str());
  // Seen from below a floor would hide everything: bodies let the view through there.
  for (auto& b : bodies) b->actor()->GetProperty()->SetOpacity(looks_up(views[view]) ? 0.15 : 1);
  status->SetVisibility(view == 0);
  legend->SetVisibility(look_of(views[view]) == WaterLook::balls && ends_colours(view));
  window->Render();
  vtkNew<vtkWindowToImageFilter> grab;
  grab->SetInput(window);
  grab->SetInputBufferTypeToRGB();
  grab->ReadFrontBufferOff();
  grab->ShouldRerenderOff();
  vtkNew<vtkImageResize> resize;
  resize->SetInputConnection(grab->GetOutputPort());
  resize->SetOutputDimensions(view_width, height, 1);
  resize->InterpolateOn();
  resize->Update();
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->DeepCopy(resize->GetOutput());
  return image;
}

Picture::Picture(const Scene& scene, bool window) : impl_(std::make_unique<Impl>(scene, window)) {}
Picture::~Picture() = default;

void Picture::show(const FrameData& data) {
  impl_->water.update(data);
  impl_->water_mesh.update(data.water_mesh);
  for (std::size_t i = 0; i < impl_->cloth.size(); ++i)
    impl_->cloth[i]->update(
        data.cloth[i], i < data.wetness.size() ? Span<const float>(data.wetness[i]) : Span<const float>());
  for (std::size_t i = 0; i < impl_->bodies.size(); ++i) impl_->bodies[i]->update(data.bodies[i], {});
  char text[160];
  std::snprintf(text, sizeof text, "%s   t = %.3f s   %zu particles   %s", impl_->name.c_str(), data.t,
                data.position.size(), data.crossings.c_str());
  impl_->status->SetInput(text);
  if (!impl_->interactor) return;
  impl_->set_up(impl_->views.front());
  impl_->renderer->ResetCameraClippingRange();
  impl_->window->Render();
  impl_->interactor->ProcessEvents();
}

void Picture::save(const std::string& path) {
  vtkNew<vtkImageAppend> side_by_side;
  side_by_side->SetAppendAxis(0);
  for (std::size_t i = 0; i < impl_->views.size(); ++i) side_by_side->AddInputData(impl_->draw(i));
  vtkNew<vtkPNGWriter> writer;
  writer->SetFileName(path.c_str());
  writer->SetInputConnection(side_by_side->GetOutputPort());
  writer->Write();
  if (writer->GetErrorCode() != 0) throw OutputError(path + ": cannot be written; is the disk full?");
}

bool Picture::window_open() const {
  return !impl_->interactor || !impl_->interactor->GetDone();
}

}  // namespace oilskin::demo
