#include "reconstruction/volume_fit.h"

#include <algorithm>
#include <cmath>

#include "core/assert.h"
#include "reconstruction/cube_lattice.h"
#include "reconstruction/pieces.h"
#include "reconstruction/vertex_data.h"

namespace oilskin::reconstruction {

namespace {

using Float3 = std::array<float, 3>;

constexpr std::size_t chunk = 1 << 12;

/// Passes of smoothing in each round of the local fit: the last ones carry what is deep inside to the
/// surface.
constexpr std::array<int, 2> smoothing_passes = {2, 4};
constexpr int piece_rounds = 3;

/// A film keeps this fraction of its thickness, and vertices that face an obstacle this of their distance.
constexpr double kept_thickness = 0.3, kept_distance = 0.2;

/// Vertices that face an obstacle and exceed the clearance by less than this stay [cells].
constexpr double at_clearance = 0.35;

/// Pieces whose volume is this near to that of their water stay.
constexpr double good_volume = 0.002;

/// Of small pieces that the limits of their vertices keep from their volume.
constexpr double max_scale = 1.3;

/// Area of a cube that has hardly any surface [cells²].
constexpr float small_area = 0.05f;

/// Six times the volume between the triangles (a, b, c) and (a2, b2, c2). Strips between their edges are
/// divided both ways and averaged, so that those of neighbours cancel.
double six_swept(const std::array<Vec3, 3>& from, const std::array<Vec3, 3>& to) {
  const Vec3& o = from[0];
  const auto six = [&](const Vec3& x, const Vec3& y, const Vec3& z) {
    return (x - o).dot((y - o).cross(z - o));
  };
  double sum = six(to[0], to[1], to[2]) - six(from[0], from[1], from[2]);
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 &a = from[k], &b = from[(k + 1) % 3], &a2 = to[k], &b2 = to[(k + 1) % 3];
    sum += 0.5 * (six(a, b, b2) + six(a, b2, a2) + six(a, b, a2) + six(b, b2, a2));
  }
  return sum;
}

class Fit {
 public:
  Fit(const FitLimits& limits, const Grid& grid, const std::vector<Float3>& polygonised,
      const FilmVertices& films, RawMesh& mesh, const Workers& workers)
      : limits_(limits), grid_(grid), lattice_(grid), mesh_(mesh), workers_(workers) {
    find_freedom(polygonised);
    find_weights(films);
    cube_.reserve(mesh.triangles.size());
    for (const Triangle& t : mesh.triangles) {
      const std::array<Vec3, 3> c = corners(t, mesh.positions);
      cube_.push_back(lattice_.cube_at((c[0] + c[1] + c[2]) / 3));
    }
    volume_ = mesh.cube_volumes;
    add_swept(polygonised);
  }

  /// Moves the surface by what the cubes around it lack, over its area there.
  void fit_cubes(const Cubes& water) {
    normals_ = vertex_normals(mesh_);
    for (std::size_t round = 0; round < smoothing_passes.size(); ++round) {
      Cubes lacking = water;
      for (std::size_t b = 0; b < lacking.size(); ++b)
        for (std::size_t c = 0; c < 8; ++c) lacking[b][c] -= volume_[b][c];
      lacking = lattice_.smoothed(std::move(lacking), smoothing_passes[round], workers_);
      const Cubes area = lattice_.smoothed(areas(), smoothing_passes[round], workers_);
      for (std::size_t b = 0; b < lacking.size(); ++b)
        for (std::size_t c = 0; c < 8; ++c) lacking[b][c] /= area[b][c] + small_area;
      const bool is_last = round + 1 == smoothing_passes.size();
      const std::vector<Float3> before = is_last ? std::vector<Float3>() : mesh_.positions;
      const std::vector<float> offset = offsets(lacking);
      move([&](std::size_t v) { return offset[v]; }, in_cubes_);
      if (!is_last) add_swept(before);
    }
  }
  /// Sets the water of pieces that the clip box cuts, and of all that is not small, to 0.
  void leave_clipped_pieces(const SmallPieces& pieces, std::vector<double>& water) const {
    water.back() = 0;
    const Box inner = limits_.clip->inflated(-0.05 * limits_.cell);
    for (std::size_t v = 0; v < mesh_.positions.size(); ++v)
      if (pieces.of_vertex[v] != none && !inner.contains(vec(mesh_.positions[v])))
        water[pieces.of_vertex[v]] = 0;
  }
  /// Moves each piece evenly. `water` per piece [cells³], 0: it stays; the last one is that of all other
  /// vertices.
  void fit_pieces(const std::vector<std::uint32_t>& piece_of_vertex, const std::vector<double>& water) {
    const std::size_t rest = water.size() - 1;
    const auto piece = [&](std::size_t v) {
      return piece_of_vertex[v] == none ? rest : std::size_t(piece_of_vertex[v]);
    };
    for (int round = 0; round < piece_rounds; ++round) {
      std::vector<double> volume(water.size(), 0), area(water.size(), 0);
      for (const Triangle& t : mesh_.triangles) {
        const std::array<Vec3, 3> c = corners(t, mesh_.positions);
        volume[piece(t[0])] += c[0].dot(c[1].cross(c[2])) / 6;
        area[piece(t[0])] += weighted_area(t, c, in_pieces_);
      }
      bool is_good = true;
      std::vector<float> offset(water.size(), 0.0f);
      for (std::size_t p = 0; p < water.size(); ++p) {
        if (!(water[p] > 0 && area[p] > 0)) continue;
        offset[p] = static_cast<float>((water[p] - volume[p]) / area[p]);
        is_good &= std::abs(water[p] - volume[p]) < good_volume * water[p];
      }
      if (is_good) return;
      normals_ = vertex_normals(mesh_);
      move([&](std::size_t v) { return offset[piece(v)]; }, in_pieces_);
    }
  }
  /// Scales small pieces that are still too small or too large about their centres, if no obstacle is near.
  void scale_pieces(const std::vector<std::uint32_t>& piece_of_vertex, const std::vector<double>& water) {
    std::vector<double> volume(water.size(), 0), count(water.size(), 0);
    std::vector<Vec3> centre(water.size(), Vec3::Zero());
    std::vector<std::uint8_t> is_alone(water.size(), 1);
    for (std::size_t v = 0; v < mesh_.positions.size(); ++v) {
      const std::uint32_t p = piece_of_vertex[v];
      if (p == none) continue;
      centre[p] += vec(mesh_.positions[v]);
      ++count[p];
      if (std::isfinite(mesh_.distances[v])) is_alone[p] = 0;
    }
    for (const Triangle& t : mesh_.triangles) {
      if (piece_of_vertex[t[0]] == none) continue;
      const std::array<Vec3, 3> c = corners(t, mesh_.positions);
      volume[piece_of_vertex[t[0]]] += c[0].dot(c[1].cross(c[2])) / 6;
    }
    for (std::size_t v = 0; v < mesh_.positions.size(); ++v) {
      const std::uint32_t p = piece_of_vertex[v];
      if (p == none || !is_alone[p] || !(water[p] > 0) || !(volume[p] > 0)) continue;
      const Vec3 middle = centre[p] / count[p];
      const double scale = std::clamp(std::cbrt(water[p] / volume[p]), 1 / max_scale, max_scale);
      const Vec3 at = middle + scale * (vec(mesh_.positions[v]) - middle);
      mesh_.positions[v] = {float(at.x()), float(at.y()), float(at.z())};
    }
  }

 private:
  std::array<Vec3, 3> corners(const Triangle& t, const std::vector<Float3>& at) const {
    return {vec(at[t[0]]) / limits_.cell, vec(at[t[1]]) / limits_.cell, vec(at[t[2]]) / limits_.cell};
  }
  double weighted_area(const Triangle& t, const std::array<Vec3, 3>& c,
                       const std::vector<float>& weight) const {
    const double sum = double(weight[t[0]]) + double(weight[t[1]]) + double(weight[t[2]]);
    return sum == 0 ? 0 : sum / 6 * (c[1] - c[0]).cross(c[2] - c[0]).norm();
  }
  /// How much of an offset a vertex takes. Films take none of a local one, and one of their piece as their
  /// thickness.
  void find_weights(const FilmVertices& films) {
    in_cubes_.assign(mesh_.positions.size(), 0.0f);
    is_free_ = in_pieces_ = in_cubes_;
    for (std::size_t v = 0; v < in_cubes_.size(); ++v) {
      if (!(max_outward_[v] > 0 || max_inward_[v] > 0)) continue;
      is_free_[v] = 1;
      const float share = films.share[v];
      in_cubes_[v] = 1 - share;
      in_pieces_[v] = 1 - share + share * std::min(1.0f, films.thickness[v] / float(limits_.spacing));
    }
  }
  /// Vertices that face an obstacle come no nearer than the clearance; the upper sides of films keep off the
  /// lower ones.
  void find_freedom(const std::vector<Float3>& polygonised) {
    const std::size_t n = mesh_.positions.size();
    max_outward_.assign(n, static_cast<float>(limits_.max_outward));
    max_inward_.assign(n, static_cast<float>(limits_.max_inward));
    workers_.for_each(n, chunk, [&](std::size_t v) {
      const double own = mesh_.distances[v], above = std::max(0.0, own - limits_.clearance);
      const bool faces_obstacle = own < double(grid_.distance(mesh_.inside_nodes[v]));
      if (std::isfinite(own) && faces_obstacle) {
        const double free = (1 - kept_distance) * std::max(0.0, above - at_clearance);
        max_outward_[v] = static_cast<float>(std::min(limits_.max_outward, free));
        max_inward_[v] = static_cast<float>(std::min(limits_.max_inward, free));
      } else if (std::isfinite(own)) {
        const double moved = (vec(mesh_.positions[v]) - vec(polygonised[v])).norm() / limits_.cell;
        max_inward_[v] = static_cast<float>(
            std::min(limits_.max_inward, (1 - kept_thickness) * std::max(0.0, above - moved)));
      }
    });
  }
  /// Of what is free to move, films included: what they lack is not made up for by others.
  Cubes areas() const {
    Cubes area = lattice_.zeros();
    for (std::size_t t = 0; t < cube_.size(); ++t)
      if (cube_[t] != none)
        area[cube_[t] / 8][cube_[t] % 8] += static_cast<float>(
            weighted_area(mesh_.triangles[t], corners(mesh_.triangles[t], mesh_.positions), is_free_));
    return area;
  }
  /// Adds what the triangles swept on their way from `from`.
  void add_swept(const std::vector<Float3>& from) {
    const std::vector<Float3>& to = mesh_.positions;
    for (std::size_t n = 0; n < cube_.size(); ++n) {
      const Triangle& t = mesh_.triangles[n];
      if (cube_[n] == none || (from[t[0]] == to[t[0]] && from[t[1]] == to[t[1]] && from[t[2]] == to[t[2]]))
        continue;
      volume_[cube_[n] / 8][cube_[n] % 8] +=
          static_cast<float>(six_swept(corners(t, from), corners(t, to)) / 6);
    }
  }
  /// The values of cubes at the vertices.
  std::vector<float> offsets(const Cubes& values) const {
    std::vector<float> offset(mesh_.positions.size(), 0.0f);
    workers_.for_each(grid_.blocks.size(), 8, [&](std::size_t b) {
      const std::uint32_t begin = mesh_.first_vertex[b], end = mesh_.first_vertex[b + 1];
      if (begin == end) return;
      const CubeLattice::Around around(lattice_, values, static_cast<std::uint32_t>(b));
      const Vec3 origin = grid_.origin(grid_.blocks[b]);
      for (std::uint32_t v = begin; v < end; ++v)
        offset[v] = static_cast<float>(around.at((vec(mesh_.positions[v]) - origin) / limits_.cell));
    });
    return offset;
  }
  /// Moves the vertices along their normals, within their limits.
  template <class Offset>
  void move(const Offset& offset, const std::vector<float>& weight) {
    workers_.for_each(mesh_.positions.size(), chunk, [&](std::size_t v) {
      const float to = std::clamp(moved_[v] + weight[v] * offset(v), -max_inward_[v], max_outward_[v]);
      const Vec3 at = vec(mesh_.positions[v]) + double(to - moved_[v]) * limits_.cell * vec(normals_[v]);
      moved_[v] = to;
      mesh_.positions[v] = {float(at.x()), float(at.y()), float(at.z())};
    });
  }

  const FitLimits& limits_;
  const Grid& grid_;
  CubeLattice lattice_;
  RawMesh& mesh_;
  const Workers& workers_;
  std::vector<Float3> normals_;
  std::vector<float> max_outward_, max_inward_;
  std::vector<float> is_free_, in_cubes_, in_pieces_;  // weights
  std::vector<float> moved_ = std::vector<float>(mesh_.positions.size(), 0.0f);
  std::vector<std::uint32_t> cube_;  // of each triangle's centre, at first
  Cubes volume_;
};

/// The water in the cubes of the grid.
Cubes water_in_cubes(const ParticleBlocks& particles, const Water& water, const Grid& grid) {
  Cubes result(grid.blocks.size(), std::array<float, 8>{});
  for (std::size_t n = 0; n < particles.blocks.size(); ++n) {
    const std::uint32_t b = grid.index.find(key_of(particles.blocks[n]));
    if (b == none) continue;
    std::array<double, 8> sum{};
    for (std::size_t p = particles.begin[n]; p < particles.begin[n + 1]; ++p) {
      const auto at = [](float x) { return std::min(static_cast<int>(x), side - 1); };
      if (!water.is_drop(p))
        sum[cube_of(at(particles.x[p]), at(particles.y[p]), at(particles.z[p]))] += water.of(p);
    }
    for (std::size_t c = 0; c < 8; ++c) result[b][c] = static_cast<float>(sum[c]);
  }
  return result;
}

/// The water in small pieces; the last one stands for all others.
std::vector<double> water_in_pieces(const ParticleBlocks& particles, const Water& water, const Grid& grid,
                                    const RawMesh& mesh, const SmallPieces& pieces) {
  std::vector<double> result(pieces.count + 1, 0);
  const PieceFinder finder(grid, mesh, pieces);
  for (std::size_t n = 0; n < particles.blocks.size(); ++n) {
    const bool is_near = finder.is_near(particles.blocks[n]);
    for (std::size_t p = particles.begin[n]; p < particles.begin[n + 1]; ++p) {
      if (water.is_drop(p)) continue;
      const std::uint32_t piece = is_near ? finder.find(particles.place(n, p)) : none;
      result[piece == none ? pieces.count : piece] += water.of(p);
    }
  }
  return result;
}

}  // namespace

void fit_volume(const FitLimits& limits, const ParticleBlocks& particles, const Water& water,
                const Grid& grid, const std::vector<Float3>& polygonised, const FilmVertices& films,
                RawMesh& mesh, const Workers& workers) {
  OILSKIN_ASSERT(water.size() == particles.size());
  if (mesh.positions.empty()) return;
  OILSKIN_ASSERT(mesh.cube_volumes.size() == grid.blocks.size());
  OILSKIN_ASSERT(mesh.distances.size() == mesh.positions.size());
  Fit fit(limits, grid, polygonised, films, mesh, workers);
  if (!limits.clip) fit.fit_cubes(water_in_cubes(particles, water, grid));
  const SmallPieces pieces = small_pieces(mesh, limits.small_piece * std::pow(limits.cell, 3));
  std::vector<double> in_pieces = water_in_pieces(particles, water, grid, mesh, pieces);
  if (limits.clip) fit.leave_clipped_pieces(pieces, in_pieces);
  fit.fit_pieces(pieces.of_vertex, in_pieces);
  if (pieces.count > 0) fit.scale_pieces(pieces.of_vertex, in_pieces);
}

}  // namespace oilskin::reconstruction
