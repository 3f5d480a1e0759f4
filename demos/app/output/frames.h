/// The interface to pictures and ParaView files of a run.
#pragma once

#include <memory>
#include <string>

#include "oilskin/surface_motion.h"
#include "scene/scene.h"

namespace oilskin::demo {

/// "3 crossings" by contact.verify, or that they are not counted.
inline std::string crossings_text(bool verifies, std::uint64_t found) {
  return verifies ? std::to_string(found) + " crossings" : "crossings not counted";
}

/// The state to show at one moment. Nothing is owned.
struct FrameData {
  double t = 0;  ///< [s]
  Span<const std::uint64_t> id;
  Span<const Vec3> position, velocity;
  Span<const double> density, pressure;
  Span<const float> mass_ratio;                     ///< over `particle_mass`; empty = all are 1
  double particle_mass = 0;                         ///< of a new particle [kg]
  std::vector<const SurfaceMotion*> cloth, bodies;  ///< drawn at x_t1; null = left out
  std::vector<std::vector<float>> wetness;          ///< per cloth: saturation of its nodes; empty = dry
  const WaterMesh* water_mesh = nullptr;            ///< the water's, if the scene wants one
  std::string crossings;                            ///< crossings_text() so far
};

struct FrameOptions {
  std::string directory;
  bool files = true;     ///< cloth_K_NNNN.ply, body_K_NNNN.ply, particles_NNNN.vtp, run.pvd
  bool pictures = true;  ///< frame_NNNN.png
  bool window = false;
};

class Frames {
 public:
  virtual ~Frames() = default;
  /// Throws OutputError when a file cannot be written.
  virtual void write(int number, const FrameData& data) = 0;
  /// False once the window was closed.
  virtual bool window_open() const = 0;
};

}  // namespace oilskin::demo
