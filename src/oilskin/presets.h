/// Settings for three purposes. What each of them gives up: docs/manual/presets.md.
#pragma once

#include "oilskin/settings.h"

namespace oilskin {

/// A length of steps and the settings that go with it. All fields may be changed.
struct Preset {
  /// The step [s].
  double dt = 0;
  /// The fluid, with the preset's spacing.
  FluidSettings fluid;
  /// Contact.
  ContactSettings contact;
};

/// For games: `steps_per_frame` ≥ 1 steps in a frame of 1/60 s. Density errors up to 1 % remain in the mean,
/// and the cost of a step is limited: 20 pressure iterations, and as many fluid sub-steps as water at rest
/// needs, with one more.
Preset game_preset(double spacing, int steps_per_frame = 2);

/// For films: a frame of 1/24 s in equal steps of at most 0.05 √(dx/g), g = 9.81 m/s², in sub-steps of at
/// most half a spacing; density errors of 0.1 %.
Preset film_preset(double spacing);

/// For measurements: steps of 0.02 √(dx/g), displacements of at most a fifth of a spacing, density errors of
/// 0.01 %, and every interval is verified.
Preset measurement_preset(double spacing);

}  // namespace oilskin
