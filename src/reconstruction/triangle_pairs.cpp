#include "reconstruction/triangle_pairs.h"

namespace oilskin::reconstruction {

void for_near_pairs(const std::vector<std::array<float, 3>>& positions,
                    const std::vector<Triangle>& triangles, const std::vector<std::uint32_t>* only,
                    const Obstacles& obstacles, double reach, const Workers& workers,
                    const std::function<void(std::uint32_t, Span<const std::uint32_t>)>& f) {
  if (obstacles.empty()) return;
  // A mesh of 1,000 particles has some 6,000 triangles near cloth: enough batches for its threads.
  constexpr std::size_t batch = 1 << 9, chunk = 16;
  const std::size_t n = only ? only->size() : triangles.size();
  const Box bounds = obstacles.bounds();
  const auto number = [only](std::size_t k) { return only ? (*only)[k] : static_cast<std::uint32_t>(k); };
  workers.for_chunks(n, batch, [&](std::size_t from, std::size_t to, std::size_t) {
    std::vector<std::uint32_t> candidates, own;
    std::vector<Box> candidate_boxes;
    for (std::size_t k = from; k < to; k += chunk) {
      // Consecutive triangles are close in space, so they share a query.
      Box all;
      std::array<Box, chunk> boxes;
      const std::size_t end = std::min(to, k + chunk);
      for (std::size_t m = k; m < end; ++m) {
        for (const Vec3& x : stored_corners(positions, triangles[number(m)])) boxes[m - k].add(x);
        boxes[m - k] = boxes[m - k].inflated(reach);
        if (bounds.overlaps(boxes[m - k])) all.add(boxes[m - k]);
      }
      if (!(all.min.x() <= all.max.x())) continue;
      candidates.clear();
      obstacles.query(all, candidates);
      if (candidates.empty()) continue;
      candidate_boxes.clear();
      for (std::uint32_t c : candidates) candidate_boxes.push_back(obstacles.box(c));
      for (std::size_t m = k; m < end; ++m) {
        own.clear();
        for (std::size_t c = 0; c < candidates.size(); ++c)
          if (candidate_boxes[c].overlaps(boxes[m - k])) own.push_back(candidates[c]);
        if (!own.empty()) f(number(m), own);
      }
    }
  });
}

}  // namespace oilskin::reconstruction
