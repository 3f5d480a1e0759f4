#include "reconstruction/even_water.h"

#include <algorithm>
#include <cmath>

#include "core/disjoint_sets.h"
#include "reconstruction/evenness.h"

namespace oilskin::reconstruction {

namespace {

/// Of the means around nodes [dx].
constexpr double deviation = 1.5;

/// Shares of the space around a node from which on it is inside.
constexpr std::array<float, 16> shares = {0,     0.12f, 0.25f, 0.33f, 0.42f, 0.50f,  0.58f,  0.66f,
                                          0.73f, 0.79f, 0.84f, 0.88f, 0.91f, 0.935f, 0.955f, 0.97f};

/// Cubes that enclose less of their space keep their surface.
constexpr float hardly_any = 0.05f, some = 0.1f;

/// Water is thin if no node within so far [dx] has a larger share: sheets of up to three layers of particles,
/// and threads. They are not drawn in: the grid has no space for less.
constexpr double thin_reach = 3;
constexpr float thin = 0.66f, thick = 0.76f;

/// Excess over the water from which on the surface is drawn in, and from which on by all of it.
constexpr float small_excess = 0.02f, whole_excess = 0.07f;

/// Pieces that enclose more of their water than this are drawn in again, in so many rounds.
constexpr double too_much = 0.02;
constexpr int rounds = 4;

/// Nodes with a smaller share stay only with others that have more.
constexpr float of_crumb = 0.45f;

/// The least value of nodes that are left out [cells].
constexpr float just_outside = 0.05f;

/// Particles are moved at most so far in a round [dx].
constexpr double most_drawn_in = 8;

/// The share that encloses as much as there is water. `enclosed` decreases.
float share_of(const std::array<float, shares.size()>& enclosed, float water) {
  for (std::size_t k = 1; k < shares.size(); ++k)
    if (enclosed[k] < water) {
      const float above = enclosed[k - 1] - water, all = enclosed[k - 1] - enclosed[k];
      return shares[k - 1] + (shares[k] - shares[k - 1]) * above / std::max(all, 1e-6f);
    }
  return shares.back();
}

/// Nodes inside that have more than each of the shares around them, per cube.
std::array<Cubes, shares.size()> count_enclosed(const Grid& grid, const CubeLattice& lattice,
                                                const std::vector<std::array<std::uint8_t, 8>>& is_free,
                                                const NodeValues& around, const Workers& workers) {
  std::array<Cubes, shares.size()> result;
  for (Cubes& at_share : result) at_share = lattice.zeros();
  workers.for_each(lattice.size(), 16, [&](std::size_t n) {
    for (int node = 0; node < nodes; ++node) {
      if (!grid.is_inside({lattice.block(n), node})) continue;
      const std::size_t cube = cube_of(node & 7, node >> 3 & 7, node >> 6);
      if (!is_free[n][cube]) continue;
      const float own = around[n][std::size_t(node)];
      for (std::size_t k = 0; k < shares.size() && own > shares[k]; ++k) ++result[k][n][cube];
    }
  });
  for (Cubes& at_share : result) lattice.smooth(at_share, 2, workers);
  return result;
}

/// The share from which on nodes are inside, per cube; 0 where all stay.
Cubes shares_of_cubes(const std::array<Cubes, shares.size()>& enclosed, const Cubes& in_cubes,
                      const Cubes& even, const CubeLattice& lattice, const Workers& workers) {
  Cubes result = lattice.zeros();
  workers.for_each(lattice.size(), 64, [&](std::size_t n) {
    for (std::size_t c = 0; c < 8; ++c) {
      std::array<float, shares.size()> at;
      for (std::size_t k = 0; k < shares.size(); ++k) at[k] = enclosed[k][n][c];
      const float excess = at[0] - in_cubes[n][c];
      if (even[n][c] > 0 && excess > 0) result[n][c] = share_of(at, at[0] - even[n][c] * excess);
    }
  });
  return result;
}

/// The least share at a node, if the surface may move there; else 0. `may_move`: per node how far, 0 … 1.
class LeastShare {
 public:
  LeastShare(const CubeLattice& lattice, const Cubes& of_cubes, std::uint32_t block,
             const std::array<float, nodes>& may_move)
      : around_(lattice, of_cubes, block), may_move_(may_move) {}
  bool is_zero() const { return around_.is_zero(); }
  float at(int node) const {
    const float free = may_move_[std::size_t(node)];
    return free > 0 ? free * float(around_.at_node(node)) : 0;
  }

 private:
  CubeLattice::Around around_;
  const std::array<float, nodes>& may_move_;
};

}  // namespace

EvenWater::EvenWater(const ParticleBlocks& particles, const Cubes& in_cubes, double spacing, double band,
                     const Grid& grid, const CubeLattice& lattice, const Workers& workers)
    : particles_(particles), lattice_(lattice), workers_(workers), spacing_(spacing), band_(band) {
  find_free_cubes(in_cubes, grid);
  even_ = evenness(particles, spacing, even_, grid, lattice, workers);
}

std::vector<std::uint8_t> EvenWater::blocks(std::size_t count) const {
  std::vector<std::uint8_t> result(count, 0);
  for (std::size_t n = 0; n < lattice_.size(); ++n) result[lattice_.block(n)] = is_even(n);
  return result;
}

bool EvenWater::is_even(std::size_t place) const {
  return std::any_of(even_[place].begin(), even_[place].end(), [](float e) { return e > 0; });
}

NodeValues EvenWater::shares_around(const Grid& grid) const {
  return inside_shares(inside_parts(grid, lattice_, workers_), deviation * spacing_, grid, lattice_,
                       workers_);
}

/// Finds how far the surface may move at each node.
void EvenWater::leave_thin_water(const NodeValues& around, const Grid& grid) {
  may_move_ =
      largest_around(around, static_cast<int>(std::lround(thin_reach * spacing_)), grid, lattice_, workers_);
  workers_.for_each(lattice_.size(), 16, [&](std::size_t n) {
    const std::uint32_t b = lattice_.block(n);
    std::array<float, 8> sum{}, count{}, most{};
    for (int node = 0; node < nodes; ++node) {
      float& own = may_move_[n][std::size_t(node)];
      own = ramp(own, thin, thick) * free_to_move(grid, {b, node}, band_);
      const std::size_t cube = cube_of(node & 7, node >> 3 & 7, node >> 6);
      most[cube] = std::max(most[cube], own);
      if (!grid.is_inside({b, node})) continue;
      sum[cube] += own;
      ++count[cube];
    }
    for (std::size_t c = 0; c < 8; ++c) even_[n][c] *= count[c] > 0 ? sum[c] / count[c] : most[c];
  });
}

/// Cubes that enclose more than their water and have no obstacle near. The others do not count: films are
/// thicker on the grid than their water.
void EvenWater::find_free_cubes(const Cubes& in_cubes, const Grid& grid) {
  even_ = lattice_.zeros();
  water_in_cubes_ = in_cubes;
  is_free_.assign(lattice_.size(), {});
  enclosed_ = even_;
  const NodeValues parts = inside_parts(grid, lattice_, workers_);
  workers_.for_each(lattice_.size(), 16, [&](std::size_t n) {
    const std::uint32_t b = lattice_.block(n);
    is_free_[n].fill(1);
    for (int node = 0; node < nodes; ++node) {
      const std::size_t cube = cube_of(node & 7, node >> 3 & 7, node >> 6);
      enclosed_[n][cube] += parts[n][std::size_t(node)];
      if (free_to_move(grid, {b, node}, band_) < 1) is_free_[n][cube] = 0;
    }
    for (std::size_t c = 0; c < 8; ++c) {
      enclosed_[n][c] *= is_free_[n][c];
      water_in_cubes_[n][c] *= is_free_[n][c];
    }
  });
  Cubes water = water_in_cubes_, enclosed = enclosed_;
  for (Cubes* values : {&water, &enclosed}) lattice_.smooth(*values, 4, workers_);
  for (std::size_t n = 0; n < lattice_.size(); ++n)
    for (std::size_t c = 0; c < 8; ++c) {
      const float all = enclosed[n][c];
      if (is_free_[n][c] && all > water[n][c])
        even_[n][c] = ramp(all / float(cube_side * cube_side * cube_side), hardly_any, some) *
                      ramp(1 - water[n][c] / all, small_excess, whole_excess);
    }
}

void EvenWater::find_pieces(const Grid& grid) {
  DisjointSets sets(lattice_.size());
  for (std::uint32_t n = 0; n < lattice_.size(); ++n)
    for (const std::uint32_t above : grid.blocks[lattice_.block(n)].plus)
      if (const std::uint32_t other = lattice_.place(above); other != none && is_even(n) && is_even(other))
        sets.unite(n, other);
  piece_.assign(lattice_.size(), none);
  for (std::uint32_t n = 0; n < lattice_.size(); ++n) {
    if (!is_even(n)) continue;
    const std::uint32_t first = sets.find(n);
    if (first == n) {
      piece_[n] = static_cast<std::uint32_t>(pieces_++);
      water_.push_back(0);
    }
    piece_[n] = piece_[first];
    for (std::size_t c = 0; c < 8; ++c)
      water_[piece_[n]] +=
          double(even_[n][c] * (enclosed_[n][c] + even_[n][c] * (water_in_cubes_[n][c] - enclosed_[n][c])));
  }
}

template <std::size_t bins, class F>
std::vector<std::array<double, bins>> EvenWater::sums_of_pieces(const Grid& grid, const F& f) const {
  std::vector<std::array<double, bins>> own(lattice_.size());
  workers_.for_each(lattice_.size(), 16, [&](std::size_t n) {
    own[n].fill(0);
    const std::uint32_t b = lattice_.block(n);
    if (piece_[n] == none) return;
    const auto bin_of = f(n, b);
    for (int node = 0; node < nodes; ++node)
      if (grid.is_inside({b, node}))
        own[n][bin_of(node)] += double(even_[n][cube_of(node & 7, node >> 3 & 7, node >> 6)]);
  });
  std::vector<std::array<double, bins>> sums(pieces_);
  for (auto& sum : sums) sum.fill(0);
  for (std::size_t n = 0; n < own.size(); ++n)
    for (std::size_t k = 0; piece_[n] != none && k < bins; ++k) sums[piece_[n]][k] += own[n][k];
  return sums;
}

/// The part of the least shares with which a piece encloses its water, 1 at most: cubes at its surface know
/// nothing of what lies farther in and lack more than all together.
std::vector<float> EvenWater::shares_of_pieces(const NodeValues& around, const Cubes& least,
                                               const Grid& grid) const {
  constexpr std::size_t bins = 64;
  const auto sums = sums_of_pieces<bins + 1>(grid, [&](std::size_t n, std::uint32_t block) {
    return [&, n, at = LeastShare(lattice_, least, block, may_move_[n])](int node) {
      const float most = at.at(node), own = around[n][std::size_t(node)];
      return own >= most ? bins : std::size_t(own / most * float(bins));
    };
  });
  std::vector<float> result(pieces_, 1);
  for (std::size_t piece = 0; piece < pieces_; ++piece) {
    double enclosed = sums[piece][bins];
    for (std::size_t k = bins; enclosed < water_[piece] && k-- > 0;) {
      const double more = sums[piece][k];
      const double part = more > 0 ? std::min(1.0, (water_[piece] - enclosed) / more) : 1;
      result[piece] = (float(k + 1) - float(part)) / float(bins);
      enclosed += more;
    }
  }
  return result;
}

DrawnIn EvenWater::draw_in(Grid& grid) {
  NodeValues around = shares_around(grid);
  leave_thin_water(around, grid);
  find_pieces(grid);
  Cubes water = water_in_cubes_;
  lattice_.smooth(water, 2, workers_);
  DrawnIn result;
  result.even.assign(grid.blocks.size(), {});
  for (std::size_t n = 0; n < lattice_.size(); ++n) result.even[lattice_.block(n)] = even_[n];
  result.moves.assign(particles_.size(), {});
  std::vector<std::uint8_t> chosen(pieces_, 1);
  for (int round = 0; round < rounds; ++round) {
    Cubes least;
    if (round == 0) {
      least = shares_of_cubes(count_enclosed(grid, lattice_, is_free_, around, workers_), water, even_,
                              lattice_, workers_);
    } else {
      around = shares_around(grid);
      // Cubes at the surface enclose no more than their water now: what is left is farther in.
      least = even_;
      for (std::array<float, 8>& own : least)
        for (float& share : own) share *= shares.back();
    }
    const std::vector<float> part = shares_of_pieces(around, least, grid);
    for (std::size_t n = 0; n < lattice_.size(); ++n)
      for (float& share : least[n]) share *= piece_[n] == none || !chosen[piece_[n]] ? 0 : part[piece_[n]];
    const Choice choice = choose_nodes(around, least, grid);
    leave_out_nodes(around, least, choice, grid);
    move_particles(around, choice.leave, grid, result.moves);
    const std::vector<double> enclosed = enclosed_by_pieces(grid);
    for (std::size_t piece = 0; piece < pieces_; ++piece)
      chosen[piece] = enclosed[piece] > (1 + too_much) * water_[piece];
    if (std::find(chosen.begin(), chosen.end(), 1) == chosen.end()) break;
  }
  return result;
}

std::vector<double> EvenWater::enclosed_by_pieces(const Grid& grid) const {
  const auto sums =
      sums_of_pieces<1>(grid, [](std::size_t, std::uint32_t) { return [](int) { return std::size_t{0}; }; });
  std::vector<double> result(pieces_);
  for (std::size_t piece = 0; piece < pieces_; ++piece) result[piece] = sums[piece][0];
  return result;
}

/// Calls f(place, field, node, least share) for the nodes where the surface may move.
template <class F>
void EvenWater::for_free_nodes(const Cubes& least, const Grid& grid, const F& f) const {
  workers_.for_each(lattice_.size(), 16, [&](std::size_t n) {
    const std::uint32_t b = lattice_.block(n), field = grid.blocks[b].field;
    if (field == none) return;
    const LeastShare at(lattice_, least, b, may_move_[n]);
    if (at.is_zero()) return;
    for (int node = 0; node < nodes; ++node)
      if (const float share = at.at(node); share > 0) f(n, field, node, share);
  });
}

/// The nodes inside that have less than the least shares and are connected to others that stay; and these.
EvenWater::Choice EvenWater::choose_nodes(const NodeValues& around, const Cubes& least,
                                          const Grid& grid) const {
  std::vector<NodeBits> stay(lattice_.size());
  for (std::size_t n = 0; n < stay.size(); ++n)
    for (int k = 0; k < side; ++k) stay[n][std::size_t(k)] = grid.slice(lattice_.block(n), k);
  Choice choice{std::vector<NodeBits>(lattice_.size(), NodeBits{}), stay};
  for_free_nodes(least, grid, [&](std::size_t n, std::uint32_t, int node, float share) {
    const auto k = std::size_t(node >> 6);
    const std::uint64_t bit = stay[n][k] & 1ull << (node & 63);
    const float own = around[n][std::size_t(node)];
    if (own < share) choice.leave[n][k] |= bit;
    if (own < std::max(share, of_crumb)) choice.stay[n][k] &= ~bit;
  });
  for_words([&](std::size_t n, std::size_t k) { stay[n][k] &= ~choice.leave[n][k]; });
  grow(stay, grid, choice.stay);
  // Crumbs leave, too.
  for_words([&](std::size_t n, std::size_t k) { choice.leave[n][k] |= stay[n][k] & ~choice.stay[n][k]; });
  std::vector<NodeBits> all = choice.leave, connected = choice.stay;
  for_words([&](std::size_t n, std::size_t k) { all[n][k] |= choice.stay[n][k]; });
  grow(all, grid, connected);
  for_words([&](std::size_t n, std::size_t k) { choice.leave[n][k] &= connected[n][k]; });
  return choice;
}

/// Puts the nodes that leave outside. Other pieces, which are not connected to what stays, keep their values.
void EvenWater::leave_out_nodes(const NodeValues& around, const Cubes& least, const Choice& choice,
                                Grid& grid) const {
  // Below a plane; the logistic function is near to the integral of a Gaussian.
  const auto depth = [&](float share) {
    const float within = std::clamp(share, 1e-6f, 1 - 1e-6f);
    return static_cast<float>(deviation * spacing_ / 1.702) * std::log(within / (1 - within));
  };
  for_free_nodes(least, grid, [&](std::size_t n, std::uint32_t field, int node, float share) {
    const auto k = std::size_t(node >> 6);
    const std::uint64_t bit = 1ull << (node & 63);
    const bool leaves = choice.leave[n][k] & bit, stays = choice.stay[n][k] & bit;
    if (!leaves && !stays && (grid.inside_bits[field][k] & bit)) return;
    const float to = std::min(depth(share) - depth(around[n][std::size_t(node)]), grid.outside);
    float& value = grid.values[std::size_t(field) * nodes + std::size_t(node)];
    value = std::max(value, leaves ? std::max(to, just_outside) : to);
  });
  workers_.for_each(lattice_.size(), 16, [&](std::size_t n) {
    const std::uint32_t field = grid.blocks[lattice_.block(n)].field;
    if (field != none) grid.find_inside(field);
  });
}

/// Adds the nodes of the region that a path in it connects to one of `grown`.
void EvenWater::grow(const std::vector<NodeBits>& region, const Grid& grid,
                     std::vector<NodeBits>& grown) const {
  const std::vector<std::array<std::uint32_t, 6>> neighbours = neighbours_of(grid);
  for (bool changes = true; changes;) {
    const std::vector<NodeBits> before = grown;
    const auto slice = [&](std::uint32_t block, int k) {
      const std::uint32_t place = lattice_.place(block);
      return place == none ? grid.slice(block, k) : before[place][std::size_t(k)];
    };
    std::vector<std::uint8_t> changed(lattice_.size(), 0);
    workers_.for_each(lattice_.size(), 64, [&](std::size_t n) {
      const std::uint32_t b = lattice_.block(n);
      for (int k = 0; k < side; ++k) {
        std::uint64_t& own = grown[n][std::size_t(k)];
        const std::uint64_t missing = region[n][std::size_t(k)] & ~own;
        if (missing == 0) continue;
        std::uint64_t connected = 0;
        for (const std::uint64_t beside : bits_beside(b, neighbours[b], k, slice)) connected |= beside;
        changed[n] |= (missing & connected) != 0;
        own |= missing & connected;
      }
    });
    changes = std::find(changed.begin(), changed.end(), 1) != changed.end();
  }
}

/// Those next to nodes that were left out, up the slope of the shares, until a node inside is next to them.
void EvenWater::move_particles(const NodeValues& around, const std::vector<NodeBits>& left_out,
                               const Grid& grid, std::vector<std::array<float, 3>>& moves) const {
  const auto nearest = [](const Vec3& x) {
    return Int3{int(std::lround(x.x())), int(std::lround(x.y())), int(std::lround(x.z()))};
  };
  const auto share_at = [&](const Int3& at) {
    const NodeRef node = grid.node_at(at);
    const std::uint32_t place = lattice_.place(node.block);
    if (place != none) return around[place][std::size_t(node.node)];
    return node.block != none && grid.blocks[node.block].solid ? 1.0f : 0.0f;
  };
  const auto is_left_out = [&](const Vec3& x) {
    const Int3 cell{int(std::floor(x.x())), int(std::floor(x.y())), int(std::floor(x.z()))};
    for (int c = 0; c < 8; ++c) {
      const NodeRef node = grid.node_at(cell + Int3{c & 1, c >> 1 & 1, c >> 2});
      const std::uint32_t place = lattice_.place(node.block);
      if (place != none && left_out[place][std::size_t(node.node >> 6)] >> (node.node & 63) & 1) return true;
    }
    return false;
  };
  const int most_steps = static_cast<int>(std::ceil(most_drawn_in * spacing_));
  workers_.for_each(lattice_.size(), 16, [&](std::size_t n) {
    const Int3& block = grid.blocks[lattice_.block(n)].at;
    const std::uint32_t b = particles_.index.find(key_of(block));
    if (b == none) return;
    for (std::size_t p = particles_.begin[b]; p < particles_.begin[b + 1]; ++p) {
      const Vec3 start = particles_.place(b, p) + vec(moves[p]);
      if (!is_left_out(start)) continue;
      Vec3 x = start;
      for (int step = 0; step < most_steps && !grid.is_inside(grid.node_at(nearest(x))); ++step) {
        const Int3 at = nearest(x);
        const Vec3 slope(share_at(at + Int3{1, 0, 0}) - share_at(at + Int3{-1, 0, 0}),
                         share_at(at + Int3{0, 1, 0}) - share_at(at + Int3{0, -1, 0}),
                         share_at(at + Int3{0, 0, 1}) - share_at(at + Int3{0, 0, -1}));
        if (!(slope.norm() > 0)) break;
        x += slope.normalized();
      }
      if (!grid.is_inside(grid.node_at(nearest(x)))) continue;
      const Vec3 move = x - particles_.place(b, p);
      moves[p] = {float(move.x()), float(move.y()), float(move.z())};
    }
  });
}

void EvenWater::share_out(const Cubes& enclosed, const CubeLattice& lattice, const Grid& grid,
                          Cubes& in_cubes) const {
  const std::vector<double> all = enclosed_by_pieces(grid);
  for (std::size_t own = 0; own < lattice_.size(); ++own) {
    const std::uint32_t n = lattice.place(lattice_.block(own));
    if (n == none || piece_[own] == none || !(all[piece_[own]] > 0)) continue;
    const auto share = static_cast<float>(std::min(1.0, water_[piece_[own]] / all[piece_[own]]));
    for (std::size_t c = 0; c < 8; ++c)
      in_cubes[n][c] += even_[own][c] * std::max(0.0f, share * enclosed[n][c] - in_cubes[n][c]);
  }
}

}  // namespace oilskin::reconstruction
