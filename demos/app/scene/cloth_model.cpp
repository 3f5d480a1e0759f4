#include "scene/cloth_model.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "scene/fields.h"

namespace oilskin::demo {
namespace {

constexpr int corner_nodes = 3;  // per side of a pinned corner: one node alone tears at its links

void build_grid(const Cloth& cloth, ClothModel& model) {
  const int nu = cloth.grid[0], nv = cloth.grid[1];
  const Vec3 n = cloth.normal.normalized();
  const Vec3 u = (cloth.u_axis - n * n.dot(cloth.u_axis)).normalized();
  const Vec3 v = n.cross(u);  // so that triangles face along the normal
  for (int j = 0; j < nv; ++j) {
    for (int i = 0; i < nu; ++i) {
      const double a = 2.0 * i / (nu - 1) - 1, b = 2.0 * j / (nv - 1) - 1;
      const double depth = cloth.bowl_depth * (1 - a * a) * (1 - b * b);
      model.rest.push_back(cloth.center + u * (0.5 * cloth.size[0] * a) + v * (0.5 * cloth.size[1] * b) -
                           n * depth);
    }
  }
  auto node = [nu](int i, int j) { return static_cast<std::uint32_t>(j * nu + i); };
  for (int j = 0; j + 1 < nv; ++j) {
    for (int i = 0; i + 1 < nu; ++i) {
      const std::uint32_t a = node(i, j), b = node(i + 1, j), c = node(i + 1, j + 1), d = node(i, j + 1);
      // Diagonals alternate, so that the sheet shears equally to both sides.
      if ((i + j) % 2 == 0) {
        model.triangles.push_back({a, b, c});
        model.triangles.push_back({a, c, d});
      } else {
        model.triangles.push_back({a, b, d});
        model.triangles.push_back({b, c, d});
      }
    }
  }
}

using Edge = std::array<std::uint32_t, 2>;

Edge edge_of(std::uint32_t a, std::uint32_t b) {
  return a < b ? Edge{a, b} : Edge{b, a};
}

/// Every edge with the corners that face it.
std::map<Edge, std::vector<std::uint32_t>> edges_of(const std::vector<Triangle>& triangles) {
  std::map<Edge, std::vector<std::uint32_t>> edges;
  for (const Triangle& t : triangles)
    for (int k = 0; k < 3; ++k)
      if (t[k] != t[(k + 1) % 3]) edges[edge_of(t[k], t[(k + 1) % 3])].push_back(t[(k + 2) % 3]);
  return edges;
}

/// Shuffled with a fixed seed: a Gauss–Seidel solver that walks links in grid order drags the sheet to one
/// side.
void build_links(const Cloth& cloth, ClothModel& model) {
  for (const auto& [edge, opposite] : edges_of(model.triangles)) {
    model.links.push_back(edge);
    if (cloth.bend_links && opposite.size() == 2 && opposite[0] != opposite[1])
      model.links.push_back(edge_of(opposite[0], opposite[1]));
  }
  std::mt19937 random(20120413);
  for (std::size_t i = model.links.size(); i > 1; --i)
    std::swap(model.links[i - 1], model.links[random() % i]);
}

void build_masses(const Cloth& cloth, ClothModel& model, const std::string& key) {
  model.mass.assign(model.rest.size(), 0);
  for (const Triangle& t : model.triangles) {
    const Vec3 &a = model.rest[t[0]], &b = model.rest[t[1]], &c = model.rest[t[2]];
    const double area = 0.5 * (b - a).cross(c - a).norm();
    for (const std::uint32_t i : t) model.mass[i] += cloth.areal_density * area / 3;
  }
  for (std::size_t i = 0; i < model.mass.size(); ++i)
    if (!(model.mass[i] > 0))
      throw SceneError(key + ".mesh: vertex " + std::to_string(i + 1) +
                       " belongs to no face that has an area");
}

bool in_corner(int i, int n) {
  return i < corner_nodes || i >= n - corner_nodes;
}

void pin_grid(const Cloth& cloth, ClothModel& model) {
  const int nu = cloth.grid[0], nv = cloth.grid[1];
  for (int j = 0; j < nv; ++j) {
    for (int i = 0; i < nu; ++i) {
      const bool corner = in_corner(i, nu) && in_corner(j, nv);
      const bool border = i == 0 || j == 0 || i == nu - 1 || j == nv - 1;
      if (cloth.pins.kind == PinKind::corners ? corner : border) model.pin_group[j * nu + i] = 0;
    }
  }
}

void pin_mesh_border(ClothModel& model) {
  for (const auto& [edge, opposite] : edges_of(model.triangles))
    if (opposite.size() == 1)
      for (const std::uint32_t i : edge) model.pin_group[i] = 0;
}

void pin_boxes(const Cloth& cloth, ClothModel& model, const std::string& key) {
  model.groups = cloth.pins.boxes;
  for (std::size_t g = 0; g < model.groups.size(); ++g) {
    std::size_t held = 0;
    for (std::size_t i = 0; i < model.rest.size(); ++i) {
      if (model.pin_group[i] != not_pinned || !model.groups[g].within.contains(model.rest[i])) continue;
      model.pin_group[i] = static_cast<int>(g);
      ++held;
    }
    if (held == 0)
      throw SceneError(key + ".pins." + std::to_string(g) +
                       ".within: holds no node that an earlier box has not");
  }
}

void build_pins(const Cloth& cloth, ClothModel& model, const std::string& key) {
  model.pin_group.assign(model.rest.size(), not_pinned);
  model.groups.assign(1, PinBox());
  switch (cloth.pins.kind) {
    case PinKind::none:
      break;
    case PinKind::corners:
      pin_grid(cloth, model);
      break;
    case PinKind::border:
      cloth.mesh ? pin_mesh_border(model) : pin_grid(cloth, model);
      break;
    case PinKind::nodes:
      for (const int node : cloth.pins.nodes) model.pin_group[node] = 0;
      break;
    case PinKind::boxes:
      pin_boxes(cloth, model, key);
      break;
  }
}

}  // namespace

bool ClothModel::pinned_at_start(std::size_t node) const {
  return pin_group[node] != not_pinned && groups[static_cast<std::size_t>(pin_group[node])].hold == 0;
}

double ClothModel::total_mass() const {
  double sum = 0;
  for (const double m : mass) sum += m;
  return sum;
}

ClothModel build_cloth(const Cloth& cloth, const std::string& key) {
  ClothModel model;
  if (cloth.mesh) {
    model.rest = cloth.mesh->mesh.vertices;
    model.triangles = cloth.mesh->mesh.triangles;
  } else {
    build_grid(cloth, model);
  }
  build_masses(cloth, model, key);
  build_links(cloth, model);
  build_pins(cloth, model, key);
  model.anchor = model.rest;
  return model;
}

double motion_time(const Motion& motion, double t) {
  return std::max(0.0, std::min(t, motion.stop) - motion.start);
}

Eigen::AngleAxisd turned(const Motion& motion, double t) {
  return Eigen::AngleAxisd(motion.spin_rate * motion_time(motion, t), motion.spin_axis.normalized());
}

Vec3 moved(const Motion& motion, const Vec3& rest, double t) {
  const double seconds = motion_time(motion, t);
  if (seconds == 0 || !motion.moves()) return rest;
  return motion.spin_center + turned(motion, t) * (rest - motion.spin_center) + motion.velocity * seconds;
}

Vec3 velocity_at(const Motion& motion, const Vec3& rest, double t) {
  if (!motion.moves() || t < motion.start || t >= motion.stop) return Vec3::Zero();
  const Vec3 arm = turned(motion, t) * (rest - motion.spin_center);
  return motion.velocity + motion.spin_axis.normalized().cross(arm) * motion.spin_rate;
}

}  // namespace oilskin::demo
