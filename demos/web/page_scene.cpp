#include "page_scene.h"

#include <utility>

#include "hosts/bullet_simulation.h"
#include "scene/scene_reader.h"

namespace oilskin::demo {
namespace {

Scene read_page_scene(const std::string& text, const std::vector<std::string>& settings) {
  Json json = parse_json(text, "the scene");
  for (const std::string& setting : settings) apply_override(json, setting);
  Scene scene = read_scene(json, "");
  if (scene.cloth.empty()) throw SceneError("the scene: a page shows a scene with a cloth");
  return scene;
}

Json numbers(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}

/// Milliseconds of the last step: those of the library in groups, and the host's own.
Json milliseconds(const StageSeconds& s, double host_seconds) {
  return {{"fluid", 1e3 * (s.neighbours + s.pressure + s.occlusion + s.boundary + s.other_fluid + s.effects)},
          {"contact", 1e3 * (s.gather + s.proximity + s.impulses + s.ccd + s.zones)},
          {"verify", 1e3 * s.verify},
          {"cloth", 1e3 * host_seconds}};
}

void append(std::vector<float>& out, const Vec3& x) {
  for (int k = 0; k < 3; ++k) out.push_back(static_cast<float>(x[k]));
}

Json first_nozzle(const Simulation& simulation) {
  const std::vector<Nozzle> nozzles = simulation.nozzles();
  if (nozzles.empty()) return {};
  return {{"center", numbers(nozzles[0].center)},
          {"direction", numbers(nozzles[0].direction)},
          {"radius", nozzles[0].radius}};
}

}  // namespace

PageScene::PageScene(const std::string& text, const std::vector<std::string>& settings)
    : scene_(read_page_scene(text, settings)) {
  SimulationOptions options;
  options.threads = 1;
  simulation_ = make_simulation(scene_, options);
}

void PageScene::step() {
  const double host_before = simulation_->host_seconds();
  const StepReport& report = simulation_->step(scene_.dt);
  if (!report.status.ok()) throw SceneError(report.status.message);
  last_ = report;
  host_seconds_ = simulation_->host_seconds() - host_before;
  ++counts_.steps;
  if ((report.flags & flag_no_promise) == 0) ++counts_.certified;
  counts_.crossings += report.contact.crossings_found_by_verify;
  counts_.verified_pairs += report.contact.verified_pairs;
  counts_.emitted += report.emitted;
  counts_.removed += report.removed;
}

void PageScene::set_contact(bool on) {
  ContactSettings settings = scene_.contact;
  settings.ccd = settings.zones = on;
  require(simulation_->world().set_contact_settings(settings), "contact");
  scene_.contact = settings;
}

void PageScene::grab(const Vec3& point) {
  if (!point.allFinite()) throw SceneError("the place where the cloth is taken must be finite");
  require(simulation_->grab_cloth(0, point), "the cloth");
}

void PageScene::pull(const Vec3& goal) {
  if (!goal.allFinite()) throw SceneError("the goal of a pull must be finite");
  simulation_->pull_to(goal);
}

void PageScene::release() {
  simulation_->let_go();
}

void PageScene::aim(const Vec3& direction) {
  require(simulation_->aim_nozzle(0, direction), "the nozzle");
}

const std::vector<float>& PageScene::particles() {
  const World& world = simulation_->world();
  const Span<const Vec3> x = world.positions(), v = world.motions();
  particles_.clear();
  for (std::size_t i = 0; i < x.size(); ++i) {
    append(particles_, x[i]);
    particles_.push_back(static_cast<float>(v[i].norm()));
  }
  return particles_;
}

const std::vector<float>& PageScene::nodes() {
  nodes_.clear();
  const SurfaceMotion* const cloth = simulation_->cloth(0);
  for (const Vec3& x : cloth ? cloth->x_t1 : simulation_->models()[0].rest) append(nodes_, x);
  return nodes_;
}

const std::vector<std::uint32_t>& PageScene::triangles() {
  triangles_.clear();
  const SurfaceMotion* const cloth = simulation_->cloth(0);
  for (const Triangle& t : cloth ? cloth->triangles : simulation_->models()[0].triangles)
    triangles_.insert(triangles_.end(), t.begin(), t.end());
  return triangles_;
}

std::string PageScene::report() const {
  const ContactReport& contact = last_.contact;
  return Json{{"steps", counts_.steps},
              {"time", simulation_->time().value()},
              {"particles", simulation_->world().particle_count()},
              {"emitted", counts_.emitted},
              {"removed", counts_.removed},
              {"certified", counts_.certified},
              {"crossings", counts_.crossings},
              {"verified_pairs", counts_.verified_pairs},
              {"contacts", contact.contacts},
              {"impacts", contact.impacts},
              {"zone_points", contact.zone_points},
              {"min_distance", contact.verified_pairs > 0 ? Json(contact.min_distance) : Json()},
              {"iterations", last_.fluid.iterations},
              {"nozzle", first_nozzle(*simulation_)},
              {"milliseconds", milliseconds(last_.seconds, host_seconds_)},
              {"flags", flag_texts(last_.flags)}}
      .dump();
}

std::string PageScene::description() const {
  return Json{{"name", scene_.name},
              {"description", scene_.description},
              {"dt", scene_.dt},
              {"spacing", scene_.fluid.spacing},
              {"precision", simulation_->precision()},
              {"instruction_set", World::instruction_set()}}
      .dump();
}

}  // namespace oilskin::demo
