/// What the transport of absorbed liquid needs of the rest shape of a textile.
#pragma once

#include <vector>

#include "oilskin/types.h"
#include "oilskin/wetting.h"

namespace oilskin {

/// Capacities of nodes, (W.1), and conductances of edges, (W.4).
struct WettingMesh {
  struct Edge {
    /// first < second
    std::uint32_t first, second;
    /// C D₀ T_ij [kg/s]; below 0 at some edges of triangles with obtuse angles or anisotropy.
    double conductance;
  };
  struct Link {
    std::uint32_t node, edge;
  };

  /// Degenerate and duplicate triangles carry and conduct nothing.
  WettingMesh(Span<const Vec3> rest, Span<const Triangle> triangles, const Fabric& fabric);

  Span<const Link> links(std::size_t node) const {
    return {link.data() + begin[node], begin[node + 1] - begin[node]};
  }

  /// C A_i [kg]; 0: the node can neither take nor give.
  std::vector<double> capacity;
  /// Ascending by their nodes; those that conduct nothing are left out.
  std::vector<Edge> edges;
  /// Per node, into link; one more than there are nodes.
  std::vector<std::uint32_t> begin;
  std::vector<Link> link;
  /// Per node: the connected part, 0 … part_count − 1.
  std::vector<std::uint32_t> part;
  std::size_t part_count = 0;
  bool has_negative = false;

 private:
  void add_edges(Span<const Vec3> rest, Span<const Triangle> triangles, const Fabric& fabric);
  void link_nodes();
  void find_parts();
};

}  // namespace oilskin
