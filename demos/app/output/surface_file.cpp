#include "output/surface_file.h"

#include <algorithm>

#include "output/frame_path.h"
#include "output/gltf_file.h"
#include "output/mesh_file.h"
#include "output/vdb_file.h"
#include "scene/fields.h"
#include "scene/mesh_options.h"

namespace oilskin::demo {
namespace {

struct Format {
  const char* name;
  /// The library that writes it and Debian's package of it; empty = none is needed.
  const char* library;
  bool (*available)();
  void (*write)(const std::string& path, const SurfaceFile& file);
  std::string (*made_with)(const std::string& path);
  bool (*is_whole)(const std::string& path);
};

bool always() {
  return true;
}

/// OpenVDB's files do not say how long they are.
bool is_assumed_whole(const std::string&) {
  return true;
}

constexpr Format table[] = {
    {"ply", "", always, write_ply, ply_made_with, ply_is_whole},
    {"glb", "TinyGLTF (Debian: libtinygltf-dev)", gltf_available, write_gltf, gltf_made_with, gltf_is_whole},
    {"vdb", "OpenVDB (Debian: libopenvdb-dev)", vdb_available, write_vdb, vdb_made_with, is_assumed_whole},
};

const Format& format_of(const std::string& name) {
  const auto* const found =
      std::find_if(std::begin(table), std::end(table), [&](const Format& f) { return f.name == name; });
  if (found == std::end(table)) throw SceneError("formats: \"" + name + "\" is not known");
  return *found;
}

}  // namespace

SurfaceFile surface_file(const WaterMesh& mesh, const ReconstructionInput& input,
                         Span<const std::uint64_t> ids, const WaterMeshSettings& wanted, double spacing) {
  // Both sides of a film on cloth are that near.
  const double reach = wanted.gap + 2 * spacing;
  return {mesh, vertex_channels(wanted.channels, {mesh, input.obstacles, ids, reach}),
          made_with(wanted, spacing), reconstruction_options(wanted, spacing, 0).cell * spacing};
}

void require_formats(const std::vector<std::string>& formats) {
  for (const std::string& name : formats)
    if (const Format& format = format_of(name); !format.available())
      throw SceneError("surface.formats: \"" + name + "\" needs " + format.library +
                       ", and this program was built without");
}

void write_surface(const std::string& directory, int number, const std::vector<std::string>& formats,
                   const SurfaceFile& file) {
  for (const std::string& name : formats)
    format_of(name).write(frame_path(directory, "surface", number, name.c_str()), file);
}

std::string surface_made_with(const std::string& path, const std::string& format) {
  return format_of(format).made_with(path);
}

bool surface_is_whole(const std::string& path, const std::string& format) {
  return format_of(format).is_whole(path);
}

}  // namespace oilskin::demo
