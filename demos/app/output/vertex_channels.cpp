#include "output/vertex_channels.h"

#include <algorithm>
#include <cmath>

#include "geometry/nearest_surface.h"

namespace oilskin::demo {
namespace {

using Floats = std::vector<float>;
using Integers = std::vector<std::int32_t>;

/// [m/s]
VertexChannel velocity(const ChannelSource& from) {
  Floats values;
  values.reserve(3 * from.mesh.velocities.size());
  for (const auto& v : from.mesh.velocities) values.insert(values.end(), v.begin(), v.end());
  return {"velocity", {"vx", "vy", "vz"}, std::move(values)};
}

/// [m/s]
VertexChannel speed(const ChannelSource& from) {
  Floats values;
  values.reserve(from.mesh.velocities.size());
  for (const auto& v : from.mesh.velocities)
    values.push_back(static_cast<float>(Vec3(double(v[0]), double(v[1]), double(v[2])).norm()));
  return {"speed", {"speed"}, std::move(values)};
}

/// The saturation of cloth at its point nearest to the vertex, 0 where none is within reach.
VertexChannel wetness(const ChannelSource& from) {
  std::vector<SurfaceMotion> cloth(from.obstacles.size());
  NearestSurface nearest(from.reach);
  for (std::size_t i = 0; i < cloth.size(); ++i) {
    const ObstacleMesh& o = from.obstacles[i];
    if (o.saturation.empty()) continue;
    cloth[i].x_t1.assign(o.vertices.begin(), o.vertices.end());
    cloth[i].triangles.assign(o.triangles.begin(), o.triangles.end());
    nearest.add(cloth[i], static_cast<int>(i));
  }
  Floats values;
  values.reserve(from.mesh.positions.size());
  NearestSurface::Hit hit;
  for (const auto& p : from.mesh.positions) {
    double value = 0;
    if (nearest.find(Vec3(double(p[0]), double(p[1]), double(p[2])), &hit))
      for (std::size_t k = 0; k < 3; ++k)
        value += hit.point.weights[k] *
                 double(from.obstacles[static_cast<std::size_t>(hit.surface)].saturation[hit.nodes[k]]);
    values.push_back(static_cast<float>(value));
  }
  return {"wetness", {"wetness"}, std::move(values)};
}

/// Of the water on cloth or a body [m]; 0 elsewhere.
VertexChannel thickness(const ChannelSource& from) {
  return {"thickness", {"thickness"}, from.mesh.thickness};
}

/// The lower 32 bits of the id of the nearest particle; −1 where there is none.
VertexChannel id(const ChannelSource& from) {
  Integers values;
  values.reserve(from.mesh.nearest.size());
  for (const std::uint32_t i : from.mesh.nearest)
    values.push_back(i == WaterMesh::no_particle
                         ? -1
                         : static_cast<std::int32_t>(static_cast<std::uint32_t>(from.ids[i])));
  return {"id", {"id"}, std::move(values)};
}

bool has_velocities(const ChannelSource& from) {
  return !from.mesh.velocities.empty();
}

bool has_ids(const ChannelSource& from) {
  return !from.ids.empty() && !from.mesh.nearest.empty();
}

bool has_thickness(const ChannelSource& from) {
  return !from.mesh.thickness.empty();
}

bool has_vertices(const ChannelSource& from) {
  return !from.mesh.positions.empty();
}

struct KnownChannel {
  const char* name;
  bool (*is_there)(const ChannelSource&);
  VertexChannel (*make)(const ChannelSource&);
};

/// A further channel is a row here, and a name in known_channels() (scene/mesh_options.h).
constexpr KnownChannel table[] = {
    {"velocity", has_velocities, velocity},
    {"speed", has_velocities, speed},
    {"wetness", has_vertices, wetness},
    {"thickness", has_thickness, thickness},
    {"id", has_ids, id},
};

}  // namespace

std::vector<VertexChannel> vertex_channels(const std::vector<std::string>& names,
                                           const ChannelSource& source) {
  std::vector<VertexChannel> channels;
  for (const KnownChannel& known : table)
    if (std::find(names.begin(), names.end(), known.name) != names.end() && known.is_there(source))
      channels.push_back(known.make(source));
  return channels;
}

}  // namespace oilskin::demo
