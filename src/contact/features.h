/// Vertices, edges and faces of a surface, as the closest points of its triangles name them.
#pragma once

#include "core/closest_point.h"
#include "core/mesh_topology.h"

namespace oilskin::contact {

/// A key for the closest feature, the same for every triangle that shares it: duplicates of a triangle, of
/// either winding, have one face between them. `feature` as ClosestPoint has it.
std::uint64_t feature_key(const MeshTopology& topology, std::uint32_t triangle, const Triangle& nodes,
                          std::uint8_t feature);

/// Is the closest point of `triangle` a local minimum of the distance over the mesh (C.3)? Not if it lies on
/// an edge or a vertex from which the distance falls into another triangle: a contact there would brake what
/// slides over inner edges. The result is the same for all triangles of a vertex.
bool is_local_minimum(const MeshTopology& topology, Span<const Triangle> triangles, Span<const Vec3> x,
                      std::uint32_t triangle, const ClosestPoint& c);

}  // namespace oilskin::contact
