/// The files of a frame that other programs read.
#pragma once

#include <string>
#include <vector>

#include "output/frame_path.h"
#include "output/frames.h"

namespace oilskin::demo {

void write_particles(const std::string& path, const FrameData& data);
/// PLY, binary little endian, float32.
void write_mesh(const std::string& path, const SurfaceMotion& motion);
/// The series of particle files for ParaView; rewritten with every frame, so that a stopped run is complete.
void write_series(const std::string& directory, const std::vector<double>& times);

}  // namespace oilskin::demo
