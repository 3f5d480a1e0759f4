/// Hosts of the experiments: a sheet of cloth and a tank.
#pragma once

#include "hosts/mock_cloth.h"

namespace oilskin::study {

/// Which nodes of a sheet are held.
enum class Held { none, border, all };

/// A square sheet of position-based cloth, level, centred at the origin.
struct SheetSettings {
  double size = 0.2;           ///< length of an edge [m]
  int cells = 20;              ///< along an edge
  double areal_density = 0.2;  ///< [kg/m²]
  Held held = Held::border;
};

class Sheet {
 public:
  explicit Sheet(const SheetSettings& settings);
  /// Before each step of dt [s].
  void advance(double dt, const Vec3& gravity);
  SurfaceHost& host() { return *cloth_; }

 private:
  std::unique_ptr<demo::MockCloth> cloth_;
  double time_ = 0;
};

/// A box without its upper face, as one sheet of triangles that stands still. `inside` in [m].
demo::MockBody make_tank(const Box& inside);

/// The cubic lattice that fills a box, half a spacing from its faces.
std::vector<Vec3> lattice_in(const Box& box, double spacing);

}  // namespace oilskin::study
