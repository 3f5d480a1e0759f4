#include "fuzz/random_sheet.h"

#include <algorithm>

namespace oilskin::test {

const char* name_of(MeshKind kind) {
  switch (kind) {
    case MeshKind::grid:
      return "grid";
    case MeshKind::layers:
      return "layers";
    case MeshKind::folds:
      return "folds";
    case MeshKind::crumpled:
      return "crumpled";
    case MeshKind::bag:
      return "bag";
  }
  return "";
}

const char* name_of(SheetMotion motion) {
  switch (motion) {
    case SheetMotion::still:
      return "still";
    case SheetMotion::shaken:
      return "shaken";
    case SheetMotion::carried:
      return "carried";
    case SheetMotion::closing:
      return "closing";
    case SheetMotion::turning:
      return "turning";
    case SheetMotion::free_flight:
      return "free flight";
  }
  return "";
}

RandomSheet::RandomSheet(const SheetPlan& plan, const Vec3& at, Random& random) : plan_(plan) {
  make_mesh(random, at);
  for (Vec3& x : x_) x = stored(x, plan_.storage);
  v_.assign(x_.size(), Vec3::Zero());
  target_ = x_;
  make_masses(random);
}

void RandomSheet::add_grid(std::uint32_t nu, std::uint32_t nv, const Vec3& corner, const Vec3& u,
                           const Vec3& v) {
  const auto first = static_cast<std::uint32_t>(x_.size());
  for (std::uint32_t j = 0; j <= nv; ++j)
    for (std::uint32_t i = 0; i <= nu; ++i) x_.push_back(corner + i * u + j * v);
  for (std::uint32_t j = 0; j < nv; ++j)
    for (std::uint32_t i = 0; i < nu; ++i) {
      const std::uint32_t a = first + i + (nu + 1) * j, b = a + 1, c = a + nu + 1, d = c + 1;
      triangles_.push_back({a, b, d});
      triangles_.push_back({a, d, c});
    }
}

void RandomSheet::make_mesh(Random& random, const Vec3& at) {
  const Vec3 u = random.direction() * plan_.edge;
  const Vec3 v = u.cross(random.direction()).normalized() * plan_.edge, w = u.cross(v) / plan_.edge;
  const std::uint32_t nu = 1 + random.below(6), nv = 1 + random.below(6);
  switch (plan_.mesh) {
    case MeshKind::grid:
      add_grid(nu, nv, Vec3::Zero(), u, v);
      break;
    case MeshKind::layers: {
      const double gap = random.log_uniform(0.001, 0.5);
      for (std::uint32_t layer = 0; layer < 2 + random.below(9); ++layer)
        add_grid(1 + nu / 2, 1 + nv / 2, layer * gap * w, u, v);
      break;
    }
    case MeshKind::folds:
      add_grid(4 + nu, nv, Vec3::Zero(), u, v);
      make_folds(random, u, w);
      break;
    case MeshKind::crumpled:
      add_grid(2 + nu, 2 + nv, Vec3::Zero(), u, v);
      crumple(random);
      spoil_triangles(random);
      break;
    case MeshKind::bag: {
      const std::uint32_t n = 1 + nu / 2;
      for (int side = 0; side < 2; ++side) {
        add_grid(n, n, side * n * w, u, v);
        add_grid(n, n, side * n * v, u, w);
        add_grid(n, n, side * n * u, v, w);
      }
      break;
    }
  }
  Vec3 middle = Vec3::Zero();
  for (const Vec3& x : x_) middle += x / static_cast<double>(x_.size());
  for (Vec3& x : x_) x += at - middle;
}

/// Lays the sheet in folds: steps along u turn forth and back.
void RandomSheet::make_folds(Random& random, const Vec3& u, const Vec3& w) {
  const double turned = random.uniform(0.05, 0.5);
  for (Vec3& x : x_) {
    const double along = x.dot(u) / u.squaredNorm();
    const double folded = std::abs(std::remainder(along, 2.0));
    x += (turned * folded - along) * u + folded * w + 0.02 * along * (u + w);
  }
}

void RandomSheet::crumple(Random& random) {
  const double size = plan_.edge * random.log_uniform(0.1, 3);
  for (Vec3& x : x_) x = random.uniform() < 0.3 ? Vec3(random.in_cube(size)) : Vec3(x + random.in_cube(size));
}

/// Points that coincide, three in a line, triangles twice, triangles with one corner twice.
void RandomSheet::spoil_triangles(Random& random) {
  const auto nodes = static_cast<std::uint32_t>(x_.size());
  for (std::uint32_t k = 0; k < 1 + nodes / 8; ++k) x_[random.below(nodes)] = x_[random.below(nodes)];
  for (std::uint32_t k = 0; k < 1 + nodes / 8; ++k) {
    const Triangle t = triangles_[random.below(static_cast<std::uint32_t>(triangles_.size()))];
    if (random.uniform() < 0.3) triangles_.push_back({t[0], t[2], t[1]});
    if (random.uniform() < 0.3) triangles_.push_back({t[0], t[0], t[1]});
    if (random.uniform() < 0.1) triangles_.push_back({t[2], t[2], t[2]});
    if (random.uniform() < 0.3) x_[t[1]] = x_[t[0]] + random.uniform() * (x_[t[2]] - x_[t[0]]);
  }
}

void RandomSheet::make_masses(Random& random) {
  for (std::size_t i = 0; i < x_.size(); ++i)
    inverse_mass_.push_back(
        random.uniform() < plan_.pins ? 0 : 1 / random.log_uniform(plan_.lightest, plan_.heaviest));
}

Vec3 RandomSheet::displacement_of(std::size_t node, Random& random, double size) const {
  const bool pinned = inverse_mass_[node] == 0;
  if (pinned && plan_.pins_agree) return plan_.motion == SheetMotion::still ? Vec3(Vec3::Zero()) : drift_;
  switch (plan_.motion) {
    case SheetMotion::still:
      return Vec3::Zero();
    case SheetMotion::shaken:
      return random.uniform() < 0.2 ? Vec3(Vec3::Zero()) : random.in_cube(size);
    case SheetMotion::carried:
      return drift_;
    case SheetMotion::closing:
      return squeeze_ * (center_ - x_[node]);
    case SheetMotion::turning:
      return turn_ * (x_[node] - center_) + center_ - x_[node];
    case SheetMotion::free_flight:
      return Vec3::Zero();
  }
  return Vec3::Zero();
}

void RandomSheet::propose(Random& random, const Arena& arena, const Vec3& gravity, double dt) {
  const double size = plan_.edge * plan_.displacement * random.log_uniform(0.1, 1);
  const bool rests = random.uniform() < 0.15;
  drift_ = random.in_cube(size);
  squeeze_ = std::min(2.0, 0.2 * plan_.displacement) * random.uniform();
  turn_ =
      Eigen::AngleAxisd(0.2 * plan_.displacement * random.uniform(), random.direction()).toRotationMatrix();
  center_.setZero();
  for (const Vec3& x : x_) center_ += x / static_cast<double>(x_.size());
  for (std::size_t i = 0; i < x_.size(); ++i) {
    Vec3 displacement = rests ? Vec3(Vec3::Zero()) : displacement_of(i, random, size);
    if (plan_.motion == SheetMotion::free_flight && inverse_mass_[i] > 0) {
      v_[i] += dt * gravity;
      displacement = dt * v_[i];
    }
    const Vec3 wanted = stored(x_[i] + displacement, plan_.storage);
    const bool inside = ((wanted - arena.center).cwiseAbs().array() < arena.half).all();
    target_[i] = inside ? wanted : x_[i];
    if (plan_.motion != SheetMotion::free_flight || inverse_mass_[i] == 0 || !inside)
      v_[i] = (target_[i] - x_[i]) / dt;
  }
}

void RandomSheet::jump(Random& random, const Arena& arena) {
  const Vec3 by = random.in_cube(0.2 * arena.half);
  for (Vec3& x : x_)
    x = stored((x + by - arena.center).cwiseMax(-arena.half).cwiseMin(arena.half) + arena.center,
               plan_.storage);
  target_ = x_;
}

void RandomSheet::change_a_pin(Random& random) {
  double& u = inverse_mass_[random.below(static_cast<std::uint32_t>(x_.size()))];
  u = u == 0 ? 1 / random.log_uniform(plan_.lightest, plan_.heaviest) : 0;
}

double RandomSheet::reach() const {
  double largest = 0;
  for (std::size_t i = 0; i < target_.size(); ++i)
    if (inverse_mass_[i] > 0) largest = std::max(largest, target_[i].cwiseAbs().maxCoeff());
  return largest;
}

Gathered RandomSheet::gather(double dt, SurfaceMotion& motion) {
  const bool is_new = motion.triangles.empty();
  if (is_new) motion.triangles = triangles_;
  motion.storage = plan_.storage;
  motion.nodes_movable = plan_.movable;
  if (dt > 0) x_ = target_;
  motion.x_t1 = x_;
  motion.velocity = v_;
  motion.inverse_mass = inverse_mass_;
  motion.holdable.assign(x_.size(), plan_.holdable ? 1 : 0);
  if (spoilt_) motion.x_t1[0].y() = std::nan("");
  return {Status{}, is_new};
}

void RandomSheet::scatter(SurfaceMotion& motion) {
  for (std::size_t i = 0; i < x_.size(); ++i) {
    v_[i] += motion.inverse_mass[i] * motion.impulse[i];
    if (motion.moved[i]) x_[i] = motion.x_t1[i];
    motion.x_t1[i] = target_[i] = x_[i];
  }
}

}  // namespace oilskin::test
