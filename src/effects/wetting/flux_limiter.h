/// Limits that a flow between the nodes of a mesh keeps without loss or gain.
#pragma once

#include <vector>

#include "effects/wetting/wetting_mesh.h"

namespace oilskin {

/// Flux correction of [Zalesak1979], section IV. `mass` [kg] per node is a solution within the bounds; it
/// becomes the more accurate one, mass + divergence of `correction` [kg], as far as the bounds allow.
/// `correction` is positive from the first node of its edge to the second. `lower` and `upper` [kg]: per
/// node.
void add_limited(const WettingMesh& mesh, const std::vector<double>& correction,
                 const std::vector<double>& lower, const std::vector<double>& upper,
                 std::vector<double>& mass);

/// What `mass` has above `upper` returns along the edges by which gravity brought it, from the lowest nodes
/// upwards; then along all edges that brought liquid, some times over. What still finds no place fills what
/// is free in its connected part, each node in proportion. `drift` and `amount` [kg]: what gravity moved over
/// each edge in the interval, and what moved in all; `lowest_first`: the nodes in question. `held`: nodes
/// that take any amount.
void return_excess(const WettingMesh& mesh, const std::vector<std::uint32_t>& lowest_first,
                   const std::vector<double>& drift, const std::vector<double>& amount,
                   const std::vector<double>& upper, const std::vector<std::uint8_t>& held,
                   std::vector<double>& mass);

/// The exact sums of liquid of connected parts.
class PartSums {
 public:
  explicit PartSums(const WettingMesh& mesh) : mesh_(mesh) {}

  void remember(Span<const double> mass) { sum_ = of(mass); }
  /// Makes the sums of `mass` those remembered, by a factor near 1 for the nodes of a part that are not held,
  /// and gives what rounding leaves to one wet node. Parts with held nodes may keep other sums. Returns what
  /// the held nodes and the rest of their parts have gained [kg].
  double restore(const std::vector<std::uint8_t>& held, std::vector<double>& mass) const;

 private:
  std::vector<double> of(Span<const double> mass) const;

  const WettingMesh& mesh_;
  std::vector<double> sum_;
};

}  // namespace oilskin
