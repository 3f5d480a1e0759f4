#include "reconstruction/drops.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "reconstruction/triangle_distance.h"
#include "reconstruction/triangle_pairs.h"

namespace oilskin::reconstruction {

namespace {

/// A flattened drop is at least this thick, as a fraction of the sphere's diameter, and is tried again with
/// less volume so many times where an obstacle is in the way.
constexpr double min_flatness = 0.4, shrink = 0.8;
constexpr int max_tries = 8;

struct Shape {
  std::vector<Vec3> vertices;  // from the centre
  std::vector<Triangle> triangles;
};

Shape icosahedron() {
  const double g = (1 + std::sqrt(5.0)) / 2;
  Shape s;
  for (const double a : {-1.0, 1.0})
    for (const double b : {-g, g}) {
      s.vertices.emplace_back(0, a, b);
      s.vertices.emplace_back(a, b, 0);
      s.vertices.emplace_back(b, 0, a);
    }
  const auto n = static_cast<std::uint32_t>(s.vertices.size());
  const auto adjoin = [&](std::uint32_t i, std::uint32_t j) {
    return (s.vertices[i] - s.vertices[j]).squaredNorm() < 4.1;
  };
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = i + 1; j < n; ++j)
      for (std::uint32_t k = j + 1; k < n; ++k) {
        if (!adjoin(i, j) || !adjoin(j, k) || !adjoin(i, k)) continue;
        const bool out = s.vertices[i].dot(s.vertices[j].cross(s.vertices[k])) > 0;
        s.triangles.push_back(out ? Triangle{i, j, k} : Triangle{i, k, j});
      }
  for (Vec3& v : s.vertices) v.normalize();
  return s;
}

/// Each triangle becomes four.
Shape subdivided(const Shape& s) {
  Shape result;
  result.vertices = s.vertices;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middle;
  const auto between = [&](std::uint32_t a, std::uint32_t b) {
    const auto found = middle.emplace(std::minmax(a, b), static_cast<std::uint32_t>(result.vertices.size()));
    if (found.second) result.vertices.push_back((s.vertices[a] + s.vertices[b]).normalized());
    return found.first->second;
  };
  for (const Triangle& t : s.triangles) {
    const std::uint32_t ab = between(t[0], t[1]), bc = between(t[1], t[2]), ca = between(t[2], t[0]);
    for (const Triangle& part : {Triangle{t[0], ab, ca}, {t[1], bc, ab}, {t[2], ca, bc}, {ab, bc, ca}})
      result.triangles.push_back(part);
  }
  return result;
}

/// Round, with the volume 1.
Shape unit_drop() {
  Shape s = subdivided(icosahedron());
  double volume = 0;
  for (const Triangle& t : s.triangles)
    volume += s.vertices[t[0]].dot(s.vertices[t[1]].cross(s.vertices[t[2]])) / 6;
  for (Vec3& v : s.vertices) v /= std::cbrt(volume);
  return s;
}

/// Where a drop is drawn, and how flat.
struct Drop {
  Vec3 centre;          // [m]
  Vec3 normal;          // of the flattening
  double volume = 0;    // [m³]
  double flatness = 1;  // thickness over the sphere's

  Vec3 place(const Vec3& v) const {
    const double along = normal.dot(v), wide = 1 / std::sqrt(flatness);
    return centre + std::cbrt(volume) * (wide * (v - along * normal) + flatness * along * normal);
  }
};

class DropMaker {
 public:
  explicit DropMaker(const DropLimits& limits)
      : shape_(unit_drop()), limits_(limits), obstacles_(limits.obstacles), gap_(limits.gap) {
    for (const Vec3& v : shape_.vertices) radius_ = std::max(radius_, v.norm());
  }

  /// Makes it keep off obstacles. False: it is left out. `height`: of its centre [m].
  bool fit(Drop& drop, double height) {
    if (drop.volume <= limits_.min_volume || !is_in_clip(drop)) return false;
    if (!obstacles_) return true;
    for (int n = 0; n < max_tries; ++n) {
      Drop tried = drop;
      flatten(tried, height);
      if (is_clear(tried)) {
        drop = tried;
        return true;
      }
      drop.volume *= shrink * shrink * shrink;
    }
    return false;
  }
  std::vector<std::array<float, 3>> positions(const Drop& drop) const {
    std::vector<std::array<float, 3>> result;
    for (const Vec3& v : shape_.vertices) {
      const Vec3 x = drop.place(v);
      result.push_back({float(x.x()), float(x.y()), float(x.z())});
    }
    return result;
  }
  const Shape& shape() const { return shape_; }

 private:
  bool is_in_clip(const Drop& drop) const {
    Box box;
    box.add(drop.centre);
    return !limits_.clip || limits_.clip->contains(box.inflated(radius_ * std::cbrt(drop.volume)));
  }
  /// Lets a drop end at the gap and a little more; one that has too little space moves away.
  void flatten(Drop& drop, double height) const {
    const double radius = radius_ * std::cbrt(drop.volume), space = height - 1.05 * gap_ - 0.02 * radius;
    if (space >= radius) return;
    drop.flatness = std::clamp(space / radius, min_flatness, 1.0);
    drop.centre += std::max(0.0, drop.flatness * radius - space) * drop.normal;
  }
  bool is_clear(const Drop& drop) {
    Box box;
    box.add(drop.centre);
    near_.clear();
    obstacles_->query(
        box.inflated(radius_ * std::cbrt(drop.volume) / std::sqrt(drop.flatness) + 1.01 * gap_ + 1e-9),
        near_);
    if (near_.empty()) return true;
    const auto at = positions(drop);
    for (const Triangle& t : shape_.triangles) {
      const Corners own = stored_corners(at, t);
      for (const std::uint32_t n : near_) {
        const Corners other = obstacles_->corners(n);
        if (!certified_apart(own, other, gap_ + obstacles_->rounding(n))) return false;
      }
    }
    return true;
  }

  Shape shape_;
  double radius_ = 0;
  const DropLimits& limits_;
  const Obstacles* obstacles_;
  double gap_;
  std::vector<std::uint32_t> near_;
};

void append(const ReconstructionInput& input, std::uint32_t particle, const Drop& drop,
            const DropMaker& maker, bool nearest, WaterMesh& mesh) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  const auto positions = maker.positions(drop);
  mesh.positions.insert(mesh.positions.end(), positions.begin(), positions.end());
  for (const Vec3& v : maker.shape().vertices) {
    const double along = drop.normal.dot(v);
    const Vec3 n =
        (v + (1 / (drop.flatness * std::sqrt(drop.flatness)) - 1) * along * drop.normal).normalized();
    mesh.normals.push_back({float(n.x()), float(n.y()), float(n.z())});
    if (!input.velocities.empty()) {
      const Vec3& u = input.velocities[particle];
      mesh.velocities.push_back({float(u.x()), float(u.y()), float(u.z())});
    }
    if (nearest) mesh.nearest.push_back(particle);
    mesh.thickness.push_back(0);
    for (std::size_t a = 0; a < input.attributes.size(); ++a) {
      const auto m = static_cast<std::size_t>(input.attributes[a].components);
      for (std::size_t k = 0; k < m; ++k)
        mesh.attributes[a].values.push_back(input.attributes[a].values[particle * m + k]);
    }
  }
  for (const Triangle& t : maker.shape().triangles)
    mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
}

}  // namespace

DropReport add_drops(const ReconstructionInput& input, const ParticleBlocks& particles, const Water& water,
                     const Film& film, const DropLimits& limits, bool nearest, WaterMesh& mesh) {
  DropReport report;
  DropMaker maker(limits);
  for (std::uint32_t p = 0; p < particles.size(); ++p) {
    if (!water.is_drop(p) || !(water.of(p) > 0)) continue;
    Drop drop;
    drop.centre = input.positions[particles.source[p]];
    drop.normal = Vec3::UnitZ();
    drop.volume = water.of(p) * limits.cell * limits.cell * limits.cell;
    double height = std::numeric_limits<double>::infinity();
    if (const FilmParticle* near = film.find(p)) {
      drop.normal = Vec3(near->normal[0], near->normal[1], near->normal[2]);
      height = double(near->height) * limits.cell;
    }
    const bool fits = maker.fit(drop, height);
    ++(fits ? report.drawn : report.left_out);
    if (fits) append(input, particles.source[p], drop, maker, nearest, mesh);
  }
  return report;
}

}  // namespace oilskin::reconstruction
