#include "study/comparators/box_tree.h"

#include <algorithm>
#include <numeric>

namespace oilskin::study {

void BoxTree::build(std::vector<Box> boxes) {
  boxes_ = std::move(boxes);
  order_.resize(boxes_.size());
  std::iota(order_.begin(), order_.end(), 0u);
  nodes_.clear();
  if (!boxes_.empty()) add(0, static_cast<std::uint32_t>(boxes_.size()));
}

std::uint32_t BoxTree::add(std::uint32_t begin, std::uint32_t end) {
  constexpr std::uint32_t leaf_size = 4;
  const auto index = static_cast<std::uint32_t>(nodes_.size());
  nodes_.emplace_back();
  Box box, centres;
  for (std::uint32_t k = begin; k < end; ++k) {
    box.add(boxes_[order_[k]]);
    centres.add(Vec3(boxes_[order_[k]].min + boxes_[order_[k]].max));
  }
  nodes_[index] = {box, begin, end, 0};
  if (end - begin <= leaf_size) return index;
  int axis = 0;
  (centres.max - centres.min).maxCoeff(&axis);
  const auto centre = [&](std::uint32_t i) { return boxes_[i].min[axis] + boxes_[i].max[axis]; };
  const auto first = order_.begin() + begin, last = order_.begin() + end;
  const std::uint32_t middle = begin + (end - begin) / 2;
  std::nth_element(first, order_.begin() + middle, last, [&](std::uint32_t a, std::uint32_t b) {
    return centre(a) != centre(b) ? centre(a) < centre(b) : a < b;
  });
  add(begin, middle);
  const std::uint32_t right = add(middle, end);
  nodes_[index].right = right;
  return index;
}

}  // namespace oilskin::study
