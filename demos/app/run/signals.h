/// Stops a run at the end of its step on SIGINT or SIGTERM; a third one ends it at once.
#pragma once

namespace oilskin::demo {

void watch_signals();
/// The signal that came, or 0.
int caught_signal();

}  // namespace oilskin::demo
