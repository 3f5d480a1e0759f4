#include "checks/acceptance.h"

#include "checks/check_table.h"
#include "scene/scene_reader.h"

namespace oilskin::demo {
namespace {

constexpr std::uint64_t look_every = 10;  // steps

}  // namespace

Acceptance::Acceptance(const Scene& scene) : scene_(scene) {
  Fields fields = Fields::reader(scene.acceptance, "acceptance");
  for (const CheckEntry& entry : check_table()) {
    if (entry.key != nullptr && fields.raw(entry.key) == nullptr) continue;
    checks_.push_back(entry.make());
    checks_.back()->describe(fields);
  }
  fields.finish();
  for (const auto& check : checks_) check->check_scene(scene);
}

Json Acceptance::settings() const {
  Json json;
  Fields fields = Fields::writer(json);
  for (const auto& check : checks_) check->describe(fields);
  return json;
}

void Acceptance::after_step(Simulation& simulation, double dt) {
  since_look_ += dt;
  Moment now{scene_, simulation, dt, simulation.time().value()};
  now.look = simulation.time().steps() % look_every == 0;
  now.since_look = since_look_;
  for (const auto& check : checks_) check->after_step(now);
  if (now.look) since_look_ = 0;
}

std::vector<CheckResult> Acceptance::results(const RunEnd& end) {
  std::vector<CheckResult> all;
  for (const auto& check : checks_)
    for (CheckResult& result : check->results(end)) all.push_back(std::move(result));
  return all;
}

Json resolved_scene(const Scene& scene, const Acceptance& acceptance) {
  Json json = write_scene(scene);
  json["acceptance"] = acceptance.settings();
  return json;
}

}  // namespace oilskin::demo
