#include "scene/mesh_options.h"

#include <algorithm>
#include <sstream>

#include "scene/scene_format.h"

namespace oilskin::demo {

const std::vector<std::string>& known_formats() {
  static const std::vector<std::string> names = {"ply", "glb", "vdb"};
  return names;
}

const std::vector<std::string>& known_channels() {
  static const std::vector<std::string> names = {"velocity", "speed", "wetness", "thickness", "id"};
  return names;
}

Status check_mesh_settings(const WaterMeshSettings& wanted, double spacing) {
  const auto range = [&](const char* key, double value, double minimum, double maximum) {
    std::ostringstream text;
    text << key << " is " << value << " m; it must be " << minimum << " … " << maximum << " m, of particles "
         << spacing << " m apart";
    return Status::refused(text.str());
  };
  if (wanted.cell > 0 && !(wanted.cell >= 0.1 * spacing && wanted.cell <= spacing))
    return range("cell", wanted.cell, 0.1 * spacing, spacing);
  if (!(wanted.gap <= spacing)) return range("gap", wanted.gap, 0, spacing);
  return reconstruction_options(wanted, spacing, 0).validate();
}

ReconstructionOptions reconstruction_options(const WaterMeshSettings& wanted, double spacing, int threads) {
  ReconstructionOptions options;
  options.spacing = spacing;
  if (wanted.cell > 0) options.cell = wanted.cell / spacing;
  options.gap = wanted.gap;
  options.contact = wanted.mode;
  options.field = wanted.field;
  options.touch_range = wanted.touch_range;
  options.wet_saturation = wanted.wet_saturation;
  options.wet_blend = wanted.wet_blend;
  options.overlap_depth = wanted.overlap_depth;
  options.smoothing_iterations = wanted.smoothing;
  options.keep_volume = wanted.keep_volume;
  options.min_blob = wanted.min_blob;
  options.threads = threads;
  options.nearest = std::count(wanted.channels.begin(), wanted.channels.end(), "id") > 0;
  return options;
}

std::string made_with(const WaterMeshSettings& wanted, double spacing, std::optional<double> density) {
  WaterMeshSettings resolved = wanted;
  resolved.cell = reconstruction_options(wanted, spacing, 0).cell * spacing;
  Json json;
  Fields fields = Fields::writer(json);
  describe(fields, resolved);
  json.erase("formats");
  if (wanted.channels == WaterMeshSettings().channels) json.erase("channels");
  json["spacing"] = spacing;
  if (density) json["density"] = *density;
  return json.dump();
}

}  // namespace oilskin::demo
