/// A symmetric tensor of each particle, as the loops over pairs read it.
#pragma once

#include <vector>

#include "fluid/pairs/pair_kernels.h"

namespace oilskin::fluid {

class TensorArray {
 public:
  bool empty() const { return diagonal_.empty(); }
  /// With one more for the padding, which is zero. Others keep their values.
  void resize(std::size_t particles) {
    for (std::vector<Record>* all : {&diagonal_, &rest_}) {
      all->resize(particles + 1);
      all->back() = {0, 0, 0, 0};
    }
  }
  SecondMoments operator[](std::size_t i) const {
    const Record &d = diagonal_[i], &r = rest_[i];
    return {d.x, d.y, d.z, r.x, r.y, r.z};
  }
  void set(std::size_t i, const SecondMoments& t) {
    diagonal_[i] = {t.xx, t.yy, t.zz, 0};
    rest_[i] = {t.xy, t.xz, t.yz, 0};
  }
  Tensors view() const { return {diagonal_.data(), rest_.data()}; }

 private:
  std::vector<Record> diagonal_, rest_;
};

}  // namespace oilskin::fluid
