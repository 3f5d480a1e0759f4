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

constexpr std::size_t particle_chunk = 256;

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

/// Round, with the volume 1. 20 triangles would do beside cells of a spacing, but their corners show.
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

  /// Makes it keep off obstacles. False: it is left out. `height`: of its centre [m]; `near`: memory.
  bool fit(Drop& drop, double height, std::vector<std::uint32_t>& near) const {
    if (drop.volume <= limits_.min_volume || !is_in_clip(drop)) return false;
    if (!obstacles_) return true;
    for (int n = 0; n < max_tries; ++n) {
      Drop tried = drop;
      flatten(tried, height);
      if (is_in_clip(tried) && is_clear(tried, near)) {
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
    if (!limits_.clip) return true;
    Box box;
    for (const Vec3& v : shape_.vertices) box.add(drop.place(v));
    return limits_.clip->contains(box);
  }
  /// Lets a drop end at the gap and a little more; one that has too little space moves away.
  void flatten(Drop& drop, double height) const {
    const double radius = radius_ * std::cbrt(drop.volume), space = height - 1.05 * gap_ - 0.02 * radius;
    if (space >= radius) return;
    drop.flatness = std::clamp(space / radius, min_flatness, 1.0);
    drop.centre += std::max(0.0, drop.flatness * radius - space) * drop.normal;
  }
  bool is_clear(const Drop& drop, std::vector<std::uint32_t>& near) const {
    Box box;
    box.add(drop.centre);
    near.clear();
    obstacles_->query(
        box.inflated(radius_ * std::cbrt(drop.volume) / std::sqrt(drop.flatness) + 1.01 * gap_ + 1e-9), near);
    if (near.empty()) return true;
    const auto at = positions(drop);
    for (const Triangle& t : shape_.triangles) {
      const Corners own = stored_corners(at, t);
      for (const std::uint32_t n : near) {
        const Corners other = obstacles_->corners(n);
        if (!certified_apart(own, other, gap_ + obstacles_->rounding(n))) return false;
      }
    }
    // A triangle that does not touch the surface is inside if one of its corners is.
    return std::none_of(near.begin(), near.end(),
                        [&](std::uint32_t n) { return encloses(at, obstacles_->corners(n)[0]); });
  }
  /// Is x behind all sides of the drop at these positions? It is convex.
  bool encloses(const std::vector<std::array<float, 3>>& at, const Vec3& x) const {
    return std::all_of(shape_.triangles.begin(), shape_.triangles.end(), [&](const Triangle& t) {
      const Corners c = stored_corners(at, t);
      return (c[1] - c[0]).cross(c[2] - c[0]).dot(x - c[0]) < 0;
    });
  }

  Shape shape_;
  double radius_ = 0;
  const DropLimits& limits_;
  const Obstacles* obstacles_;
  double gap_;
};

/// A drop that is drawn.
struct DrawnDrop {
  std::uint32_t particle;  // of the input
  Drop drop;
};

/// The drops in the order of their particles.
std::vector<DrawnDrop> fit_drops(const ReconstructionInput& input, const ParticleBlocks& particles,
                                 const Water& water, const Film& film, const DropLimits& limits,
                                 const DropMaker& maker, const Workers& workers, DropReport& report) {
  struct Part {
    std::vector<DrawnDrop> drawn;
    std::size_t left_out = 0;
  };
  std::vector<Part> parts((particles.size() + particle_chunk - 1) / particle_chunk);
  workers.for_chunks(particles.size(), particle_chunk,
                     [&](std::size_t begin, std::size_t end, std::size_t c) {
                       std::vector<std::uint32_t> near;
                       for (auto p = static_cast<std::uint32_t>(begin); p < end; ++p) {
                         if (!water.is_drop(p) || !(water.of(p) > 0)) continue;
                         Drop drop;
                         drop.centre = input.positions[particles.source[p]];
                         drop.normal = Vec3::UnitZ();
                         drop.volume = water.of(p) * limits.cell * limits.cell * limits.cell;
                         double height = std::numeric_limits<double>::infinity();
                         if (const FilmParticle* at = film.find(p)) {
                           drop.normal = Vec3(at->normal[0], at->normal[1], at->normal[2]);
                           height = double(at->height) * limits.cell;
                         }
                         if (maker.fit(drop, height, near))
                           parts[c].drawn.push_back({particles.source[p], drop});
                         else
                           ++parts[c].left_out;
                       }
                     });
  std::vector<DrawnDrop> drops;
  for (const Part& part : parts) {
    drops.insert(drops.end(), part.drawn.begin(), part.drawn.end());
    report.left_out += part.left_out;
  }
  report.drawn = drops.size();
  return drops;
}

/// Makes space for more vertices and triangles.
void resize(WaterMesh& mesh, const ReconstructionInput& input, std::size_t vertices, std::size_t triangles,
            bool nearest) {
  mesh.positions.resize(mesh.positions.size() + vertices);
  mesh.normals.resize(mesh.normals.size() + vertices);
  if (!input.velocities.empty()) mesh.velocities.resize(mesh.velocities.size() + vertices);
  if (nearest) mesh.nearest.resize(mesh.nearest.size() + vertices);
  mesh.thickness.resize(mesh.thickness.size() + vertices, 0);
  for (std::size_t a = 0; a < input.attributes.size(); ++a)
    mesh.attributes[a].values.resize(mesh.attributes[a].values.size() +
                                     vertices * static_cast<std::size_t>(input.attributes[a].components));
  mesh.triangles.resize(mesh.triangles.size() + triangles);
}

/// Writes a drop where there is space for it.
void write(const ReconstructionInput& input, const DrawnDrop& drawn, const Shape& shape, bool nearest,
           std::size_t first_vertex, std::size_t first_triangle, WaterMesh& mesh) {
  const Drop& drop = drawn.drop;
  for (std::size_t k = 0; k < shape.vertices.size(); ++k) {
    const Vec3& v = shape.vertices[k];
    const std::size_t at = first_vertex + k;
    const Vec3 x = drop.place(v);
    mesh.positions[at] = {float(x.x()), float(x.y()), float(x.z())};
    const double along = drop.normal.dot(v);
    const Vec3 n =
        (v + (1 / (drop.flatness * std::sqrt(drop.flatness)) - 1) * along * drop.normal).normalized();
    mesh.normals[at] = {float(n.x()), float(n.y()), float(n.z())};
    if (!input.velocities.empty()) {
      const Vec3& u = input.velocities[drawn.particle];
      mesh.velocities[at] = {float(u.x()), float(u.y()), float(u.z())};
    }
    if (nearest) mesh.nearest[at] = drawn.particle;
    for (std::size_t a = 0; a < input.attributes.size(); ++a) {
      const auto m = static_cast<std::size_t>(input.attributes[a].components);
      for (std::size_t i = 0; i < m; ++i)
        mesh.attributes[a].values[at * m + i] = input.attributes[a].values[drawn.particle * m + i];
    }
  }
  const auto first = static_cast<std::uint32_t>(first_vertex);
  for (std::size_t k = 0; k < shape.triangles.size(); ++k) {
    const Triangle& t = shape.triangles[k];
    mesh.triangles[first_triangle + k] = {first + t[0], first + t[1], first + t[2]};
  }
}

}  // namespace

double reach_of_drop(double volume) {
  // Flattened it is 1 / √min_flatness times as wide, and moves by its radius at most.
  return (1 / std::sqrt(min_flatness) + 1) * std::cbrt(volume);
}

DropReport add_drops(const ReconstructionInput& input, const ParticleBlocks& particles, const Water& water,
                     const Film& film, const DropLimits& limits, bool nearest, const Workers& workers,
                     WaterMesh& mesh) {
  DropReport report;
  const DropMaker maker(limits);
  const std::vector<DrawnDrop> drops =
      fit_drops(input, particles, water, film, limits, maker, workers, report);
  const Shape& shape = maker.shape();
  const std::size_t vertices = mesh.positions.size(), triangles = mesh.triangles.size();
  resize(mesh, input, drops.size() * shape.vertices.size(), drops.size() * shape.triangles.size(), nearest);
  workers.for_each(drops.size(), 64, [&](std::size_t d) {
    write(input, drops[d], shape, nearest, vertices + d * shape.vertices.size(),
          triangles + d * shape.triangles.size(), mesh);
  });
  return report;
}

}  // namespace oilskin::reconstruction
