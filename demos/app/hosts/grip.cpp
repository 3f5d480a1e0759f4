#include "hosts/grip.h"

#include <algorithm>
#include <cmath>

namespace oilskin::demo {
namespace {

constexpr double rate = 20;      // of the approach [1/s]
constexpr double max_speed = 3;  // [m/s]

std::size_t nearest_node(const std::vector<Vec3>& x, const Vec3& point) {
  std::size_t nearest = 0;
  for (std::size_t k = 1; k < x.size(); ++k)
    if ((x[k] - point).squaredNorm() < (x[nearest] - point).squaredNorm()) nearest = k;
  return nearest;
}

/// A node first, then those that share a triangle with it, in ascending order.
std::vector<std::size_t> ring_of(std::size_t node, const ClothModel& model) {
  std::vector<std::size_t> ring;
  for (const Triangle& t : model.triangles)
    if (std::find(t.begin(), t.end(), node) != t.end()) ring.insert(ring.end(), t.begin(), t.end());
  std::sort(ring.begin(), ring.end());
  ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
  ring.erase(std::remove(ring.begin(), ring.end(), node), ring.end());
  ring.insert(ring.begin(), node);
  return ring;
}

}  // namespace

void Grip::advance(double dt) {
  const Vec3 way = (goal - place) * -std::expm1(-rate * dt);
  const double length = way.norm(), limit = max_speed * dt;
  velocity = (length > limit ? Vec3(way * (limit / length)) : way) / dt;
  place += velocity * dt;
}

std::optional<Grip> grip_of_cloth(std::size_t index, const ClothModel& model, const std::vector<Vec3>& x,
                                  const std::vector<bool>& follows, const Vec3& point) {
  const std::size_t node = nearest_node(x, point);
  if (follows[node]) return {};
  Grip grip;
  grip.index = index;
  grip.start = grip.place = grip.goal = x[node];
  for (const std::size_t k : ring_of(node, model)) {
    if (follows[k]) continue;
    grip.nodes.push_back(k);
    grip.offsets.push_back(x[k] - x[node]);
  }
  return grip;
}

Grip grip_of_body(std::size_t index, const Vec3& point) {
  Grip grip;
  grip.is_body = true;
  grip.index = index;
  grip.start = grip.place = grip.goal = point;
  return grip;
}

}  // namespace oilskin::demo
