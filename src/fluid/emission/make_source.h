/// Emitters as their users give them, checked and made into sources.
#pragma once

#include "fluid/emission/source.h"

namespace oilskin::fluid {

/// What emitters give.
struct SourceMaterial {
  double spacing = 0, rest_density = 0, particle_mass = 0;
};

/// Refusals name the field, its value and its range.
Status make_source(const DiscEmitter& emitter, const SourceMaterial& material, Source& source);
Status make_source(const BoxEmitter& emitter, const SourceMaterial& material, Source& source);
Status make_source(const MeshEmitter& emitter, const SourceMaterial& material, Source& source);
Status make_source(const RainEmitter& emitter, const SourceMaterial& material, Source& source);

Status check_speed(const char* field, double speed);
/// `layer`: the distance of the nozzle's layers [m].
Status check_nozzle_speed(const char* field, double speed, double layer);
Status check_drop_rate(const char* field, double rate);

}  // namespace oilskin::fluid
