#include "study/comparators/study_hosts.h"

#include <cmath>

namespace oilskin::study {

namespace {

demo::Cloth cloth_of(const SheetSettings& settings) {
  demo::Cloth cloth;
  cloth.grid = {settings.cells + 1, settings.cells + 1};
  cloth.size = {settings.size, settings.size};
  cloth.areal_density = settings.areal_density;
  if (settings.held == Held::border) cloth.pins.kind = demo::PinKind::border;
  if (settings.held == Held::all) {
    cloth.pins.kind = demo::PinKind::boxes;
    cloth.pins.boxes.push_back({});
    cloth.pins.boxes.back().within = {Vec3::Constant(-settings.size), Vec3::Constant(settings.size)};
  }
  return cloth;
}

}  // namespace

Sheet::Sheet(const SheetSettings& settings) {
  const demo::Cloth cloth = cloth_of(settings);
  cloth_ = std::make_unique<demo::MockCloth>(cloth, demo::build_cloth(cloth, "sheet"));
}

void Sheet::advance(double dt, const Vec3& gravity) {
  cloth_->advance(time_, dt, gravity);
  time_ += dt;
}

demo::MockBody make_tank(const Box& inside) {
  demo::Body body;
  demo::TankShape tank;
  tank.inside = inside;
  body.shape = tank;
  return demo::MockBody(body, inside);
}

std::vector<Vec3> lattice_in(const Box& box, double spacing) {
  std::array<int, 3> n;
  for (int k = 0; k < 3; ++k)
    n[static_cast<std::size_t>(k)] = static_cast<int>(std::floor((box.max[k] - box.min[k]) / spacing + 1e-6));
  std::vector<Vec3> points;
  for (int j = 0; j < n[1]; ++j)
    for (int i = 0; i < n[0]; ++i)
      for (int k = 0; k < n[2]; ++k)
        points.push_back(box.min + spacing * (Vec3(i, j, k) + Vec3::Constant(0.5)));
  return points;
}

}  // namespace oilskin::study
