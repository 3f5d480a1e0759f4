#include "view/painter.h"

#include "scene/views.h"
#include "view/shaders.h"

namespace oilskin::demo {
namespace {

constexpr float ink[3] = {0.13f, 0.15f, 0.19f};
constexpr float cloth_front[3] = {0.93f, 0.76f, 0.62f}, cloth_back[3] = {0.86f, 0.52f, 0.40f};
constexpr float body_front[3] = {0.86f, 0.87f, 0.89f}, body_back[3] = {0.80f, 0.81f, 0.84f};
constexpr float pull_tint[3] = {0.85f, 0.20f, 0.15f};
constexpr float clear_body = 0.16f, clear_water = 0.35f;  // opacity
const Layout vertex_layout = {3, 3, 1}, drop_layout = {3, 1, 3, 1, 1}, point_layout = {3};

std::string lit(const char* fragment) {
  return std::string(shader_light) + fragment;
}

void set_stops(const Program& program) {
  float stops[18];
  for (int i = 0; i < 18; ++i) stops[i] = static_cast<float>(water_colour_stops[i / 3][i % 3]);
  program.set_vec3("stops", stops, 6);
}

/// a x + b y + c z + d, which is above zero in front of the cut.
void set_cut(const ShowOptions& options, float (&cut)[4]) {
  const Vec3 n = options.slice.normal.normalized();
  for (int k = 0; k < 3; ++k) cut[k] = options.cut ? static_cast<float>(n[k]) : 0;
  cut[3] = options.cut ? static_cast<float>(-n.dot(options.slice.point) - 0.5 * options.slice.thickness) : -1;
}

std::unique_ptr<Vertices> points_of(const Gl& gl, const ShownMesh& mesh,
                                    const std::vector<std::uint32_t>& which) {
  std::vector<float> positions;
  for (const std::uint32_t k : which)
    positions.insert(positions.end(), mesh.vertices[k].position, mesh.vertices[k].position + 3);
  auto points = std::make_unique<Vertices>(gl, point_layout);
  points->fill(positions.data(), positions.size() * sizeof(float));
  return points;
}

}  // namespace

Painter::Painter(Gl::Load load)
    : gl_(load),
      drops_(gl_, shader_drop_vertex, lit(shader_drop_fragment)),
      meshes_(gl_, shader_mesh_vertex, lit(shader_mesh_fragment)),
      water_(gl_, shader_mesh_vertex, lit(shader_water_fragment)),
      lines_(gl_, shader_line_vertex, shader_line_fragment),
      sky_(gl_, shader_sky_vertex, shader_sky_fragment),
      balls_(gl_, drop_layout, true),
      water_mesh_(gl_, vertex_layout),
      nothing_(gl_, {}),
      pull_(gl_, point_layout) {
  gl_.Enable(GL_PROGRAM_POINT_SIZE);
  gl_.Enable(GL_MULTISAMPLE);
  gl_.BlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
}

Painter::Surface Painter::upload_surface(const ShownMesh& mesh) {
  Surface surface;
  surface.faces = std::make_unique<Vertices>(gl_, vertex_layout);
  surface.faces->fill(mesh.vertices.data(), mesh.vertices.size() * sizeof(ShownVertex));
  surface.faces->index(mesh.indices);
  surface.border = points_of(gl_, mesh, mesh.border);
  surface.held = points_of(gl_, mesh, mesh.held);
  return surface;
}

void Painter::upload(const ShownScene& scene, const ShowOptions& options) {
  if (uploaded_ == scene.version()) return;
  uploaded_ = scene.version();
  surfaces_.clear();
  for (const ShownMesh& mesh : scene.surfaces()) surfaces_.push_back(upload_surface(mesh));
  if (options.water == ShownWater::balls)
    balls_.fill(scene.particles().data(), scene.particles().size() * sizeof(ShownParticle));
  water_mesh_.fill(scene.water().vertices.data(), scene.water().vertices.size() * sizeof(ShownVertex));
  water_mesh_.index(scene.water().indices);
}

void Painter::look(const Program& program) const {
  program.use();
  program.set_mat4("view", view_.data());
  program.set_mat4("projection", projection_.data());
  program.set_vec4("cut", cut_);
}

void Painter::draw_surfaces(const ShownScene& scene, const ShowOptions& options, bool clear_bodies) {
  look(meshes_);
  meshes_.set("opacity", clear_bodies ? clear_body : 1.0f);
  for (std::size_t s = 0; s < surfaces_.size(); ++s) {
    const bool is_body = scene.surfaces()[s].is_body;
    const bool is_clear = is_body && options.bodies == BodyLook::clear;
    if (is_clear != clear_bodies || (is_body && options.bodies == BodyLook::hidden)) continue;
    meshes_.set_vec3("front", is_body ? body_front : cloth_front);
    meshes_.set_vec3("back", is_body ? body_back : cloth_back);
    surfaces_[s].faces->draw_indexed(GL_TRIANGLES);
  }
}

/// Rims of cloth, its pins, and the pull on what is held.
void Painter::draw_lines(const ShownScene& scene, const std::optional<Grip>& grip) {
  look(lines_);
  lines_.set_vec3("tint", ink);
  lines_.set("size", 5.0f);
  lines_.set("is_dot", 0);
  for (std::size_t s = 0; s < surfaces_.size(); ++s)
    surfaces_[s].border->draw(GL_LINES, scene.surfaces()[s].border.size());
  lines_.set("is_dot", 1);
  for (std::size_t s = 0; s < surfaces_.size(); ++s)
    surfaces_[s].held->draw(GL_POINTS, scene.surfaces()[s].held.size());
  if (!grip) return;
  const Eigen::Vector3f ends[2] = {grip->place.cast<float>(), grip->goal.cast<float>()};
  pull_.fill(ends, sizeof ends);
  lines_.set_vec3("tint", pull_tint);
  lines_.set("size", 9.0f);
  gl_.Disable(GL_DEPTH_TEST);
  pull_.draw(GL_POINTS, 2);
  lines_.set("is_dot", 0);
  pull_.draw(GL_LINES, 2);
  gl_.Enable(GL_DEPTH_TEST);
}

void Painter::draw_water(const ShowOptions& options, const ShownScene& scene, const Vec3& up) {
  if (options.water == ShownWater::none) return;
  if (options.water == ShownWater::balls) {
    look(drops_);
    set_stops(drops_);
    drops_.set("pixel", 2 / (static_cast<float>(height_) * projection_(1, 1)));
    gl_.Enable(GL_SAMPLE_ALPHA_TO_COVERAGE);
    balls_.draw_squares(scene.particles().size());
    gl_.Disable(GL_SAMPLE_ALPHA_TO_COVERAGE);
    return;
  }
  look(water_);
  set_stops(water_);
  const Eigen::Vector3f sky = up.normalized().cast<float>();
  water_.set_vec3("up", sky.data());
  const bool is_clear = options.water == ShownWater::clear;
  water_.set("opacity", is_clear ? clear_water : 0.93f);
  // The nearest layer alone, so that the order of the triangles does not matter.
  gl_.ColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  water_mesh_.draw_indexed(GL_TRIANGLES);
  gl_.ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  gl_.DepthFunc(GL_LEQUAL);
  gl_.Enable(GL_BLEND);
  water_mesh_.draw_indexed(GL_TRIANGLES);
  gl_.Disable(GL_BLEND);
  gl_.DepthFunc(GL_LESS);
}

void Painter::draw(const ShownScene& scene, const ShowOptions& options, const OrbitCamera& camera, int left,
                   int width, int height, const std::optional<Grip>& grip, const Vec3& up) {
  upload(scene, options);
  view_ = camera.view().cast<float>();
  projection_ = camera.projection(static_cast<double>(width - left) / height).cast<float>();
  height_ = height;
  set_cut(options, cut_);
  gl_.Viewport(0, 0, width, height);
  gl_.ClearColor(1, 1, 1, 1);
  gl_.DepthMask(GL_TRUE);
  gl_.Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  gl_.Disable(GL_DEPTH_TEST);
  gl_.Disable(GL_BLEND);
  sky_.use();
  nothing_.draw(GL_TRIANGLE_STRIP, 4);
  gl_.Viewport(left, 0, width - left, height);
  gl_.Enable(GL_DEPTH_TEST);
  gl_.DepthFunc(GL_LESS);
  draw_surfaces(scene, options, false);
  draw_lines(scene, grip);
  draw_water(options, scene, up);
  if (options.bodies != BodyLook::clear) return;
  gl_.Enable(GL_BLEND);
  gl_.DepthMask(GL_FALSE);
  draw_surfaces(scene, options, true);
  gl_.DepthMask(GL_TRUE);
  gl_.Disable(GL_BLEND);
}

std::vector<unsigned char> Painter::pixels(int width, int height) const {
  const std::size_t row = 3 * static_cast<std::size_t>(width);
  std::vector<unsigned char> read(row * static_cast<std::size_t>(height)), turned(read.size());
  gl_.PixelStorei(GL_PACK_ALIGNMENT, 1);
  gl_.ReadPixels(0, 0, width, height, GL_RGB, GL_UNSIGNED_BYTE, read.data());
  for (std::size_t y = 0; y < static_cast<std::size_t>(height); ++y) {
    const auto from =
        read.begin() + static_cast<std::ptrdiff_t>((static_cast<std::size_t>(height) - 1 - y) * row);
    std::copy(from, from + static_cast<std::ptrdiff_t>(row),
              turned.begin() + static_cast<std::ptrdiff_t>(y * row));
  }
  return turned;
}

}  // namespace oilskin::demo
