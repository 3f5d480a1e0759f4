/// The data of one interval: input, state and output of the stages of contact.
#pragma once

#include "contact/host_support.h"
#include "contact/predicates.h"
#include "contact/surface_geometry.h"
#include "core/assert.h"
#include "core/parallel.h"
#include "core/stage_timer.h"
#include "fluid/boundary/wall_impulse.h"
#include "oilskin/contact.h"

namespace oilskin::contact {

/// What contact needs to know of a liquid.
struct Liquid {
  double spacing;                      // dx [m]
  double rest_density;                 // ρ0 [kg/m³]
  double viscosity;                    // ν [m²/s]
  std::vector<std::uint8_t> collides;  // per surface; empty = with all of them

  explicit Liquid(const ParticleMotion& particles)
      : spacing(particles.spacing), rest_density(particles.rest_density), viscosity(particles.viscosity) {}
  bool collides_with(std::uint32_t surface) const { return collides.empty() || collides[surface] != 0; }
};

/// Of each liquid, surface and node: the impulse by its constraints [N s]; empty lists = none.
using LiquidLoads = std::vector<std::vector<std::vector<Vec3>>>;

struct Context {
  // Input
  double dt = 0;
  const ContactSettings* settings = nullptr;
  const Workers* workers = nullptr;
  ParticleMotion* particles = nullptr;
  Span<SurfaceMotion* const> surfaces;
  Span<SurfaceGeometry* const> geometry;  // one per surface
  std::vector<Liquid> liquids;            // one at least
  Span<const std::uint8_t> liquid_index;  // of each particle; empty = all are of the first liquid
  Span<const Vec3> start_velocity;        // of the particles, before this interval's forces; empty = unknown
  Span<const fluid::WallImpulse> wall_impulses;  // ordered by particle
  Span<Vec3> spare_load;                         // per particle: in and out, with boundary terms (B.35)
  Span<const HostSupport> hosts;                 // one per surface, or none (C.43)
  bool boundary_terms = false;                   // walls act on the particles by pressure, too

  // State. A stamp is the epoch in which an end position last changed; a pair is tested again if a stamp of
  // its points is younger than its last test.
  std::uint32_t epoch = 1;
  std::vector<std::uint32_t> particle_stamp;
  std::vector<std::vector<std::uint32_t>> node_stamp;  // empty while no node of the surface has one
  std::vector<std::uint32_t> surface_stamp;            // the youngest of the surface's nodes
  std::vector<std::uint8_t> out_of_play;               // per particle: removed, or allowed to pass by policy

  // Output
  ContactReport* report = nullptr;
  StageSeconds* seconds = nullptr;
  LiquidLoads* loads = nullptr;  // null = they are not asked for

  std::size_t particle_count() const { return particles->id.size(); }
  std::size_t liquid_of(std::uint32_t p) const { return liquid_index.empty() ? 0 : liquid_index[p]; }
  const Liquid& liquid(std::uint32_t p) const { return liquids[liquid_of(p)]; }
  PointTriangle start(std::uint32_t p, std::uint32_t surface, std::uint32_t triangle) const {
    const SurfaceMotion& s = *surfaces[surface];
    OILSKIN_ASSERT(p < particles->x_t0.size() && triangle < s.triangles.size());
    const Triangle& t = s.triangles[triangle];
    return {particles->x_t0[p], s.x_t0[t[0]], s.x_t0[t[1]], s.x_t0[t[2]]};
  }
  PointTriangle end(std::uint32_t p, std::uint32_t surface, std::uint32_t triangle) const {
    const SurfaceMotion& s = *surfaces[surface];
    OILSKIN_ASSERT(p < particles->x_t1.size() && triangle < s.triangles.size());
    const Triangle& t = s.triangles[triangle];
    return {particles->x_t1[p], s.x_t1[t[0]], s.x_t1[t[1]], s.x_t1[t[2]]};
  }
  /// End positions change through these two functions only, so that every change has a stamp.
  void set_particle_end(std::uint32_t p, const Vec3& x) {
    OILSKIN_ASSERT(p < particles->x_t1.size() && !out_of_play[p]);
    OILSKIN_ASSERT(x.allFinite());
    particles->x_t1[p] = x;
    particle_stamp[p] = epoch;
  }
  void set_node_end(std::uint32_t surface, std::uint32_t node, const Vec3& x) {
    SurfaceMotion& s = *surfaces[surface];
    OILSKIN_ASSERT(node < s.x_t1.size());
    const Vec3 rounded = stored(x, s.storage);
    OILSKIN_ASSERT(rounded.allFinite());
    if (rounded == s.x_t1[node]) return;
    s.x_t1[node] = rounded;
    s.moved[node] = 1;
    s.touched.push_back(node);
    if (node_stamp[surface].empty()) node_stamp[surface].assign(s.x_t1.size(), 0);
    node_stamp[surface][node] = epoch;
    surface_stamp[surface] = epoch;
  }
};

}  // namespace oilskin::contact
