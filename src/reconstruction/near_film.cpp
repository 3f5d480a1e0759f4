#include "reconstruction/near_film.h"

namespace oilskin::reconstruction {

void NearFilm::set(const Film& film, const NearParticles& near) {
  for (std::vector<float>* v : {&x_, &y_, &z_, &nx_, &ny_, &nz_, &height_}) v->clear();
  items_.clear();
  particles_.clear();
  const auto add = [this](float x, float y, float z, const std::array<float, 3>& normal, float height) {
    x_.push_back(x);
    y_.push_back(y);
    z_.push_back(z);
    nx_.push_back(normal[0]);
    ny_.push_back(normal[1]);
    nz_.push_back(normal[2]);
    height_.push_back(height);
  };
  for (std::size_t c = 0; c < near.count; ++c) {
    for (const FilmParticle *item = film.find(near.particle[c]), *first = item; item;
         item = item == first ? film.opposite(*item) : nullptr) {
      add(near.x[c], near.y[c], near.z[c], item->normal, item->height);
      items_.push_back(item);
      particles_.push_back(near.particle[c]);
    }
  }
  while (x_.size() % 8 != 0) add(1e15f, 1e15f, 1e15f, {0, 0, 0}, 0);
}

}  // namespace oilskin::reconstruction
