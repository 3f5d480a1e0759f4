/// Parts of space in which particles end.
#pragma once

#include "core/archive.h"
#include "oilskin/sink.h"

namespace oilskin::world {

/// In the order in which they were added: a particle in several ends in the first.
class Sinks {
 public:
  struct Sink {
    std::uint64_t id = 0;
    Region region;
    bool enabled = true;
    std::uint64_t particles = 0;
    double mass_ratio = 0;  ///< Σ of mass over that of a new particle
  };
  static constexpr std::uint32_t none = 0xffffffffu;

  /// Whether one is enabled.
  bool act() const;
  /// The index of the first enabled sink that contains the point.
  std::uint32_t find(const Vec3& x) const;
  void take(std::uint32_t sink, double mass_ratio);

  /// Refuses a region that is out of range.
  Status add(const Region& region, std::uint64_t* id);
  /// Null for an unknown handle.
  Sink* with_id(std::uint64_t id);
  const Sink* with_id(std::uint64_t id) const;
  bool remove(std::uint64_t id);

  /// All are elsewhere by `offset` [m].
  void translate(const Vec3& offset) {
    for (Sink& sink : list_) sink.region.pose.position += offset;
  }
  void visit(Archive& archive);

 private:
  std::vector<Sink> list_;
  std::uint64_t next_id_ = 1;
};

}  // namespace oilskin::world
