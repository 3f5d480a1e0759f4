/// Quantities at the vertices of the water's mesh, by name, for the files of it.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "oilskin/reconstruction.h"

namespace oilskin::demo {

/// One quantity: `properties.size()` values for each vertex.
struct VertexChannel {
  std::string name;
  /// The names of its components in PLY.
  std::vector<std::string> properties;
  std::variant<std::vector<float>, std::vector<std::int32_t>> values;

  std::size_t components() const { return properties.size(); }
};

/// What channels are computed from.
struct ChannelSource {
  const WaterMesh& mesh;
  /// Cloth with its saturation.
  Span<const ObstacleMesh> obstacles;
  /// Of the particles; empty = unknown.
  Span<const std::uint64_t> ids;
  /// Cloth farther from a vertex than this does not wet it [m], > 0.
  double reach;
};

/// The channels `names`, in the order of the table in the source file. One whose data is not there
/// (velocities or ids that a run did not store) is left out.
std::vector<VertexChannel> vertex_channels(const std::vector<std::string>& names,
                                           const ChannelSource& source);

}  // namespace oilskin::demo
