#include "hosts/mock_cloth.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "scene/tank.h"

namespace oilskin::demo {

MockCloth::MockCloth(const Cloth& settings, ClothModel model)
    : model_(std::move(model)),
      substeps_(settings.substeps),
      iterations_(settings.iterations),
      x_(model_.rest) {
  v_.assign(x_.size(), Vec3::Zero());
  held_.assign(model_.groups.size(), false);
  released_.assign(model_.groups.size(), false);
  for (std::size_t i = 0; i < x_.size(); ++i)
    inverse_mass_.push_back(model_.pinned_at_start(i) ? 0 : 1 / model_.mass[i]);
  for (const auto& link : model_.links) rest_length_.push_back((x_[link[1]] - x_[link[0]]).norm());
}

void MockCloth::prescribe(double t) {
  for (std::size_t g = 0; g < model_.groups.size(); ++g) {
    const PinBox& group = model_.groups[g];
    if (released_[g] || t < group.hold) continue;
    const bool holds = group.hold > 0 && !held_[g];
    held_[g] = true;
    released_[g] = t > group.release;
    for (std::size_t i = 0; i < x_.size(); ++i) {
      if (model_.pin_group[i] != static_cast<int>(g)) continue;
      if (holds) model_.anchor[i] = x_[i];
      if (holds) inverse_mass_[i] = 0;
      if (released_[g]) inverse_mass_[i] = 1 / wet_mass(i);
      v_[i] = velocity_at(group.motion, model_.anchor[i], released_[g] ? group.release : t);
      if (!released_[g]) x_[i] = moved(group.motion, model_.anchor[i], t);
    }
  }
}

void MockCloth::project_links() {
  for (std::size_t l = 0; l < model_.links.size(); ++l) {
    const auto [i, j] = model_.links[l];
    const double w = inverse_mass_[i] + inverse_mass_[j];
    const Vec3 along = x_[j] - x_[i];
    const double length = along.norm();
    if (w == 0 || length == 0) continue;
    const Vec3 correction = along * ((length - rest_length_[l]) / (length * w));
    x_[i] += inverse_mass_[i] * correction;
    x_[j] -= inverse_mass_[j] * correction;
  }
}

std::vector<bool> MockCloth::follows() const {
  std::vector<bool> follows;
  for (const int g : model_.pin_group)
    follows.push_back(g != not_pinned && model_.groups[std::size_t(g)].motion.moves());
  return follows;
}

void MockCloth::hold(const Grip& grip) {
  for (std::size_t n = 0; n < grip.nodes.size(); ++n) {
    const std::size_t k = grip.nodes[n];
    inverse_mass_[k] = 0;
    x_[k] = grip.place + grip.offsets[n];
    v_[k] = grip.velocity;
  }
}

void MockCloth::let_go(const Grip& grip) {
  for (const std::size_t k : grip.nodes) {
    const int g = model_.pin_group[k];
    const bool is_pin =
        g != not_pinned && !released_[std::size_t(g)] && (held_[std::size_t(g)] || model_.pinned_at_start(k));
    if (is_pin) {
      model_.anchor[k] = x_[k];
      v_[k] = Vec3::Zero();
    } else {
      inverse_mass_[k] = 1 / wet_mass(k);
    }
  }
}

void MockCloth::advance(double t, double dt, const Vec3& gravity, Grip* grip) {
  const double sub_dt = dt / substeps_;
  for (int s = 0; s < substeps_; ++s) {
    const std::vector<Vec3> before = x_;
    prescribe(t + sub_dt * (s + 1));
    if (grip != nullptr) {
      grip->advance(sub_dt);
      hold(*grip);
    }
    for (std::size_t i = 0; i < x_.size(); ++i)
      if (inverse_mass_[i] > 0) x_[i] += (v_[i] + gravity * sub_dt) * sub_dt;
    for (int k = 0; k < iterations_; ++k) project_links();
    for (std::size_t i = 0; i < x_.size(); ++i)
      if (inverse_mass_[i] > 0) v_[i] = (x_[i] - before[i]) / sub_dt;
  }
}

Gathered MockCloth::gather(double, SurfaceMotion& motion) {
  Gathered result;
  result.new_surface = fresh_;
  fresh_ = false;
  if (result.new_surface) {
    motion.triangles = model_.triangles;
    motion.storage = Storage::float64;
    motion.nodes_movable = false;  // velocities come from positions here too
  }
  motion.x_t1 = x_;
  motion.velocity = v_;
  motion.inverse_mass = inverse_mass_;
  motion.holdable.assign(x_.size(), 1);
  add_carried_mass(motion);
  return result;
}

/// Links are satisfied whatever the masses are. What the links pass on needs a support.
void MockCloth::add_carried_mass(SurfaceMotion& motion) const {
  motion.added_mass.clear();
  const bool is_supported = std::find(inverse_mass_.begin(), inverse_mass_.end(), 0) != inverse_mass_.end();
  if (!is_supported || motion.carried_mass.size() != x_.size()) return;
  motion.added_mass.assign(x_.size(), 0);
  for (std::size_t i = 0; i < x_.size(); ++i) {
    if (inverse_mass_[i] == 0 || motion.carried_mass[i] == 0) continue;
    motion.added_mass[i] = motion.carried_mass[i];
    motion.inverse_mass[i] = 1 / (1 / inverse_mass_[i] + motion.carried_mass[i]);
  }
}

void MockCloth::scatter(SurfaceMotion& motion) {
  for (std::size_t i = 0; i < x_.size(); ++i) {
    v_[i] += motion.inverse_mass[i] * motion.impulse[i];
    if (motion.moved[i]) x_[i] = motion.x_t1[i];
  }
  motion.x_t1 = x_;
  if (motion.absorbed_mass.size() != x_.size()) return;
  absorbed_ = motion.absorbed_mass;
  for (std::size_t i = 0; i < x_.size(); ++i)
    if (inverse_mass_[i] > 0) inverse_mass_[i] = 1 / wet_mass(i);
}

namespace {

Mesh box_mesh(const BoxShape& box) {
  const Eigen::Quaterniond turn(box.rotate[3], box.rotate[0], box.rotate[1], box.rotate[2]);
  Mesh mesh;
  for (int c = 0; c < 8; ++c) {
    const Vec3 sign((c & 1) ? 1 : -1, (c & 2) ? 1 : -1, (c & 4) ? 1 : -1);
    mesh.vertices.push_back(box.center + turn * Vec3(sign.cwiseProduct(box.half_extents)));
  }
  const std::uint32_t quads[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                     {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  for (const auto& q : quads) {
    mesh.triangles.push_back({q[0], q[1], q[2]});
    mesh.triangles.push_back({q[0], q[2], q[3]});
  }
  return mesh;
}

Mesh sphere_mesh(const SphereShape& sphere) {
  constexpr std::uint32_t rings = 24, segments = 48;
  constexpr double pi = 3.14159265358979323846;
  Mesh mesh;
  for (std::uint32_t r = 0; r <= rings; ++r) {
    for (std::uint32_t s = 0; s < segments; ++s) {
      const double a = pi * r / rings, b = 2 * pi * s / segments;
      mesh.vertices.push_back(sphere.center + sphere.radius * Vec3(std::sin(a) * std::cos(b), std::cos(a),
                                                                   std::sin(a) * std::sin(b)));
    }
  }
  for (std::uint32_t r = 0; r < rings; ++r) {
    for (std::uint32_t s = 0; s < segments; ++s) {
      const std::uint32_t a = r * segments + s, b = r * segments + (s + 1) % segments;
      mesh.triangles.push_back({a, b, b + segments});
      mesh.triangles.push_back({a, b + segments, a + segments});
    }
  }
  return mesh;
}

Mesh plane_mesh(const PlaneShape& plane, const Box& kill_box) {
  const Vec3 n = plane.normal.normalized();
  const Vec3 u = n.unitOrthogonal(), v = n.cross(u);
  const double reach = (kill_box.max - kill_box.min).norm();
  Mesh mesh;
  mesh.vertices = {plane.point - reach * (u + v), plane.point + reach * (u - v),
                   plane.point + reach * (u + v), plane.point - reach * (u - v)};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

}  // namespace

namespace {

bool is_solid(const Body& body) {
  return std::holds_alternative<BoxShape>(body.shape) || std::holds_alternative<SphereShape>(body.shape) ||
         std::holds_alternative<CompoundShape>(body.shape);
}

void append(const Mesh& mesh, Mesh& to) {
  const auto first = static_cast<std::uint32_t>(to.vertices.size());
  to.vertices.insert(to.vertices.end(), mesh.vertices.begin(), mesh.vertices.end());
  for (const Triangle& t : mesh.triangles) to.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

}  // namespace

Mesh tessellate(const Body& body, const Box& kill_box) {
  if (const auto* box = std::get_if<BoxShape>(&body.shape)) return box_mesh(*box);
  if (const auto* sphere = std::get_if<SphereShape>(&body.shape)) return sphere_mesh(*sphere);
  if (const auto* plane = std::get_if<PlaneShape>(&body.shape)) return plane_mesh(*plane, kill_box);
  if (const auto* tank = std::get_if<TankShape>(&body.shape)) return tank_mesh(*tank);
  if (const auto* compound = std::get_if<CompoundShape>(&body.shape)) {
    Mesh all;
    for (const BoxShape& box : compound->boxes) append(box_mesh(box), all);
    return all;
  }
  return std::get<PlacedMesh>(body.shape).mesh;
}

MockBody::MockBody(const Body& body, const Box& kill_box)
    : mesh_(tessellate(body, kill_box)),
      solid_(is_solid(body)),
      prescribed_(body.motion),
      x_(mesh_.vertices) {
  v_.assign(x_.size(), Vec3::Zero());
}

void MockBody::displace(const Vec3& velocity, double dt) {
  displaced_ += velocity * dt;
  pull_ = velocity;
}

void MockBody::advance(double t) {
  const bool is_pulled = !pull_.isZero(0);
  if (!prescribed_.moves() && !is_pulled && !was_pulled_) return;
  for (std::size_t i = 0; i < x_.size(); ++i) {
    x_[i] = moved(prescribed_, mesh_.vertices[i], t) + displaced_;
    v_[i] = velocity_at(prescribed_, mesh_.vertices[i], t) + pull_;
  }
  ++revision_;
  was_pulled_ = is_pulled;
  pull_.setZero();
}

Gathered MockBody::gather(double, SurfaceMotion& motion) {
  Gathered result;
  if (motion.revision == revision_ && !fresh_) {
    result.unchanged = true;
    return result;
  }
  motion.revision = prescribed_.moves() ? 0 : revision_;
  result.new_surface = fresh_;
  fresh_ = false;
  if (result.new_surface) {
    motion.triangles = mesh_.triangles;
    motion.storage = Storage::float64;
    motion.solid = solid_;
  }
  motion.x_t1 = x_;
  motion.velocity = v_;
  motion.inverse_mass.assign(x_.size(), 0);
  motion.holdable.assign(x_.size(), 0);
  return result;
}

void MockBody::scatter(SurfaceMotion& motion) {
  if (motion.still == 0) motion.x_t1 = x_;
}

}  // namespace oilskin::demo
