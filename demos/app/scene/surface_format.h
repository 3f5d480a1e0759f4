/// Keys that cloth, bodies, pins and emitters share.
#pragma once

#include "scene/fields.h"
#include "scene/scene.h"

namespace oilskin::demo {

void describe(Fields& f, SurfaceSettings& s);
void describe(Fields& f, Motion& m);

/// Of what has a start and a stop [s].
template <class T>
void describe_times(Fields& f, T& timed) {
  f.number("start", timed.start, not_negative());
  f.number("stop", timed.stop, not_negative());
  if (f.reading() && timed.stop < timed.start) f.fail("stop", "is before \"start\"");
}

}  // namespace oilskin::demo
