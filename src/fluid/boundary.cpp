#include "fluid/boundary.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/assert.h"
#include "core/closest_point.h"
#include "fluid/lattice.h"
#include "fluid/occlusion.h"
#include "fluid/wall_integral.h"

namespace oilskin::fluid {

namespace {

constexpr std::size_t triangle_chunk = 64, point_chunk = 256;

/// How much a sheet may bend within the support radius and still count as the plane through its closest
/// point: cosine between normals, and distance of corners from the plane in units of H.
constexpr double plane_cosine = 0.996, plane_distance = 0.06;

/// Mean time of what is remembered of loads and answers [s]. Shorter, and the water feels how the host
/// shakes; longer, and it feels a load that is no more.
constexpr double memory_time = 0.05;

/// How exactly the answers of light sheets are solved for, and up to which ratio of stiffnesses.
constexpr double solve_tolerance = 0.3, max_condition = 50;

/// Triangles that have the nodes of an earlier one.
std::vector<std::uint8_t> repeated_triangles(const SurfaceMotion& s) {
  std::vector<std::pair<Triangle, std::uint32_t>> sorted;
  for (std::uint32_t t = 0; t < s.triangles.size(); ++t) {
    Triangle nodes = s.triangles[t];
    std::sort(nodes.begin(), nodes.end());
    sorted.push_back({nodes, t});
  }
  std::sort(sorted.begin(), sorted.end());
  std::vector<std::uint8_t> repeated(s.triangles.size(), 0);
  for (std::size_t k = 1; k < sorted.size(); ++k)
    if (sorted[k].first == sorted[k - 1].first) repeated[sorted[k].second] = 1;
  return repeated;
}

std::vector<std::uint8_t> triangles_at_border(const SurfaceMotion& s,
                                              const std::vector<std::uint8_t>& repeated) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (std::size_t t = 0; t < s.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3 && !repeated[t]; ++k)
      edges.push_back(std::minmax(s.triangles[t][k], s.triangles[t][(k + 1) % 3]));
  std::sort(edges.begin(), edges.end());
  std::vector<std::uint8_t> node_at_border(s.x_t0.size(), 0), at_border;
  for (std::size_t k = 0; k < edges.size();) {
    std::size_t stop = k;
    while (stop < edges.size() && edges[stop] == edges[k]) ++stop;
    if (stop - k != 2) node_at_border[edges[k].first] = node_at_border[edges[k].second] = 1;
    k = stop;
  }
  for (const Triangle& t : s.triangles)
    at_border.push_back(node_at_border[t[0]] | node_at_border[t[1]] | node_at_border[t[2]]);
  return at_border;
}

}  // namespace

/// A triangle within H of a particle.
struct Boundary::Near {
  std::uint32_t particle = 0, surface = 0, triangle = 0;
  ClosestPoint closest;
};

Boundary::Boundary(double support_ratio) {
  // d ln λ/dζ grows with a.
  const double mass = lattice_mass_beyond<CubicSpline>(support_ratio), z = 0.5 / support_ratio;
  const double slope = settled_pull * 2 * lattice_pull_beyond<CubicSpline>(support_ratio) / mass;
  double low = 0.5, high = 0.999 / z;
  for (int k = 0; k < 60; ++k) {
    const double image_offset = 0.5 * (low + high);
    (image_offset * plane_integral_slope(image_offset * z) < slope * plane_integral(image_offset * z)
         ? low
         : high) = image_offset;
  }
  image_offset_ = static_cast<float>(low);
  image_mass_ = static_cast<float>(mass / plane_integral(low * z));
}

void Boundary::clear() {
  points_.clear();
  walls_.clear();
  nodes_.clear();
}

void Boundary::find(double dt, double particle_mass, const Vec3& down, Span<const Vec3> x,
                    const Neighbours& neighbours, double support_radius, Span<SurfaceMotion* const> surfaces,
                    const Workers& workers) {
  OILSKIN_ASSERT(dt > 0 && particle_mass > 0 && support_radius > 0 && neighbours.size() == x.size());
  clear();
  support_radius_ = support_radius;
  mass_ = particle_mass;
  down_ = down.cast<float>();
  surfaces_.assign(surfaces.begin(), surfaces.end());
  for (const SurfaceMotion* s : surfaces) {
    SurfaceMemory& memory = memory_[s->id];
    if (memory.at_border.size() != s->triangles.size()) {
      memory.repeated = repeated_triangles(*s);
      memory.at_border = triangles_at_border(*s, memory.repeated);
    }
    if (memory.nodes.size() != s->x_t0.size()) memory.nodes.assign(s->x_t0.size(), {});
  }
  std::vector<std::vector<Near>> found;
  collect_near(x, neighbours, surfaces, workers, found);
  make_points(x, surfaces, workers, found);
  if (points_.empty()) return;
  number_nodes(dt, surfaces);
  couple(workers);
  find_yielding(workers);
}

// From the triangles' side: most particles are near none.
void Boundary::collect_near(Span<const Vec3> x, const Neighbours& neighbours,
                            Span<SurfaceMotion* const> surfaces, const Workers& workers,
                            std::vector<std::vector<Near>>& found) const {
  const double reach = support_radius_, plane_reach = reach / static_cast<double>(image_offset_);
  for (std::uint32_t s = 0; s < surfaces.size(); ++s) {
    const SurfaceMotion& motion = *surfaces[s];
    const std::vector<std::uint8_t>& repeated = memory_.at(motion.id).repeated;
    const std::size_t first = found.size();
    found.resize(first + (motion.triangles.size() + triangle_chunk - 1) / triangle_chunk);
    workers.for_chunks(
        motion.triangles.size(), triangle_chunk, [&](std::size_t begin, std::size_t end, std::size_t chunk) {
          for (std::size_t t = begin; t < end; ++t) {
            if (repeated[t]) continue;
            const Triangle& node = motion.triangles[t];
            const Vec3 &a = motion.x_t0[node[0]], &b = motion.x_t0[node[1]], &c = motion.x_t0[node[2]];
            Box box;
            for (const Vec3& corner : {a, b, c}) box.add(corner);
            box = box.inflated(reach);
            const Vec3 cross = (b - a).cross(c - a);
            const double inverse_norm = cross.norm() > 0 ? 1 / cross.norm() : 0;
            neighbours.for_runs_in(box, [&](std::uint32_t run_begin, std::uint32_t run_end) {
              for (std::uint32_t i = run_begin; i < run_end; ++i) {
                if (!box.contains(x[i])) continue;
                const double z = cross.dot(x[i] - a) * inverse_norm;
                if (std::abs(z) >= plane_reach) continue;
                const ClosestPoint closest = closest_point(x[i], a, b, c);
                if (closest.distance < reach)
                  found[first + chunk].push_back({i, s, static_cast<std::uint32_t>(t), closest});
              }
            });
          }
        });
  }
}

void Boundary::make_points(Span<const Vec3> x, Span<SurfaceMotion* const> surfaces, const Workers& workers,
                           const std::vector<std::vector<Near>>& found) {
  // Counting sort by particle; in the order of triangles within each.
  std::vector<std::uint32_t> begin(x.size() + 1, 0);
  for (const auto& part : found)
    for (const Near& n : part) ++begin[n.particle + 1];
  point_of_.assign(x.size(), none);
  for (std::uint32_t i = 0; i < x.size(); ++i) {
    if (begin[i + 1] > 0) {
      point_of_[i] = static_cast<std::uint32_t>(points_.size());
      points_.emplace_back();
      points_.back().particle = i;
    }
    begin[i + 1] += begin[i];
  }
  std::vector<Near> near(begin.back());
  OILSKIN_ASSERT(points_.size() <= x.size());
  std::vector<std::uint32_t> at(begin.begin(), begin.end() - 1);
  for (const auto& part : found)
    for (const Near& n : part) near[at[n.particle]++] = n;

  std::vector<std::vector<Wall>> walls((points_.size() + point_chunk - 1) / point_chunk);
  workers.for_chunks(points_.size(), point_chunk, [&](std::size_t b, std::size_t e, std::size_t c) {
    for (std::size_t k = b; k < e; ++k) {
      Point& point = points_[k];
      const std::uint32_t i = point.particle;
      point.begin = static_cast<std::uint32_t>(walls[c].size());
      integrate(x[i], surfaces, {near.data() + begin[i], begin[i + 1] - begin[i]}, point, walls[c]);
      point.end = static_cast<std::uint32_t>(walls[c].size());
      for (std::uint32_t w = point.begin; w < point.end; ++w)
        walls[c][w].point = static_cast<std::uint32_t>(k);
    }
  });
  for (std::size_t c = 0; c < walls.size(); ++c) {
    const auto base = static_cast<std::uint32_t>(walls_.size());
    for (std::size_t k = c * point_chunk; k < std::min(points_.size(), (c + 1) * point_chunk); ++k) {
      points_[k].begin += base;
      points_[k].end += base;
    }
    walls_.insert(walls_.end(), walls[c].begin(), walls[c].end());
  }
}

// Nodes of walls are surface and node for now; number_nodes() makes them indices.
void Boundary::integrate(const Vec3& x, Span<SurfaceMotion* const> surfaces, Span<const Near> near,
                         Point& point, std::vector<Wall>& walls) const {
  OILSKIN_ASSERT(!near.empty() && point.begin == walls.size());
  std::size_t nearest = 0;
  for (std::size_t k = 1; k < near.size(); ++k)
    if (near[k].closest.distance < near[nearest].closest.distance) nearest = k;
  // Cloth that follows the water oscillates more with the hydrostatic term
  // (docs/decisions/0001-mirrored-boundary.md).
  const auto yields = [&](const Near& n) {
    const SurfaceMotion& s = *surfaces[n.surface];
    const Triangle& t = s.triangles[n.triangle];
    return std::any_of(t.begin(), t.end(), [&](std::uint32_t node) { return s.inverse_mass[node] > 0; });
  };
  const auto add = [&](const Near& n, const WallView& view) {
    const float image = image_offset_ * view.distance;
    if (!(image < 1) || !(view.share > 0)) return;
    Wall wall;
    wall.node = {n.surface, n.triangle, 0};
    wall.weight = {static_cast<float>(n.closest.weights[0]), static_cast<float>(n.closest.weights[1])};
    wall.gamma = image_offset_ * image_mass_ * view.share * plane_integral_slope(image) * view.normal;
    wall.lambda = image_mass_ * view.share * plane_integral(image);
    wall.depth = yields(n) ? 0 : -view.distance * view.normal.dot(down_);
    OILSKIN_ASSERT(wall.lambda >= 0 && wall.gamma.allFinite());
    walls.push_back(wall);
    point.add(wall.lambda, wall.gamma, wall.depth);
  };
  const ClosestPoint& c = near[nearest].closest;
  if (c.distance > 0 && is_plane(surfaces, near, nearest)) {
    WallView plane;
    plane.distance = static_cast<float>(c.distance / support_radius_);
    plane.share = 1;
    plane.normal = (c.offset / c.distance).cast<float>();
    return add(near[nearest], plane);
  }
  for (const Near& n : near) {
    const SurfaceMotion& s = *surfaces[n.surface];
    std::array<Eigen::Vector3f, 3> corners;
    for (std::size_t k = 0; k < 3; ++k)
      corners[k] = ((s.x_t0[s.triangles[n.triangle][k]] - x) / support_radius_).cast<float>();
    add(n, view_of_wall(corners));
  }
  const float of_nearest_plane =
      image_mass_ * plane_integral(image_offset_ * static_cast<float>(c.distance / support_radius_));
  if (point.lambda > 1.05f * of_nearest_plane) drop_hidden(x, surfaces, near, point, walls);
  if (point.lambda <= 1) return;
  // In a narrow corner: there is no more to be seen than everything. Density and push stay of one function.
  const float share = 1 / point.lambda;
  point.lambda = 1;
  point.gamma *= share;
  point.lift *= share;
  for (std::size_t w = point.begin; w < walls.size(); ++w) walls[w].gamma *= share;
}

/// Layers behind a layer, floors that go on behind walls, and sheets that lie on a sheet are no walls for
/// this particle: those whose closest point it does not see, or sees on an earlier one.
void Boundary::drop_hidden(const Vec3& x, Span<SurfaceMotion* const> surfaces, Span<const Near> near,
                           Point& point, std::vector<Wall>& walls) const {
  std::vector<SightTest> test;
  std::vector<double> own_side;
  std::vector<std::uint32_t> by_distance;
  for (std::uint32_t k = 0; k < near.size(); ++k) {
    test.emplace_back(*surfaces[near[k].surface], near[k].triangle);
    own_side.push_back(test[k].side(x));
    by_distance.push_back(k);
  }
  std::sort(by_distance.begin(), by_distance.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::make_pair(near[a].closest.distance, a) < std::make_pair(near[b].closest.distance, b);
  });
  const auto adjoin = [&](const Near& a, const Near& b) {
    if (a.surface != b.surface) return false;
    const Triangle &s = surfaces[a.surface]->triangles[a.triangle],
                   &t = surfaces[b.surface]->triangles[b.triangle];
    return std::any_of(t.begin(), t.end(),
                       [&](std::uint32_t n) { return std::find(s.begin(), s.end(), n) != s.end(); });
  };
  const auto is_same_place = [&](std::uint32_t a, std::uint32_t b) {
    return (near[a].closest.offset - near[b].closest.offset).norm() <= 1e-6 * support_radius_;
  };
  const auto is_hidden = [&](std::uint32_t k) {
    for (std::uint32_t o = 0; o < k; ++o)
      if (!adjoin(near[k], near[o]) && is_same_place(k, o) && test[o].is_parallel_to(test[k])) return true;
    const Vec3 at = x - near[k].closest.offset;
    for (std::uint32_t o : by_distance) {
      if (o == k) return false;  // what follows is farther
      if (test[o].normal_length() == 0 || adjoin(near[k], near[o]) || is_same_place(k, o)) continue;
      const double side = test[o].side(at);
      const bool in_its_plane = std::abs(side) <= 1e-6 * support_radius_ * test[o].normal_length() &&
                                test[o].is_parallel_to(test[k]);
      if (!in_its_plane && test[o].blocks(x, at, own_side[o], side)) return true;
    }
    return false;
  };
  point.lambda = point.deepest = 0;
  point.gamma.setZero();
  point.lift.setZero();
  std::size_t kept = point.begin;
  std::uint32_t k = 0;  // walls are in the order of `near`, some of which are none
  for (std::size_t w = point.begin; w < walls.size(); ++w, ++k) {
    while (near[k].surface != walls[w].node[0] || near[k].triangle != walls[w].node[1]) ++k;
    if (is_hidden(k)) continue;
    walls[kept] = walls[w];
    point.add(walls[kept].lambda, walls[kept].gamma, walls[kept].depth);
    ++kept;
  }
  walls.resize(kept);
}

/// Is everything near the particle one plane sheet without a border? Then its closest point tells all.
bool Boundary::is_plane(Span<SurfaceMotion* const> surfaces, Span<const Near> near,
                        std::size_t nearest) const {
  const ClosestPoint& c = near[nearest].closest;
  const Vec3 normal = c.offset / c.distance;
  const double tolerance = plane_distance * support_radius_;
  for (const Near& n : near) {
    const SurfaceMotion& s = *surfaces[n.surface];
    if (n.surface != near[nearest].surface || memory_.at(s.id).at_border[n.triangle]) return false;
    const Triangle& t = s.triangles[n.triangle];
    const Vec3 cross = (s.x_t0[t[1]] - s.x_t0[t[0]]).cross(s.x_t0[t[2]] - s.x_t0[t[0]]);
    if (!(std::abs(cross.dot(normal)) >= plane_cosine * cross.norm())) return false;
    // Another layer has the same normal, but lies off the plane.
    if (std::abs(n.closest.offset.dot(normal) - c.distance) > tolerance) return false;
  }
  return true;
}

void Boundary::number_nodes(double dt, Span<SurfaceMotion* const> surfaces) {
  std::vector<std::vector<std::uint32_t>> number(surfaces.size());
  for (std::size_t s = 0; s < surfaces.size(); ++s) number[s].assign(surfaces[s]->x_t0.size(), none);
  for (Wall& wall : walls_) {
    const std::uint32_t s = wall.node[0];
    const SurfaceMotion& motion = *surfaces[s];
    const Triangle& triangle = motion.triangles[wall.node[1]];
    for (std::size_t k = 0; k < 3; ++k) {
      std::uint32_t& n = number[s][triangle[k]];
      if (n == none) {
        n = static_cast<std::uint32_t>(nodes_.size());
        Node node;
        node.surface = s;
        node.node = triangle[k];
        node.inverse_mass = static_cast<float>(motion.inverse_mass[triangle[k]]);
        node.velocity = ((motion.x_t1[triangle[k]] - motion.x_t0[triangle[k]]) / dt).cast<float>();
        const NodeMemory& memory = memory_.at(motion.id).nodes[triangle[k]];
        const double load2 = memory.load.squaredNorm();
        if (node.inverse_mass > 0 && load2 > 0) {
          const double carried = std::clamp(-memory.answer.dot(memory.load) / load2, 0.0, 1.0);
          node.expected = (carried * dt * memory.load).cast<float>();
        }
        nodes_.push_back(node);
      }
      wall.node[k] = n;
    }
  }
  corners_begin_.assign(nodes_.size() + 1, 0);
  for (const Wall& wall : walls_)
    for (std::uint32_t n : wall.node) ++corners_begin_[n + 1];
  for (std::size_t n = 0; n < nodes_.size(); ++n) corners_begin_[n + 1] += corners_begin_[n];
  OILSKIN_ASSERT(corners_begin_.back() == 3 * walls_.size());
  corners_.resize(corners_begin_.back());
  std::vector<std::uint32_t> at(corners_begin_.begin(), corners_begin_.end() - 1);
  for (std::uint32_t w = 0; w < walls_.size(); ++w)
    for (std::uint8_t k = 0; k < 3; ++k) corners_[at[walls_[w].node[k]]++] = {w, k};
}

/// Walls of a point share most of their nodes: the iterations read each pair of point and node once.
void Boundary::couple(const Workers& workers) {
  std::vector<std::vector<Coupling>> found((points_.size() + point_chunk - 1) / point_chunk);
  of_point_begin_.assign(points_.size() + 1, 0);
  workers.for_chunks(points_.size(), point_chunk, [&](std::size_t begin, std::size_t end, std::size_t chunk) {
    std::vector<Coupling>& list = found[chunk];
    for (std::size_t k = begin; k < end; ++k) {
      const std::size_t first = list.size();
      for (std::uint32_t w = points_[k].begin; w < points_[k].end; ++w)
        for (int c = 0; c < 3; ++c) {
          const std::uint32_t node = walls_[w].node[static_cast<std::size_t>(c)];
          const Eigen::Vector3f gamma = static_cast<float>(walls_[w].share(c)) * walls_[w].gamma;
          const auto same = std::find_if(list.begin() + static_cast<std::ptrdiff_t>(first), list.end(),
                                         [node](const Coupling& o) { return o.other == node; });
          if (same != list.end())
            same->gamma += gamma;
          else
            list.push_back({node, gamma});
        }
      of_point_begin_[k + 1] = static_cast<std::uint32_t>(list.size() - first);
    }
  });
  std::partial_sum(of_point_begin_.begin(), of_point_begin_.end(), of_point_begin_.begin());
  of_point_.clear();
  for (const auto& list : found) of_point_.insert(of_point_.end(), list.begin(), list.end());
  of_node_begin_.assign(nodes_.size() + 1, 0);
  for (const Coupling& c : of_point_) ++of_node_begin_[c.other + 1];
  std::partial_sum(of_node_begin_.begin(), of_node_begin_.end(), of_node_begin_.begin());
  of_node_.resize(of_point_.size());
  std::vector<std::uint32_t> at(of_node_begin_.begin(), of_node_begin_.end() - 1);
  for (std::uint32_t k = 0; k < points_.size(); ++k)
    for (std::uint32_t c = of_point_begin_[k]; c < of_point_begin_[k + 1]; ++c)
      of_node_[at[of_point_[c].other]++] = {k, of_point_[c].gamma};
}

/// Row sums of |∂ inflow/∂θ|: an upper bound of its eigenvalues.
void Boundary::find_yielding(const Workers& workers) {
  yields_ = std::any_of(nodes_.begin(), nodes_.end(), [](const Node& n) { return n.inverse_mass > 0; });
  yielding_.assign(points_.size(), 0);
  normal_flux_.assign(points_.size(), 0);
  wall_velocity_.resize(nodes_.size());
  if (yields_) {
    std::vector<float> per_node(nodes_.size());
    workers.for_each(nodes_.size(), point_chunk, [&](std::size_t n) {
      float sum = 0;
      for (std::uint32_t c = of_node_begin_[n]; c < of_node_begin_[n + 1]; ++c)
        sum += of_node_[c].gamma.norm();
      per_node[n] = nodes_[n].inverse_mass * static_cast<float>(mass_) * sum;
    });
    workers.for_each(points_.size(), point_chunk, [&](std::size_t k) {
      for (std::uint32_t c = of_point_begin_[k]; c < of_point_begin_[k + 1]; ++c)
        yielding_[k] += of_point_[c].gamma.norm() * per_node[of_point_[c].other];
    });
  }
  // Walls whose nodes are all prescribed move as they are told, whatever pushes them.
  const bool yields = yields_;
  yields_ = true;
  predict_wall_velocity(std::vector<float>(points_.size()), workers);
  yields_ = yields;
}

void Boundary::predict_wall_velocity(const std::vector<float>& theta, const Workers& workers) {
  OILSKIN_ASSERT(theta.size() == points_.size() && wall_velocity_.size() == nodes_.size());
  if (!yields_) return;
  workers.for_each(nodes_.size(), point_chunk, [&](std::size_t n) {
    const Node& node = nodes_[n];
    wall_velocity_[n] = node.velocity;
    if (node.inverse_mass == 0) return;
    // Beyond what the host will carry.
    wall_velocity_[n] -= node.inverse_mass * (node.expected + impulse_on(n, theta));
  });
  workers.for_each(points_.size(), point_chunk, [&](std::size_t k) { normal_flux_[k] = normal_flux_at(k); });
}

/// [N s] if point k presses with theta[k] [m/s].
Eigen::Vector3f Boundary::impulse_on(std::size_t node, const std::vector<float>& theta) const {
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  for (std::uint32_t c = of_node_begin_[node]; c < of_node_begin_[node + 1]; ++c)
    sum += theta[of_node_[c].other] * of_node_[c].gamma;
  return static_cast<float>(mass_) * sum;
}

float Boundary::normal_flux_at(std::size_t point) const {
  float sum = 0;
  for (std::uint32_t c = of_point_begin_[point]; c < of_point_begin_[point + 1]; ++c)
    sum += of_point_[c].gamma.dot(wall_velocity_[of_point_[c].other]);
  return sum;
}

/// Chebyshev's iteration, preconditioned with the row sums, with which the spectrum lies in (0, 1]. The
/// residual of no mode that is in the interval grows beyond the tolerance, and of what lies below it, none is
/// overshot.
void Boundary::solve_yielding(float scale, const std::vector<float>& step, std::vector<float>& change,
                              const Workers& workers) {
  OILSKIN_ASSERT(step.size() == points_.size() && change.size() == points_.size());
  if (!yields_) {
    for (std::size_t k = 0; k < change.size(); ++k) change[k] *= step[k];
    return;
  }
  float stiffest = 1;
  for (std::size_t k = 0; k < step.size(); ++k)
    stiffest = std::max(stiffest, 1 + step[k] * scale * yielding_[k]);
  const double condition = std::min(static_cast<double>(stiffest), max_condition),
               root = std::sqrt(condition);
  const int iterations =
      root > 1
          ? static_cast<int>(std::ceil(std::log(2 / solve_tolerance) / std::log((root + 1) / (root - 1))))
          : 1;
  const double middle = 0.5 * (1 + 1 / condition), half = 0.5 * (1 - 1 / condition);
  solve_step_.resize(step.size());
  solve_residual_.resize(step.size());
  solve_direction_.resize(step.size());
  workers.for_each(step.size(), point_chunk, [&](std::size_t k) {
    solve_step_[k] = step[k] / (1 + step[k] * scale * yielding_[k]);
    solve_residual_[k] = solve_step_[k] * change[k];
    change[k] = solve_direction_[k] = solve_residual_[k] / static_cast<float>(middle);
  });
  double rho = half / middle;
  for (int i = 1; i < iterations; ++i) {
    workers.for_each(nodes_.size(), point_chunk, [&](std::size_t n) {
      wall_velocity_[n] = nodes_[n].inverse_mass * impulse_on(n, solve_direction_);
    });
    const double next = 1 / (2 * middle / half - rho);
    const auto keep = static_cast<float>(next * rho), add = static_cast<float>(2 * next / half);
    rho = next;
    workers.for_each(step.size(), point_chunk, [&](std::size_t k) {
      if (step[k] == 0) return;
      float& d = solve_direction_[k];
      solve_residual_[k] -= solve_step_[k] * (d / step[k] + scale * normal_flux_at(k));
      d = keep * d + add * solve_residual_[k];
      change[k] += d;
    });
  }
}

void Boundary::push(const std::vector<Load<double>>& load, std::vector<Vec3>& dv, const Workers& workers) {
  OILSKIN_ASSERT(load.size() == points_.size() && point_of_.size() == dv.size());
  workers.for_each(points_.size(), point_chunk, [&](std::size_t k) {
    Vec3 sum = Vec3::Zero();
    for (std::uint32_t w = points_[k].begin; w < points_[k].end; ++w)
      sum += load[k].on(walls_[w].depth) * walls_[w].gamma.cast<double>();
    dv[points_[k].particle] += sum;
  });
  workers.for_each(nodes_.size(), point_chunk, [&](std::size_t n) {
    Vec3 impulse = Vec3::Zero();
    for (std::uint32_t c = corners_begin_[n]; c < corners_begin_[n + 1]; ++c) {
      const Wall& wall = walls_[corners_[c].wall];
      impulse -= mass_ * load[wall.point].on(wall.depth) * wall.share(corners_[c].corner) *
                 wall.gamma.cast<double>();
    }
    SurfaceMotion& s = *surfaces_[nodes_[n].surface];
    s.velocity[nodes_[n].node] += s.inverse_mass[nodes_[n].node] * impulse;
    s.impulse[nodes_[n].node] += impulse;
  });
}

void Boundary::record_host_response(double dt, const Vec3& gravity, Span<SurfaceMotion* const> surfaces) {
  for (auto it = memory_.begin(); it != memory_.end();) {
    const bool is_present = std::any_of(surfaces.begin(), surfaces.end(),
                                        [&](const SurfaceMotion* s) { return s->id == it->first; });
    it = is_present ? std::next(it) : memory_.erase(it);
  }
  const double fresh = -std::expm1(-dt / memory_time);
  for (const SurfaceMotion* s : surfaces) {
    const auto found = memory_.find(s->id);
    if (found == memory_.end() || found->second.nodes.size() != s->velocity.size()) continue;
    for (std::size_t i = 0; i < s->velocity.size(); ++i) {
      if (s->inverse_mass[i] == 0) continue;
      NodeMemory& m = found->second.nodes[i];
      const Vec3 force = ((s->velocity[i] - m.velocity_left) / dt - gravity) / s->inverse_mass[i];
      m.answer += fresh * (force - m.answer);
    }
  }
}

void Boundary::record_load(double dt, Span<SurfaceMotion* const> surfaces) {
  const double fresh = -std::expm1(-dt / memory_time);
  for (const SurfaceMotion* s : surfaces) {
    const auto found = memory_.find(s->id);
    if (found == memory_.end() || found->second.nodes.size() != s->velocity.size()) continue;
    for (std::size_t i = 0; i < s->velocity.size(); ++i) {
      NodeMemory& m = found->second.nodes[i];
      m.velocity_left = s->velocity[i];
      m.load += fresh * (s->impulse[i] / dt - m.load);
    }
  }
}

// What follows from the triangles is found again.
void Boundary::visit(Archive& archive) {
  std::vector<std::uint64_t> ids;
  for (const auto& [id, memory] : memory_) ids.push_back(id);
  archive.value(ids);
  for (std::uint64_t id : ids)
    archive.list(memory_[id].nodes, sizeof(NodeMemory),
                 [&](NodeMemory& m) { archive.values(m.velocity_left, m.load, m.answer); });
}

}  // namespace oilskin::fluid
