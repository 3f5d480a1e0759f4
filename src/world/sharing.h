/// Surfaces that several worlds have, in a step of these worlds: see Sharing.
#pragma once

#include "world/attachments.h"

namespace oilskin::world {

inline const Attachment* original_of(const Attachment& a) {
  return a.sharing.original ? a.sharing.original : &a;
}

/// Calls f with the attachments of one host, the original first.
template <class F>
void for_all_of(Attachment& original, F f) {
  f(original);
  for (Attachment* copy : original.sharing.copies) f(*copy);
}

/// SurfaceHost::gather(); a copy takes what its original was given.
Gathered read_host(Attachment& a, double dt);

/// SurfaceHost::scatter() of an original, or of a surface that one world has.
void write_host(Attachment& original);

/// The settings of a surface may differ between worlds, as its default thickness does with the spacing: it
/// has the smallest, which pushes no fluid away, and δ for coordinates up to `reach` [m].
void share_thickness(Attachment& original, double reach);

/// The copies have the end of an interval or a step: positions, velocities, impulses.
void copy_end(Attachment& original);

}  // namespace oilskin::world
