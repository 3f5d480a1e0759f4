#include "view/frame_log.h"

namespace oilskin::demo {
namespace {

constexpr const char* water_words[] = {"balls", "surface", "clear", "none"};

Json numbers(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}

Json held(const Viewer& viewer) {
  const std::optional<Grip>& grip = viewer.live().simulation().grip();
  if (!grip) return {};
  Json json = {{grip->is_body ? "body" : "cloth", grip->index},
               {"place", numbers(grip->place)},
               {"goal", numbers(grip->goal)}};
  if (!grip->nodes.empty()) json["node"] = grip->nodes.front();
  return json;
}

}  // namespace

FrameLog::FrameLog(const std::string& path) {
  if (path.empty()) return;
  file_.open(path);
  if (!file_) throw SceneError("--log " + path + ": cannot be written");
}

Json frame_line(std::uint64_t frame, const Viewer& viewer) {
  const LiveScene& live = viewer.live();
  const OrbitCamera& camera = viewer.camera();
  Json json = {{"frame", frame},
               {"time", live.time()},
               {"steps", live.counts().steps},
               {"paused", viewer.paused()},
               {"speed", viewer.speed()},
               {"particles", live.world().particle_count()},
               {"crossings", live.counts().crossings},
               {"state_hash", live.world().state_hash()},
               {"eye", numbers(camera.eye())},
               {"target", numbers(camera.target())},
               {"water", water_words[static_cast<std::size_t>(viewer.shown().water)]},
               {"held", held(viewer)},
               {"message", viewer.message()}};
  json["nozzles"] = Json::array();
  for (const Nozzle& nozzle : live.simulation().nozzles())
    json["nozzles"].push_back(numbers(nozzle.direction));
  for (const Switch& row : switches()) json["settings"][row.key] = value_at(live.settings(), row.key);
  return json;
}

void FrameLog::write(std::uint64_t frame, const Viewer& viewer,
                     const std::map<std::string, std::array<float, 2>>& places) {
  if (!file_.is_open()) return;
  Json json = frame_line(frame, viewer);
  json["places"] = places;
  file_ << json.dump() << std::endl;  // a reader follows it while the window is open
}

}  // namespace oilskin::demo
