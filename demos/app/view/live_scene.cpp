#include "view/live_scene.h"

#include <chrono>

#include "scene/scene_reader.h"

namespace oilskin::demo {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double longest = 1e6;  // [s]; a window has no end

/// Takes the key at a dotted path out of a scene.
void erase(Json& scene, const std::string& key) {
  Json* at = &scene;
  std::size_t begin = 0;
  for (std::size_t dot = key.find('.'); dot != std::string::npos; dot = key.find('.', begin)) {
    const std::string name = key.substr(begin, dot - begin);
    begin = dot + 1;
    if (!at->is_object() || !at->contains(name)) return;
    at = &(*at)[name];
  }
  if (at->is_object()) at->erase(key.substr(begin));
}

/// mean += weight (value − mean), stage by stage.
void approach(StageSeconds& mean, const StageSeconds& value, double weight) {
  for (double StageSeconds::*stage :
       {&StageSeconds::gather, &StageSeconds::neighbours, &StageSeconds::pressure, &StageSeconds::occlusion,
        &StageSeconds::boundary, &StageSeconds::other_fluid, &StageSeconds::proximity,
        &StageSeconds::impulses, &StageSeconds::ccd, &StageSeconds::zones, &StageSeconds::effects,
        &StageSeconds::verify})
    mean.*stage += weight * (value.*stage - mean.*stage);
}

/// The state equation has no boundary terms: with it, walls are as it needs them; after it, as in `original`.
void fit_walls_to_solver(Json& changed, const Json& before, const Json& original) {
  if (value_at(changed, "fluid.solver") == "mcg03")
    erase(changed, "fluid.boundary");
  else if (value_at(before, "fluid.solver") == "mcg03" && value_at(original, "fluid.boundary").is_string())
    changed["fluid"]["boundary"] = value_at(original, "fluid.boundary");
}

}  // namespace

LiveScene::LiveScene(Scene scene, const SimulationOptions& options, MakeSimulation make_simulation)
    : options_(options),
      make_simulation_(std::move(make_simulation)),
      scene_(std::move(scene)),
      settings_(write_scene(scene_)),
      original_(settings_) {
  restart();
}

void LiveScene::restart() {
  auto made = make_simulation_(scene_, options_);
  Scene endless = scene_;
  endless.duration = longest;
  plan_ = std::make_unique<StepPlan>(endless);
  simulation_ = std::move(made);
  counts_ = {};
  costs_ = {};
  ++version_;
}

void LiveScene::step() {
  const Clock::time_point start = Clock::now();
  const double host = simulation_->host_seconds();
  const double suggested = plan_->adaptive() ? simulation_->world().suggested_dt(scene_.dt) : scene_.dt;
  const StepReport& report = simulation_->step(plan_->next(time(), suggested));
  if (!report.status.ok())
    throw SceneError("step " + std::to_string(counts_.steps) + ": " + report.status.message);
  ++counts_.steps;
  counts_.emitted += report.emitted;
  counts_.removed += report.removed + report.removed_invalid;
  counts_.crossings += report.contact.crossings_found_by_verify;
  counts_.flags |= report.flags;
  ++version_;
  add_costs(report, simulation_->host_seconds() - host,
            std::chrono::duration<double>(Clock::now() - start).count());
}

/// Over about the last twenty steps.
void LiveScene::add_costs(const StepReport& report, double host, double total) {
  const double weight = std::max(0.05, 1 / static_cast<double>(counts_.steps));
  approach(costs_.stages, report.seconds, weight);
  costs_.host += weight * (host - costs_.host);
  costs_.total += weight * (total - costs_.total);
}

void LiveScene::apply_live(const Scene& next) {
  World& world = simulation_->world();
  require(world.set_contact_settings(next.contact), "contact");
  require(simulation_->set_gravity(next.world.gravity), "gravity");
  world.set_max_particles(next.world.max_particles);
  require(world.set_step_budget(next.world.step_budget), "step_budget");
  simulation_->set_effects(next.effects);
}

Status LiveScene::change(const std::string& assignment, Change* made) {
  const std::string key = assignment.substr(0, assignment.find('='));
  const Change needed = change_of(key);
  const Scene scene_before = scene_;
  const Json settings_before = settings_;
  try {
    Json json = settings_;
    const bool removes = assignment == key + "=null";
    if (removes)
      erase(json, key);
    else
      apply_override(json, assignment);
    if (key == "fluid.solver") fit_walls_to_solver(json, settings_, original_);
    scene_ = read_scene(json, scene_.directory);
    settings_ = write_scene(scene_);
    needed == Change::live ? apply_live(scene_) : restart();
  } catch (const SceneError& error) {
    scene_ = scene_before;
    settings_ = settings_before;
    return Status::refused(error.what());
  }
  ++version_;
  if (made != nullptr) *made = needed;
  return Status::accepted();
}

Status LiveScene::aim_nozzle(std::size_t i, const Vec3& direction) {
  ++version_;
  return simulation_->aim_nozzle(i, direction);
}

}  // namespace oilskin::demo
