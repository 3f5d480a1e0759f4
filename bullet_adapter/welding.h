/// Finds coincident points. Unwelded meshes have a copy of a vertex for each of its triangles, and an impulse
/// on one copy would separate them.
#pragma once

#include <cstdint>
#include <cstring>
#include <unordered_map>

#include "oilskin/types.h"

namespace oilskin::bullet {

/// Numbers distinct points in the order of their first appearance. +0 and −0 are equal.
class PointNumbers {
 public:
  std::uint32_t number_of(const Vec3& p) {
    const Key key{bits(p.x()), bits(p.y()), bits(p.z())};
    return numbers_.emplace(key, static_cast<std::uint32_t>(numbers_.size())).first->second;
  }
  std::size_t size() const { return numbers_.size(); }

 private:
  using Key = std::array<std::uint64_t, 3>;
  struct Hash {
    std::size_t operator()(const Key& key) const {
      std::uint64_t h = 0;
      for (std::uint64_t k : key) h = (h ^ (k >> 29) ^ k) * 0x9e3779b97f4a7c15ull;
      return static_cast<std::size_t>(h ^ (h >> 32));
    }
  };
  static std::uint64_t bits(double x) {
    x += 0.0;  // −0 becomes +0
    std::uint64_t b;
    std::memcpy(&b, &x, sizeof b);
    return b;
  }

  std::unordered_map<Key, std::uint32_t, Hash> numbers_;
};

}  // namespace oilskin::bullet
