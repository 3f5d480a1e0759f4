#include "world/gap_pressure.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/assert.h"
#include "core/body_motion.h"

namespace oilskin::world {

namespace {

/// Lengths in spacings. Beyond `narrow` a gap fades, and beyond `wide` there is none: particles are in it.
constexpr double narrow = 0.5, wide = 0.75;
/// Cosines of the angle between the two sides: particles get into what is open by more than a wedge.
constexpr double slot = 0.98, wedge = 0.95;
/// What particles give a body counts within this distance: those beside a gap give more than their part.
constexpr double given_reach = 3;
/// Particles this near to a point beside a gap have the pressure that enters it, so many at most.
constexpr double rim_reach = 1.5;
constexpr std::size_t rim_particles = 3;
/// How far a solid may have sunk into what it stands on, and what else may have.
constexpr double sunk = 0.5, rounding = 0.05;
/// Consecutive samples of a triangle of which particles give alike.
constexpr std::size_t alike = 4;
/// Points on an edge of a triangle, at most.
constexpr int most_parts = 16;

constexpr double no_water = -1;  // for a pressure [Pa]

constexpr std::size_t box_size = 64;  // particles of a box

bool is_rigid(const SurfaceMotion& s) {
  return s.still != 0 || s.body ||
         std::none_of(s.inverse_mass.begin(), s.inverse_mass.end(), [](double m) { return m > 0; });
}

std::array<Vec3, 3> corners_of(const SurfaceMotion& s, std::uint32_t t) {
  const Triangle& nodes = s.triangles[t];
  return {s.x_t0[nodes[0]], s.x_t0[nodes[1]], s.x_t0[nodes[2]]};
}

/// 1 where the normals of a closed surface point outwards, −1 where inwards.
double orientation_of(const SurfaceMotion& s) {
  const Vec3 origin = s.x_t0.empty() ? Vec3(Vec3::Zero()) : s.x_t0[0];
  double volume = 0;
  for (const Triangle& t : s.triangles)
    volume += (s.x_t0[t[0]] - origin).dot((s.x_t0[t[1]] - origin).cross(s.x_t0[t[2]] - origin));
  return volume < 0 ? -1 : 1;
}

/// Of a surface.
struct Kind {
  bool is_rigid = false;
  double orientation = 0;  // of a solid

  explicit Kind(const SurfaceMotion& s) : is_rigid(oilskin::world::is_rigid(s)) {
    constexpr std::size_t most_triangles = 4096;  // of a level without a motion
    if (s.solid && (s.body || s.triangles.size() <= most_triangles)) orientation = orientation_of(s);
  }
};

/// A point of a triangle.
struct PointOf {
  std::uint32_t surface = 0, triangle = 0;
  std::array<double, 3> weights{};
};

/// Where a line from `x` along the unit vector `n` crosses the triangle, between `from` and `to` [m].
std::optional<double> crossing(const Vec3& x, const Vec3& n, const std::array<Vec3, 3>& c, double from,
                               double to, std::array<double, 3>& weights) {
  const Vec3 u = c[1] - c[0], v = c[2] - c[0], normal = u.cross(v), r = x - c[0];
  const double across = normal.dot(n);
  if (across == 0) return std::nullopt;
  const double at = -normal.dot(r) / across;
  if (!(at >= from && at <= to)) return std::nullopt;
  const Vec3 turned = r.cross(n);
  weights[1] = -v.dot(turned) / across;
  weights[2] = u.dot(turned) / across;
  weights[0] = 1 - weights[1] - weights[2];
  if (!(std::min({weights[0], weights[1], weights[2]}) >= 0)) return std::nullopt;
  return at;
}

/// A part of a body's hull.
struct Sample {
  PointOf at;
  Vec3 x = Vec3::Zero(), normal = Vec3::Zero();  // outwards
  double area = 0, size = 0;                     // [m²], its root
  double share = 0;                              // of the pressure in the gap in front; 0 = it is open
  double pressure = 0;                           // that particles do not give [Pa]
  PointOf opposite;
  bool given_by_other = false;  // the body in front of it sees to it
  bool is_blocked = false;      // there is a surface in front
};

/// What a gap does: an impulse at one end, and its opposite at the other.
struct Push {
  PointOf at, opposite;
  Vec3 impulse;
  double pressure = 0;  // [Pa]
};

/// Particles in boxes of consecutive ones, to find those in a box.
class WaterBoxes {
 public:
  WaterBoxes(const GapWater& water, const Workers& workers) : water_(water) {
    boxes_.resize((water.position.size() + box_size - 1) / box_size);
    workers.for_chunks(water.position.size(), box_size,
                       [&](std::size_t begin, std::size_t end, std::size_t b) {
                         for (std::size_t i = begin; i < end; ++i) boxes_[b].add(water.position[i]);
                       });
  }
  /// May there be particles in the box?
  bool may_reach(const Box& box) const {
    return std::any_of(boxes_.begin(), boxes_.end(), [&](const Box& b) { return b.overlaps(box); });
  }
  /// Appends the particles in the box, ascending.
  void find(const Box& box, std::vector<std::uint32_t>& found) const {
    for (std::size_t b = 0; b < boxes_.size(); ++b) {
      if (!boxes_[b].overlaps(box)) continue;
      for (std::size_t i = b * box_size; i < std::min(water_.position.size(), (b + 1) * box_size); ++i)
        if (box.contains(water_.position[i])) found.push_back(static_cast<std::uint32_t>(i));
    }
  }

 private:
  const GapWater& water_;
  std::vector<Box> boxes_;
};

/// The impulses that particles gave, by surface.
class GivenBySurface {
 public:
  GivenBySurface(Span<const fluid::WallImpulse> given, std::size_t surfaces) : begin_(surfaces + 1, 0) {
    for (const fluid::WallImpulse& g : given) ++begin_[g.surface + 1];
    for (std::size_t s = 0; s < surfaces; ++s) begin_[s + 1] += begin_[s];
    std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
    index_.resize(given.size());
    for (std::uint32_t k = 0; k < given.size(); ++k) index_[next[given[k].surface]++] = k;
  }
  Span<const std::uint32_t> of(std::uint32_t surface) const {
    return {index_.data() + begin_[surface], begin_[surface + 1] - begin_[surface]};
  }

 private:
  std::vector<std::uint32_t> begin_, index_;
};

/// The gaps of one body.
class BodyGaps {
 public:
  BodyGaps(const GapWater& water, Span<SurfaceMotion* const> surfaces,
           Span<contact::SurfaceGeometry* const> geometry, const std::vector<Kind>& kinds, std::uint32_t body)
      : water_(water),
        surfaces_(surfaces),
        geometry_(geometry),
        kinds_(kinds),
        own_(body),
        dx_(water.spacing) {
    const Box reach = geometry[body]->tree.bounds().inflated(wide * dx_);
    for (std::uint32_t s = 0; s < surfaces.size(); ++s)
      if (s != body && kinds[s].is_rigid && geometry[s]->tree.bounds().overlaps(reach)) others_.push_back(s);
  }

  bool empty() const { return others_.empty(); }

  void find(const WaterBoxes& boxes, const GivenBySurface& given, double dt, std::vector<Push>& pushes) {
    const double reach = (rim_reach + 1.5) * dx_;
    if (!boxes.may_reach(geometry_[own_]->tree.bounds().inflated(reach))) return;
    sample_covered();
    Box covered;
    for (const Sample& s : covered_) covered.add(s.x);
    if (covered_.empty()) return;
    boxes.find(covered.inflated(reach), near_);
    if (near_.empty()) return;
    sample_rim(covered);
    find_given(given);
    fill(dt);
    for (const Sample& s : covered_)
      if (s.pressure > 0 && !s.given_by_other) push(s, dt, pushes);
  }

 private:
  const SurfaceMotion& own() const { return *surfaces_[own_]; }

  template <class F>
  void for_samples(std::uint32_t t, const F& f) const {
    const std::array<Vec3, 3> c = corners_of(own(), t);
    const Vec3 cross = (c[1] - c[0]).cross(c[2] - c[0]);
    const double twice_area = cross.norm();
    if (!(twice_area > 0)) return;
    const double longest = std::sqrt(
        std::max({(c[1] - c[0]).squaredNorm(), (c[2] - c[1]).squaredNorm(), (c[0] - c[2]).squaredNorm()}));
    const int parts = static_cast<int>(std::clamp(std::ceil(longest / (1.4 * dx_)), 1.0, double(most_parts)));
    Sample s;
    s.at.surface = own_;
    s.at.triangle = t;
    s.normal = kinds_[own_].orientation / twice_area * cross;
    s.area = 0.5 * twice_area / (parts * parts);
    s.size = std::sqrt(2 * s.area);
    for (int i = 0; i < parts; ++i)
      for (int j = 0; i + j < parts; ++j)
        for (const int half : {1, 2}) {
          if (half == 2 && i + j + 1 == parts) continue;
          const double u = (i + half / 3.0) / parts, v = (j + half / 3.0) / parts;
          s.at.weights = {1 - u - v, u, v};
          s.x = s.at.weights[0] * c[0] + u * c[1] + v * c[2];
          f(s);
        }
  }

  /// Samples of triangles that something is in front of.
  void sample_covered() {
    std::vector<std::uint32_t> candidates;
    triangles_.assign(own().triangles.size(), 0);
    for (std::uint32_t t = 0; t < own().triangles.size(); ++t) {
      Box box;
      for (const Vec3& x : corners_of(own(), t)) box.add(x);
      const Box reach = box.inflated(wide * dx_);
      bool is_near = false;
      for (const std::uint32_t o : others_) is_near |= geometry_[o]->tree.overlaps(reach);
      if (!is_near) continue;
      triangles_[t] = 1;
      for_samples(t, [&](Sample s) {
        const double gap = cover(s, candidates);
        s.is_blocked = gap < wide * dx_;
        if (!(s.share > 0))
          open_.push_back(s);
        else if (!is_inside(s, gap))
          covered_.push_back(s);
      });
    }
  }

  /// Finds the nearest surface in front; returns the width of the gap [m].
  double cover(Sample& s, std::vector<std::uint32_t>& candidates) const {
    Box line;
    line.add(s.x - sunk * dx_ * s.normal);
    line.add(s.x + wide * dx_ * s.normal);
    double nearest = std::numeric_limits<double>::infinity(), gap = nearest;
    for (const std::uint32_t o : others_) {
      candidates.clear();
      geometry_[o]->tree.query(line, candidates);
      if (candidates.empty()) continue;
      const SurfaceMotion& other = *surfaces_[o];
      for (const std::uint32_t t : candidates) {
        std::array<double, 3> weights{};
        const std::array<Vec3, 3> c = corners_of(other, t);
        const Vec3 cross = (c[1] - c[0]).cross(c[2] - c[0]);
        const double along = cross.dot(s.normal);
        const bool faces = kinds_[o].orientation * along < 0;
        const auto at = crossing(s.x, s.normal, c, -(faces ? sunk : rounding) * dx_, wide * dx_, weights);
        if (!at || !(std::abs(*at) < nearest)) continue;
        nearest = std::abs(*at);
        const double parallel = std::abs(along) / cross.norm();
        s.share = std::clamp((wide - *at / dx_) / (wide - narrow), 0.0, 1.0) *
                  std::clamp((parallel - wedge) / (slot - wedge), 0.0, 1.0);
        s.opposite = {o, t, weights};
        s.given_by_other = other.body && other.solid && o < own_;
        gap = *at;
      }
    }
    return gap;
  }

  /// Points of the hull beside the gaps.
  void sample_rim(const Box& covered) {
    const Box reach = covered.inflated(given_reach * dx_);
    for (std::uint32_t t = 0; t < own().triangles.size(); ++t) {
      if (triangles_[t]) continue;
      Box box;
      for (const Vec3& x : corners_of(own(), t)) box.add(x);
      if (box.overlaps(reach)) for_samples(t, [&](const Sample& s) { open_.push_back(s); });
    }
    for (const Sample& r : open_)
      if (is_beside_gap(r) && !is_inside(r, 0.5 * dx_)) {
        const double p = pressure_at(r);
        if (p != no_water || !r.is_blocked) rim_.push_back({r.x, p});
      }
  }

  /// Not what is on the other side of a plate.
  bool is_beside_gap(const Sample& r) const {
    return std::any_of(covered_.begin(), covered_.end(), [&](const Sample& s) {
      const double reach = 1.5 * std::max(s.size, r.size);
      const Vec3 to = r.x - s.x;
      return s.share > 0 && to.squaredNorm() < reach * reach && to.dot(s.normal) > -0.75 * r.size &&
             r.normal.dot(s.normal) > -0.5;
    });
  }

  /// Is there another part of a body that is made of parts within `to` in front?
  bool is_inside(const Sample& r, double to) const {
    const double from = -rounding * dx_;
    Box line;
    line.add(r.x + from * r.normal);
    line.add(r.x + to * r.normal);
    std::vector<std::uint32_t> candidates;
    geometry_[own_]->tree.query(line, candidates);
    std::array<double, 3> weights{};
    return std::any_of(candidates.begin(), candidates.end(), [&](std::uint32_t t) {
      return t != r.at.triangle && crossing(r.x, r.normal, corners_of(own(), t), from, to, weights);
    });
  }

  /// Is there nothing between a point of a surface and a particle?
  bool sees(const Vec3& x, const Vec3& particle) const {
    Box line;
    line.add(x);
    line.add(particle);
    const Vec3 way = particle - x;
    const double length = way.norm();
    std::vector<std::uint32_t> candidates;
    const auto is_blocked = [&](std::uint32_t surface) {
      if (!geometry_[surface]->tree.bounds().overlaps(line)) return false;
      candidates.clear();
      geometry_[surface]->tree.query(line, candidates);
      std::array<double, 3> weights{};
      return std::any_of(candidates.begin(), candidates.end(), [&](std::uint32_t t) {
        return crossing(x, way / length, corners_of(*surfaces_[surface], t), 0.5 * rounding * dx_, length,
                        weights);
      });
    };
    return !is_blocked(own_) && std::none_of(others_.begin(), others_.end(), is_blocked);
  }

  /// That of the nearest water in front, down or up to the point [Pa].
  double pressure_at(const Sample& r) const {
    struct Near {
      double squared;
      std::uint32_t particle;
      bool operator<(const Near& o) const {
        return squared != o.squared ? squared < o.squared : particle < o.particle;
      }
    };
    std::vector<Near> near;
    for (const std::uint32_t i : near_) {
      const Vec3 to = water_.position[i] - r.x;
      if (to.squaredNorm() < rim_reach * rim_reach * dx_ * dx_ && to.dot(r.normal) > 0)
        near.push_back({to.squaredNorm(), i});
    }
    std::sort(near.begin(), near.end());
    double least = std::numeric_limits<double>::infinity();
    std::size_t count = 0;
    for (std::size_t k = 0; k < near.size() && count < rim_particles; ++k) {
      const Vec3& x = water_.position[near[k].particle];
      if (!sees(r.x, x)) continue;
      least = std::min(least,
                       water_.pressure[near[k].particle] + water_.rest_density * water_.gravity.dot(r.x - x));
      ++count;
    }
    return count > 0 ? std::max(0.0, least) : no_water;
  }

  /// The pressure in the gap, which is harmonic: a mean over its rim by the inverse square of the distance.
  /// Particles give a part of it, which is alike for samples beside each other.
  void fill(double dt) {
    double left = 0;  // the part that they leave
    for (std::size_t k = 0; k < covered_.size(); ++k) {
      Sample& s = covered_[k];
      const double p = from_rim(s.x, s.size);
      if (k % alike == 0 || s.at.triangle != covered_[k - 1].at.triangle)
        left = p > 0 ? missing(s, p, dt) / p : 1;
      s.pressure = s.share * left * p;
    }
  }

  double from_rim(const Vec3& x, double size) const {
    double sum = 0, weights = 0;
    for (const Rim& r : rim_) {
      const double w = 1 / ((r.x - x).squaredNorm() + 0.25 * size * size);
      weights += w;
      if (r.pressure != no_water) sum += w * (r.pressure + water_.rest_density * water_.gravity.dot(x - r.x));
    }
    return weights > 0 ? std::max(0.0, sum / weights) : 0;
  }

  /// What particles leave of the pressure p at a point [Pa], a mean about it.
  double missing(const Sample& s, double p, double dt) const {
    const double reach = given_reach * dx_;
    const auto weight = [&](const Vec3& x) {
      return std::max(0.0, 1 - (x - s.x).squaredNorm() / (reach * reach));
    };
    double force = 0, area = 0;  // that is missing, and where it may be
    for (const std::vector<Sample>* samples : {&covered_, &open_})
      for (const Sample& o : *samples) {
        const double part = weight(o.x) * o.area * std::max(0.0, o.normal.dot(s.normal));
        force += part * std::max(0.0, p + water_.rest_density * water_.gravity.dot(o.x - s.x));
        area += part * o.share;
      }
    for (const Given& g : given_) force -= weight(g.x) * std::max(0.0, -g.impulse.dot(s.normal)) / dt;
    return area > 0 ? std::clamp(force / area, 0.0, p) : 0;
  }

  static void push(const Sample& s, double dt, std::vector<Push>& pushes) {
    pushes.push_back({s.at, s.opposite, -dt * s.pressure * s.area * s.normal, s.pressure});
  }

  /// What counts for missing(): what lies in front of none of the gaps' directions does not.
  bool counts(const Vec3& direction) const {
    return std::any_of(covered_.begin(), covered_.end(),
                       [&](const Sample& s) { return direction.dot(s.normal) > 0; });
  }
  void find_given(const GivenBySurface& given) {
    for (const std::uint32_t k : given.of(own_)) {
      const fluid::WallImpulse& g = water_.given[k];
      if (!counts(g.normal)) continue;
      const std::array<Vec3, 3> c = corners_of(own(), g.triangle);
      given_.push_back({g.weights[0] * c[0] + g.weights[1] * c[1] + g.weights[2] * c[2],
                        -g.impulse * g.normal.normalized()});
    }
    open_.erase(
        std::remove_if(open_.begin(), open_.end(), [&](const Sample& o) { return !counts(o.normal); }),
        open_.end());
  }

  struct Given {
    Vec3 x, impulse;  // on the body
  };
  struct Rim {
    Vec3 x;
    double pressure;  // [Pa]
  };

  const GapWater& water_;
  Span<SurfaceMotion* const> surfaces_;
  Span<contact::SurfaceGeometry* const> geometry_;
  const std::vector<Kind>& kinds_;
  std::uint32_t own_;
  double dx_;
  std::vector<std::uint32_t> others_;    // surfaces within reach
  std::vector<std::uint8_t> triangles_;  // 1 = was sampled
  std::vector<Sample> covered_, open_;
  std::vector<std::uint32_t> near_;  // particles
  std::vector<Rim> rim_;
  std::vector<Given> given_;
};

Vec3 place_of(const PointOf& point, const SurfaceMotion& s) {
  const std::array<Vec3, 3> c = corners_of(s, point.triangle);
  return point.weights[0] * c[0] + point.weights[1] * c[1] + point.weights[2] * c[2];
}

/// All that gaps do to a body. Water follows into a gap with √(2 p/ρ0) at most, and a body that would be
/// faster leaves it behind.
class BodyPush {
 public:
  void add(const Push& push, const PointOf& at, const Vec3& impulse, const SurfaceMotion& s) {
    const Vec3 arm = place_of(at, s) - s.body->center_t0;
    impulse_ += impulse;
    moment_ += arm.cross(impulse);
    reach_ = std::max(reach_, arm.norm());
    pressure_ = std::max(pressure_, push.pressure);
  }
  /// The part that it takes.
  double taken(const BodyMotion& body, double rest_density) const {
    const double speed =
        body.inverse_mass.cwiseProduct(impulse_).norm() + reach_ * (body.inverse_inertia * moment_).norm();
    const double most = std::sqrt(2 * pressure_ / rest_density);
    return speed > most ? most / speed : 1;
  }

 private:
  Vec3 impulse_ = Vec3::Zero(), moment_ = Vec3::Zero();
  double reach_ = 0, pressure_ = 0;
};

/// At the speed of the point in the interval.
double apply(const PointOf& at, const Vec3& whole, Span<SurfaceMotion* const> surfaces, double dt) {
  SurfaceMotion& s = *surfaces[at.surface];
  const Triangle& nodes = s.triangles[at.triangle];
  double work = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 impulse = at.weights[k] * whole;
    if (impulse.isZero(0)) continue;
    work += impulse.dot(s.x_t1[nodes[k]] - s.x_t0[nodes[k]]) / dt;
    push_node(s, nodes[k], impulse);
  }
  return work;
}

double apply(const std::vector<Push>& pushes, double rest_density, Span<SurfaceMotion* const> surfaces,
             double dt) {
  std::vector<BodyPush> bodies(surfaces.size());
  for (const Push& push : pushes)
    for (const bool is_own : {true, false}) {
      const PointOf& at = is_own ? push.at : push.opposite;
      const Vec3 impulse = is_own ? push.impulse : Vec3(-push.impulse);
      if (surfaces[at.surface]->body) bodies[at.surface].add(push, at, impulse, *surfaces[at.surface]);
    }
  std::vector<double> taken(surfaces.size(), 1);
  for (std::size_t k = 0; k < surfaces.size(); ++k)
    if (surfaces[k]->body) taken[k] = bodies[k].taken(*surfaces[k]->body, rest_density);
  double work = 0;
  for (const Push& push : pushes) {
    const Vec3 impulse = std::min(taken[push.at.surface], taken[push.opposite.surface]) * push.impulse;
    work += apply(push.at, impulse, surfaces, dt) + apply(push.opposite, -impulse, surfaces, dt);
  }
  for (SurfaceMotion* s : surfaces)
    if (s->body) set_node_velocities(*s);
  return work;
}

}  // namespace

double press_gaps(const GapWater& water, Span<SurfaceMotion* const> surfaces,
                  Span<contact::SurfaceGeometry* const> geometry, double dt, const Workers& workers) {
  OILSKIN_ASSERT(dt > 0 && water.spacing > 0 && surfaces.size() == geometry.size());
  OILSKIN_ASSERT(water.pressure.size() >= water.position.size());
  std::vector<Kind> kinds;
  for (const SurfaceMotion* s : surfaces) kinds.emplace_back(*s);
  std::vector<BodyGaps> bodies;
  for (std::uint32_t k = 0; k < surfaces.size(); ++k) {
    if (!surfaces[k]->body || !surfaces[k]->solid || water.position.empty()) continue;
    BodyGaps gaps(water, surfaces, geometry, kinds, k);
    if (!gaps.empty()) bodies.push_back(std::move(gaps));
  }
  if (bodies.empty()) return 0;
  const WaterBoxes boxes(water, workers);
  const GivenBySurface given(water.given, surfaces.size());
  std::vector<std::vector<Push>> pushes(bodies.size());
  workers.for_each(bodies.size(), 1, [&](std::size_t k) { bodies[k].find(boxes, given, dt, pushes[k]); });
  std::vector<Push> all;
  for (const std::vector<Push>& of_body : pushes) all.insert(all.end(), of_body.begin(), of_body.end());
  return apply(all, water.rest_density, surfaces, dt);
}

}  // namespace oilskin::world
