/// What the corners of triangles give, listed by vertex.
#pragma once

#include <vector>

#include "oilskin/types.h"

namespace oilskin::reconstruction {

/// Items `begin[v]` to `begin[v + 1]` are those of vertex v, in the order of the triangles.
template <class T>
struct AtVertices {
  std::vector<std::uint32_t> begin;
  std::vector<T> items;

  AtVertices() = default;
  /// `of(n, k)` is the item of corner k of triangle n.
  template <class F>
  AtVertices(const std::vector<Triangle>& triangles, std::size_t vertices, const F& of)
      : begin(vertices + 1, 0), items(3 * triangles.size()) {
    for (const Triangle& t : triangles)
      for (const std::uint32_t v : t) ++begin[v + 1];
    for (std::size_t v = 0; v < vertices; ++v) begin[v + 1] += begin[v];
    std::vector<std::uint32_t> at(begin.begin(), begin.end() - 1);
    for (std::uint32_t n = 0; n < triangles.size(); ++n)
      for (std::size_t k = 0; k < 3; ++k) items[at[triangles[n][k]]++] = of(n, k);
  }
};

}  // namespace oilskin::reconstruction
