/// What contact needs to know of a surface's mesh, once per topology.
#pragma once

#include "core/closest_point.h"
#include "oilskin/types.h"

namespace oilskin::contact {

class Topology {
 public:
  Topology() = default;
  Topology(Span<const Triangle> triangles, std::size_t nodes);

  /// A key for the closest feature, the same for every triangle that shares it: duplicates of a triangle, of
  /// either winding, have one face between them.
  std::uint64_t feature_key(std::uint32_t triangle, const Triangle& nodes, std::uint8_t feature) const;

  /// Is the closest point of `triangle` a local minimum of the distance over the mesh (C.3)? Not if it lies
  /// on an edge or a vertex from which another triangle comes nearer: such a record would brake what slides
  /// over inner edges. All triangles of a vertex give the same answer for it.
  bool is_local_minimum(Span<const Triangle> triangles, Span<const Vec3> x, std::uint32_t triangle,
                        const ClosestPoint& c) const;

  Span<const std::uint32_t> triangles_of(std::uint32_t node) const {
    return {triangle_.data() + begin_[node], begin_[node + 1] - begin_[node]};
  }

 private:
  std::vector<std::uint32_t> canonical_;  // per triangle: the first one with the same three nodes
  std::vector<std::uint32_t> begin_;      // per node, into triangle_
  std::vector<std::uint32_t> triangle_;
};

}  // namespace oilskin::contact
