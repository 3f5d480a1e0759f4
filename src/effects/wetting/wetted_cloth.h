/// One surface that absorbs: what it takes up from a particle, how its liquid spreads, where it drips.
#pragma once

#include "core/mesh_topology.h"
#include "effects/wetting/wetting_transport.h"
#include "oilskin/wetting.h"

namespace oilskin {

class WettedCloth {
 public:
  WettedCloth(const SurfaceMotion& motion, std::vector<Vec3> rest, const Fabric& fabric);

  /// Whether it was made for this mesh and rest shape.
  bool is_for(const SurfaceMotion& motion, const std::vector<Vec3>& rest) const;
  const std::vector<double>& capacity() const { return transport_.capacity(); }

  /// What a particle at a wall gives to its three nodes within dt (W.16) [kg]; it has `mass` and covers
  /// `area`. A remainder below `least` goes, too.
  std::array<double, 3> uptake(const SurfaceMotion& motion, const VisibleWall& wall, double dt,
                               double absorption, double area, double mass, double least) const;

  /// Where both sides are free, liquid dries at the rate; `covered`: the area under water, both sides, per
  /// node [m²] (W.19).
  void dry(double dt, double rate, Span<const double> covered, std::size_t surface, EffectExchange& e) const;
  /// Moves liquid between nodes for dt.
  void spread(double dt, std::size_t surface, EffectExchange& e);
  /// `gathered`: what hangs in drops at each node [kg] (W.17). Asks for a particle where they hold enough
  /// (W.18).
  void drip(double dt, double rate, std::size_t surface, Span<double> gathered, EffectExchange& e) const;

 private:
  bool gather_drops(double dt, double rate, const SurfaceMotion& motion, double enough,
                    Span<double> gathered) const;
  std::vector<std::pair<std::uint32_t, double>> collect(std::uint32_t site, double needed,
                                                        Span<const double> gathered) const;
  Vec3 direction_of_drop(const SurfaceMotion& motion, std::uint32_t node, const Vec3& down) const;

  std::uint64_t motion_id_;
  Fabric fabric_;
  std::vector<Vec3> rest_;
  std::vector<Triangle> triangles_;
  MeshTopology topology_;
  WettingTransport transport_;
  std::vector<double> liquid_;  // of spread()
};

}  // namespace oilskin
