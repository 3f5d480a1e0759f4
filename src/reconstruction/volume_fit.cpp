#include "reconstruction/volume_fit.h"

#include <algorithm>
#include <cmath>

#include "core/assert.h"
#include "reconstruction/cube_lattice.h"
#include "reconstruction/untangle.h"
#include "reconstruction/vertex_data.h"
#include "reconstruction/water_in_cubes.h"
#include "reconstruction/water_in_pieces.h"

namespace oilskin::reconstruction {

namespace {

using Float3 = std::array<float, 3>;

constexpr std::size_t chunk = 1 << 12;

/// Passes of smoothing in each round of the local fit. The last ones carry what is deep inside, and what is
/// lacking at obstacles, to the surface.
constexpr std::array<int, 3> smoothing_passes = {2, 16, 64};
constexpr int piece_rounds = 3;

/// A film keeps this fraction of its thickness, and vertices that face an obstacle this of their distance.
constexpr double kept_thickness = 0.3, kept_distance = 0.2;

/// Vertices that face an obstacle and exceed the clearance by less than this stay [cells].
constexpr double at_clearance = 0.35;

/// All water but small pieces is moved together by this at most, over the share of its surface that is no
/// film [dx]. Where a deep tank lacks water at its walls, a shallow layer beside it would become thicker for
/// it, and rise and fall as a gap between the two opens and closes.
constexpr double most_common = 0.15;

/// Pieces whose volume is this near to that of their water stay.
constexpr double good_volume = 0.002;

/// Of small pieces that the limits of their vertices keep from their volume.
constexpr double max_scale = 3;

/// Area of a cube that has hardly any surface [cells²].
constexpr float small_area = 0.05f;

/// The volume that a triangle sweeps while its corners move evenly from `from` to `to`: the mean of the moves
/// times the integral of the area vector, which changes with the square of time (Simpson's rule is exact,
/// R.34). So strips between neighbours cancel.
double swept(const std::array<Vec3, 3>& from, const std::array<Vec3, 3>& to) {
  const Vec3 a0 = from[1] - from[0], b0 = from[2] - from[0], a1 = to[1] - to[0], b1 = to[2] - to[0];
  const Vec3 area = a0.cross(b0) + (a0 + a1).cross(b0 + b1) + a1.cross(b1);  // 4 (½ ½) in the middle
  const Vec3 moves = (to[0] - from[0]) + (to[1] - from[1]) + (to[2] - from[2]);
  return moves.dot(area) / 36;
}

class Fit {
 public:
  Fit(const FitLimits& limits, const Grid& grid, const Obstacles& obstacles,
      const std::vector<Float3>& polygonised, const FilmVertices& films, const SurfaceBlocks& blocks,
      RawMesh& mesh, const Workers& workers)
      : limits_(limits),
        grid_(grid),
        obstacles_(obstacles),
        films_(films),
        blocks_(blocks),
        mesh_(mesh),
        workers_(workers),
        moved_(mesh.positions.size(), 0.0f) {
    find_freedom(polygonised);
    vertex_normals(mesh_, blocks_, workers_, normals_);
  }

  /// Moves the surface by what the cubes around it lack, over its area there.
  void fit_cubes(const ParticleBlocks& particles, const Water& water, const DrawnIn& drawn_in,
                 const std::vector<Float3>& polygonised) {
    const CubeLattice lattice(grid_, blocks_with_surface());
    Cubes lacking = water_in_cubes(particles, water, limits_.spacing, grid_, lattice, workers_);
    workers_.for_each(lattice.size(), 16, [&](std::size_t n) {
      for (std::size_t c = 0; c < 8; ++c) lacking[n][c] -= mesh_.cube_volumes[lattice.block(n)][c];
    });
    if (&polygonised != &mesh_.positions) subtract_swept(lattice, polygonised, lacking);
    // Where water has been drawn in, its particles do not show where it is.
    if (!drawn_in.even.empty())
      for (std::size_t n = 0; n < lattice.size(); ++n)
        for (std::size_t c = 0; c < 8; ++c) {
          const float even = drawn_in.even[lattice.block(n)][c];
          lacking[n][c] *= 1 - even * even * even * even;
        }
    const Cubes area = areas(lattice);
    for (std::size_t round = 0; round < smoothing_passes.size(); ++round) {
      const bool is_last = round + 1 == smoothing_passes.size();
      const std::vector<Float3> before = is_last ? std::vector<Float3>() : mesh_.positions;
      Cubes offset = lacking, around = area;
      lattice.smooth(offset, smoothing_passes[round], workers_);
      lattice.smooth(around, smoothing_passes[round], workers_);
      for (std::size_t n = 0; n < offset.size(); ++n)
        for (std::size_t c = 0; c < 8; ++c) offset[n][c] /= around[n][c] + small_area;
      move_by(lattice, offset);
      if (!is_last) subtract_swept(lattice, before, lacking);
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
    double common = 0;  // offset of all that is no small piece
    for (int round = 0; round < piece_rounds; ++round) {
      const std::vector<PieceSum> sums = sums_of_pieces(piece_of_vertex, water.size());
      bool is_good = true;
      std::vector<float> offset(water.size(), 0.0f);
      for (std::size_t p = 0; p < water.size(); ++p) {
        const double lacking = water[p] - sums[p].volume;
        if (!(water[p] > 0 && sums[p].moves > 0)) continue;
        double own = lacking / sums[p].moves;
        if (p + 1 == water.size()) {
          const double most = limits_.spacing * most_common / std::max(1e-6, 1 - sums[p].film / sums[p].area);
          own = std::clamp(common + own, -most, most) - common;
          common += own;
        }
        offset[p] = static_cast<float>(own);
        is_good &= std::abs(lacking) < good_volume * water[p];
      }
      if (is_good) return;
      workers_.for_each(mesh_.positions.size(), chunk, [&](std::size_t v) {
        const std::uint32_t piece = piece_of_vertex[v];
        move(v, in_pieces(v) * offset[piece == none ? water.size() - 1 : piece]);
      });
    }
  }
  /// Scales small pieces that are still too small or too large about their centres, if no obstacle is near.
  void scale_pieces(const std::vector<std::uint32_t>& piece_of_vertex, const std::vector<double>& water) {
    const std::vector<PieceSum> sums = sums_of_pieces(piece_of_vertex, water.size());
    std::vector<Scaling> scaling(water.size());
    for (std::size_t p = 0; p < water.size(); ++p)
      if (water[p] > 0 && sums[p].volume > 0)
        scaling[p].factor = std::clamp(std::cbrt(water[p] / sums[p].volume), 1 / max_scale, max_scale);
    for (std::size_t v = 0; v < mesh_.positions.size(); ++v)
      if (const std::uint32_t p = piece_of_vertex[v]; p != none) scaling[p].add(vec(mesh_.positions[v]));
    for (std::size_t p = 0; p + 1 < water.size(); ++p)
      if (scaling[p].factor != 1 && !is_free(scaling[p].box_after())) scaling[p].factor = 1;
    workers_.for_each(mesh_.positions.size(), chunk, [&](std::size_t v) {
      const std::uint32_t p = piece_of_vertex[v];
      if (p == none || scaling[p].factor == 1) return;
      place(v, scaling[p].moved(vec(mesh_.positions[v])));
    });
  }

 private:
  /// Of a piece: its volume [cells³], its area, and how much of that is a film and takes part in moves
  /// [cells²].
  struct PieceSum {
    double volume = 0, area = 0, film = 0, moves = 0;

    void operator+=(const PieceSum& o) {
      volume += o.volume;
      area += o.area;
      film += o.film;
      moves += o.moves;
    }
  };
  /// Of a piece about the mean of its vertices.
  struct Scaling {
    double factor = 1, count = 0;
    Vec3 sum = Vec3::Zero();
    Box box;

    void add(const Vec3& x) {
      sum += x;
      ++count;
      box.add(x);
    }
    Vec3 moved(const Vec3& x) const {
      const Vec3 middle = sum / count;
      return middle + factor * (x - middle);
    }
    /// Of the piece before and after.
    Box box_after() const {
      Box all = box;
      if (count > 0) {
        all.add(moved(box.min));
        all.add(moved(box.max));
      }
      return all;
    }
  };

  /// It is known that no obstacle is nearer to the box than the gap and a tenth of a cell.
  bool is_free(const Box& box) const {
    if (!limits_.known) return true;
    const Box around = box.inflated(1.01 * limits_.gap + 0.1 * limits_.cell);
    if (!limits_.known->contains(around)) return false;
    std::vector<std::uint32_t> near;
    if (!obstacles_.empty()) obstacles_.query(around, near);
    return near.empty();
  }
  std::array<Vec3, 3> corners(const Triangle& t, const std::vector<Float3>& at) const {
    const double per_cell = 1 / limits_.cell;
    return {per_cell * vec(at[t[0]]), per_cell * vec(at[t[1]]), per_cell * vec(at[t[2]])};
  }
  /// How much of an offset a vertex takes. Films take none of a local one, and one of their piece as their
  /// thickness.
  bool is_free(std::size_t v) const { return max_outward_[v] > 0 || max_inward_[v] > 0; }
  float in_cubes(std::size_t v) const { return is_free(v) ? 1 - films_.share[v] : 0.0f; }
  float in_pieces(std::size_t v) const {
    const float share = films_.share[v];
    return is_free(v) ? 1 - share + share * std::min(1.0f, films_.thickness[v] / float(limits_.spacing)) : 0;
  }
  /// Vertices that face an obstacle come no nearer than the clearance; the upper sides of films keep off the
  /// lower ones.
  void find_freedom(const std::vector<Float3>& polygonised) {
    const std::size_t n = mesh_.positions.size();
    max_outward_.assign(n, static_cast<float>(limits_.max_outward));
    max_inward_.assign(n, static_cast<float>(limits_.max_inward));
    workers_.for_each(n, chunk, [&](std::size_t v) {
      const double own = mesh_.distances[v], above = std::max(0.0, own - limits_.clearance);
      if (!std::isfinite(own)) return;
      const double moved = (vec(mesh_.positions[v]) - vec(polygonised[v])).norm() / limits_.cell;
      if (own < double(grid_.distance(mesh_.inside_nodes[v]))) {
        // Films have moved away from the obstacle.
        const double now = films_.share[v] > 0 ? above + moved : above;
        const double free = (1 - kept_distance) * std::max(0.0, now - at_clearance);
        max_outward_[v] = static_cast<float>(std::min(limits_.max_outward, free));
        max_inward_[v] = static_cast<float>(std::min(limits_.max_inward, free));
      } else {
        max_inward_[v] = static_cast<float>(
            std::min(limits_.max_inward, (1 - kept_thickness) * std::max(0.0, above - moved)));
      }
    });
  }
  std::vector<std::uint8_t> blocks_with_surface() const {
    std::vector<std::uint8_t> result(grid_.blocks.size(), 0);
    for (const std::vector<std::uint32_t>& group : blocks_.groups)
      for (const std::uint32_t b : group) result[b] = 1;
    return result;
  }
  /// Calls f(cube, triangle) for the triangles of a block.
  template <class F>
  void for_triangles(std::uint32_t block, const F& f) const {
    for (std::uint32_t n = mesh_.first_triangle[block]; n < mesh_.first_triangle[block + 1]; ++n)
      f(mesh_.triangle_cubes[n], mesh_.triangles[n]);
  }
  /// Films, and what an obstacle holds, are included: what they lack is not made up for by others nearby. It
  /// would be a rim along the walls of a tank.
  Cubes areas(const CubeLattice& lattice) const {
    Cubes area = lattice.zeros();
    blocks_.for_each(workers_, [&](std::uint32_t b) {
      std::array<float, 8>& own = area[lattice.place(b)];
      for_triangles(b, [&](std::uint8_t cube, const Triangle& t) {
        const std::array<Vec3, 3> c = corners(t, mesh_.positions);
        own[cube] += static_cast<float>(0.5 * (c[1] - c[0]).cross(c[2] - c[0]).norm());
      });
    });
    return area;
  }
  /// Subtracts what the triangles swept on their way from `from`.
  void subtract_swept(const CubeLattice& lattice, const std::vector<Float3>& from, Cubes& lacking) const {
    const std::vector<Float3>& to = mesh_.positions;
    blocks_.for_each(workers_, [&](std::uint32_t b) {
      std::array<float, 8>& own = lacking[lattice.place(b)];
      for_triangles(b, [&](std::uint8_t cube, const Triangle& t) {
        if (from[t[0]] == to[t[0]] && from[t[1]] == to[t[1]] && from[t[2]] == to[t[2]]) return;
        own[cube] -= static_cast<float>(swept(corners(t, from), corners(t, to)));
      });
    });
  }
  /// Moves the vertices by the values of cubes.
  void move_by(const CubeLattice& lattice, const Cubes& values) {
    blocks_.for_each(workers_, [&](std::uint32_t b) {
      const CubeLattice::Around around(lattice, values, b);
      const Vec3 origin = grid_.origin(grid_.blocks[b]);
      for (std::uint32_t v = mesh_.first_vertex[b]; v < mesh_.first_vertex[b + 1]; ++v) {
        const float weight = in_cubes(v);
        if (weight == 0) continue;
        const double offset = around.at((vec(mesh_.positions[v]) - origin) / limits_.cell);
        move(v, weight * static_cast<float>(offset));
      }
    });
  }
  /// Moves a vertex along its normal [cells], within its limits.
  void move(std::size_t v, float offset) {
    const float to = std::clamp(moved_[v] + offset, -max_inward_[v], max_outward_[v]);
    if (to == moved_[v]) return;
    const Vec3 at = vec(mesh_.positions[v]) + double(to - moved_[v]) * limits_.cell * vec(normals_[v]);
    moved_[v] = to;
    place(v, at);
  }
  /// Within the clip box.
  void place(std::size_t v, const Vec3& x) {
    const Vec3 at = clamped_to(limits_.clip, x);
    mesh_.positions[v] = {float(at.x()), float(at.y()), float(at.z())};
  }
  /// Per piece; the last one is that of all other vertices. The sums of chunks are added in their order.
  std::vector<PieceSum> sums_of_pieces(const std::vector<std::uint32_t>& piece_of_vertex,
                                       std::size_t count) const {
    const std::size_t triangles = mesh_.triangles.size();
    std::vector<std::vector<std::pair<std::size_t, PieceSum>>> found((triangles + chunk - 1) / chunk);
    workers_.for_chunks(triangles, chunk, [&](std::size_t from, std::size_t to, std::size_t c) {
      for (std::size_t n = from; n < to; ++n) {
        const Triangle& t = mesh_.triangles[n];
        const std::uint32_t piece = piece_of_vertex[t[0]];
        const std::size_t p = piece == none ? count - 1 : piece;
        if (found[c].empty() || found[c].back().first != p) found[c].push_back({p, {}});
        const std::array<Vec3, 3> x = corners(t, mesh_.positions);
        PieceSum own;
        own.volume = x[0].dot(x[1].cross(x[2])) / 6;
        own.area = 0.5 * (x[1] - x[0]).cross(x[2] - x[0]).norm();
        for (const std::uint32_t v : t) {
          own.film += own.area / 3 * double(films_.share[v]);
          own.moves += own.area / 3 * double(in_pieces(v));
        }
        found[c].back().second += own;
      }
    });
    std::vector<PieceSum> result(count);
    for (const auto& part : found)
      for (const auto& [p, sum] : part) result[p] += sum;
    return result;
  }
  const FitLimits& limits_;
  const Grid& grid_;
  const Obstacles& obstacles_;
  const FilmVertices& films_;
  const SurfaceBlocks& blocks_;
  RawMesh& mesh_;
  const Workers& workers_;
  std::vector<Float3> normals_;  // before any move
  std::vector<float> max_outward_, max_inward_, moved_;
};

}  // namespace

void fit_volume(const FitLimits& limits, const ParticleBlocks& particles, const Water& water,
                const Film& film, const DrawnIn& drawn_in, const Grid& grid, const Obstacles& obstacles,
                const std::vector<Float3>& polygonised, const FilmVertices& films, const MeshParts& parts,
                const SurfaceBlocks& blocks, RawMesh& mesh, const Workers& workers) {
  OILSKIN_ASSERT(water.size() == particles.size());
  if (mesh.positions.empty()) return;
  OILSKIN_ASSERT(mesh.cube_volumes.size() == grid.blocks.size());
  OILSKIN_ASSERT(mesh.distances.size() == mesh.positions.size());
  Fit fit(limits, grid, obstacles, polygonised, films, blocks, mesh, workers);
  if (!limits.clip) fit.fit_cubes(particles, water, drawn_in, polygonised);
  untangle(limits.cell, limits.clip, blocks, mesh, workers);
  SmallPieces pieces = small_pieces(mesh, parts, limits.small_piece * std::pow(limits.cell, 3), workers);
  WaterInPieces found =
      water_in_pieces(particles, water, film, drawn_in, grid, obstacles, mesh, pieces, workers);
  join_pieces_without_water(particles, water, found, mesh, limits.cell, limits.spacing, pieces);
  std::vector<double>& in_pieces = found.water;
  if (limits.clip) fit.leave_clipped_pieces(pieces, in_pieces);
  fit.fit_pieces(pieces.of_vertex, in_pieces);
  if (pieces.count > 0) fit.scale_pieces(pieces.of_vertex, in_pieces);
}

}  // namespace oilskin::reconstruction
