/// The connected parts of a mesh.
#pragma once

#include "core/disjoint_sets.h"
#include "reconstruction/promise.h"

namespace oilskin::test {

struct MeshPart {
  double volume = 0;  ///< [m³]; negative: it encloses air, or is turned inside out
  std::size_t triangles = 0;
};

inline std::vector<MeshPart> parts_of(const WaterMesh& mesh) {
  DisjointSets sets(mesh.positions.size());
  for (const Triangle& t : mesh.triangles) {
    sets.unite(t[0], t[1]);
    sets.unite(t[0], t[2]);
  }
  std::vector<MeshPart> parts(mesh.positions.size()), result;
  for (const Triangle& t : mesh.triangles) {
    MeshPart& part = parts[sets.find(t[0])];
    part.volume += position(mesh, t[0]).dot(position(mesh, t[1]).cross(position(mesh, t[2]))) / 6;
    ++part.triangles;
  }
  for (const MeshPart& part : parts)
    if (part.triangles > 0) result.push_back(part);
  return result;
}

}  // namespace oilskin::test
