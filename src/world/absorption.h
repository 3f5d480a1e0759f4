/// Liquid in surfaces: what effects change of it within a step, and particles that surfaces release.
#pragma once

#include "fluid/particles.h"
#include "oilskin/effect.h"
#include "world/attachments.h"
#include "world/ledger.h"

namespace oilskin::world {

/// Gives node `node` liquid of a particle with velocity u [m/s].
void absorb(Attachment& a, std::uint32_t node, double mass, const Vec3& u);
/// At most what `from` has passes to `to`.
void transport(Attachment& a, std::uint32_t from, std::uint32_t to, double mass);
/// Takes at most what the node has; returns what it took [kg].
double take(Attachment& a, std::uint32_t node, double mass);
/// Of all nodes [kg].
double absorbed_mass(const Attachment& a);

/// The releases of a step whose place is free, as new particles. The surfaces are at x_t1.
void release_particles(Span<const Release> releases, const ActiveSurfaces& active, const WorldSettings& world,
                       double spacing, double rest_density, double particle_mass, const Workers& workers,
                       fluid::Particles& particles, std::uint64_t& next_id, Ledger& ledger);

/// Before the host's scatter: what arrived in `a` with another velocity changes that of its node in `motion`,
/// as an impulse more. Returns the impulses without it, or none if nothing arrived.
std::vector<Vec3> add_momentum_of_liquid(Attachment& a, SurfaceMotion& motion);

}  // namespace oilskin::world
