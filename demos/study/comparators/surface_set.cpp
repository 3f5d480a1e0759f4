#include "study/comparators/surface_set.h"

#include <algorithm>
#include <cmath>

#include "study/comparators/box_tree.h"

namespace oilskin::study {

Status SurfaceSet::attach(SurfaceHost& host, double thickness, std::size_t* index) {
  auto motion = std::make_unique<SurfaceMotion>();
  motion->id = motions_.size() + 1;
  motion->thickness = thickness;
  hosts_.push_back(&host);
  pointers_.push_back(motion.get());
  motions_.push_back(std::move(motion));
  now_.emplace_back();
  target_.emplace_back();
  planned_.emplace_back();
  if (index != nullptr) *index = motions_.size() - 1;
  Status status = read(motions_.size() - 1, 0);
  if (!status.ok()) return status;
  now_.back() = pointers_.back()->x_t1;
  return status;
}

Status SurfaceSet::read(std::size_t surface, double dt) {
  SurfaceMotion& m = *motions_[surface];
  m.x_t0 = now_[surface];
  Gathered gathered = hosts_[surface]->gather(dt, m);
  if (!gathered.status.ok()) return gathered.status;
  if (gathered.new_surface || now_[surface].size() != m.x_t1.size()) now_[surface] = m.x_t1;
  target_[surface] = m.x_t1;
  m.impulse.assign(m.x_t1.size(), Vec3::Zero());
  m.moved.assign(m.x_t1.size(), 0);
  return gathered.status;
}

Status SurfaceSet::gather(double dt) {
  for (std::size_t s = 0; s < size(); ++s) {
    Status status = read(s, dt);
    if (!status.ok()) return status;
  }
  return Status::accepted();
}

void SurfaceSet::begin_interval(int remaining) {
  for (std::size_t s = 0; s < size(); ++s) {
    SurfaceMotion& m = *motions_[s];
    m.x_t0 = now_[s];
    for (std::size_t i = 0; i < m.x_t1.size(); ++i)
      m.x_t1[i] =
          remaining == 1 ? target_[s][i] : Vec3(now_[s][i] + (target_[s][i] - now_[s][i]) / remaining);
    planned_[s] = m.x_t1;
  }
}

void SurfaceSet::end_interval() {
  for (std::size_t s = 0; s < size(); ++s) {
    SurfaceMotion& m = *motions_[s];
    for (std::size_t i = 0; i < m.x_t1.size(); ++i) {
      const Vec3 displaced = m.x_t1[i] - planned_[s][i];
      if (displaced == Vec3::Zero()) continue;
      m.moved[i] = 1;
      target_[s][i] += displaced;
    }
    now_[s] = m.x_t1;
  }
}

void SurfaceSet::scatter() {
  for (std::size_t s = 0; s < size(); ++s) {
    SurfaceMotion& m = *motions_[s];
    for (Vec3& x : m.x_t1) x = stored(x, m.storage);
    hosts_[s]->scatter(m);
    now_[s] = m.x_t1;
  }
}

void SurfaceSet::push(std::size_t surface, const Triangle& nodes, const std::array<double, 3>& weights,
                      const Vec3& impulse) {
  SurfaceMotion& m = *motions_[surface];
  for (std::size_t k = 0; k < 3; ++k) {
    m.impulse[nodes[k]] += weights[k] * impulse;
    m.velocity[nodes[k]] += m.inverse_mass[nodes[k]] * weights[k] * impulse;
  }
}

namespace {

/// The closest point of the edge a–b, as the weight of b.
double along_edge(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 edge = b - a;
  const double length2 = edge.squaredNorm();
  return length2 > 0 ? std::clamp((p - a).dot(edge) / length2, 0.0, 1.0) : 0;
}

Vec3 weighted(const std::array<Vec3, 3>& corner, const std::array<double, 3>& w) {
  return w[0] * corner[0] + w[1] * corner[1] + w[2] * corner[2];
}

const std::vector<Vec3>& nodes_at(const SurfaceMotion& m, At at) {
  return at == At::start ? m.x_t0 : m.x_t1;
}

BoxTree tree_of(const SurfaceMotion& m, double reach, At at) {
  const std::vector<Vec3>& x = nodes_at(m, at);
  std::vector<Box> boxes;
  for (const Triangle& triangle : m.triangles) {
    Box box;
    for (std::uint32_t node : triangle) box.add(x[node]);
    boxes.push_back(box.inflated(reach));
  }
  BoxTree tree;
  tree.build(std::move(boxes));
  return tree;
}

/// Keeps those in different directions, nearest first.
void keep_directions(std::vector<Near>& near) {
  constexpr double same_direction = 0.9;
  std::stable_sort(near.begin(), near.end(),
                   [](const Near& a, const Near& b) { return a.distance < b.distance; });
  std::size_t kept = 0;
  for (std::size_t k = 0; k < near.size(); ++k) {
    const bool is_new =
        std::none_of(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(kept),
                     [&](const Near& n) { return n.normal.dot(near[k].normal) > same_direction; });
    if (is_new) near[kept++] = near[k];
  }
  near.resize(kept);
}

}  // namespace

std::array<double, 3> closest_weights(const Vec3& p, const std::array<Vec3, 3>& corner) {
  const Vec3 u = corner[1] - corner[0], w = corner[2] - corner[0], q = p - corner[0];
  const Vec3 normal = u.cross(w);
  const double area = normal.squaredNorm();
  const double b = q.cross(w).dot(normal), c = u.cross(q).dot(normal);
  if (area > 0 && b >= 0 && c >= 0 && b + c <= area) return {1 - (b + c) / area, b / area, c / area};
  std::array<double, 3> best{};
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3;
    std::array<double, 3> weights{};
    weights[next] = along_edge(p, corner[k], corner[next]);
    weights[k] = 1 - weights[next];
    const double distance = (p - weighted(corner, weights)).squaredNorm();
    if (distance < least) least = distance, best = weights;
  }
  return best;
}

std::vector<Near> find_near(Span<const Vec3> particles, const SurfaceSet& surfaces, double reach, At at) {
  std::vector<BoxTree> trees;
  for (std::size_t s = 0; s < surfaces.size(); ++s) trees.push_back(tree_of(surfaces[s], reach, at));
  std::vector<Near> all, own;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    for (std::size_t s = 0; s < surfaces.size(); ++s) {
      const SurfaceMotion& m = surfaces[s];
      const std::vector<Vec3>& x = nodes_at(m, at);
      own.clear();
      trees[s].for_each_overlap({particles[i], particles[i]}, [&](std::uint32_t t) {
        const Triangle& nodes = m.triangles[t];
        const std::array<Vec3, 3> corner = {x[nodes[0]], x[nodes[1]], x[nodes[2]]};
        const std::array<double, 3> weights = closest_weights(particles[i], corner);
        const Vec3 offset = particles[i] - weighted(corner, weights);
        const double distance = offset.norm();
        // A particle in the triangle itself has no side.
        if (distance < reach && distance > 0)
          own.push_back({i, s, nodes, weights, offset / distance, distance});
      });
      keep_directions(own);
      all.insert(all.end(), own.begin(), own.end());
    }
  }
  return all;
}

}  // namespace oilskin::study
