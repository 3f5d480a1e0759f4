// Neighbour lists of a shaken lattice of n³ points with about 37 neighbours, whose points move between the
// rounds: sort into cells, new order of the positions, lists. Prints millions of points per second for every
// instruction set that this machine has, the best and the median of the rounds.
//
// With cmake -DOILSKIN_TREENSEARCH=FOLDER, the sources of TreeNSearch
// (https://github.com/InteractiveComputerGraphics/TreeNSearch, not part of this project), it does the same
// with the same points. Its lists come first, since its order of the points follows from them.
//
// use: neighbours_benchmark [n = 50] [threads = 2] [rounds = 30]
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>

#include "fluid/neighbours.h"
#include "fluid/particles.h"
#include "fluid/random.h"
#ifdef OILSKIN_TREENSEARCH
#include <TreeNSearch>
#endif

using namespace oilskin;

namespace {

constexpr double support_ratio = 2.15443469;  // as in dam_benchmark

fluid::Particles shaken_lattice(int n) {
  fluid::Particles particles;
  std::uint64_t k = 0;
  const auto jitter = [&] { return 0.5 * fluid::random_unit(1, k++) - 0.25; };
  for (int a = 0; a < n; ++a)
    for (int b = 0; b < n; ++b)
      for (int c = 0; c < n; ++c) {
        const Vec3 x = Vec3(a + jitter(), b + jitter(), c + jitter()) / n;
        particles.push_back(particles.size() + 1, x, Vec3(jitter(), jitter(), jitter()), 1000);
      }
  return particles;
}

struct Seconds {
  std::vector<double> sort, lists, all;
  double neighbours = 0;  // of a point, in the last round
};

double since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

void move(int n, fluid::Particles& particles) {
  for (std::size_t i = 0; i < particles.size(); ++i)
    particles.position[i] += 0.05 / n * particles.velocity[i];
}

Seconds measure(int n, const Workers& workers, int rounds) {
  fluid::Particles particles = shaken_lattice(n);
  fluid::Particles::Scratch scratch;
  fluid::Neighbours neighbours;
  Seconds seconds;
  for (int round = 0; round < rounds; ++round) {
    move(n, particles);
    const auto begin = std::chrono::steady_clock::now();
    particles.permute(neighbours.cell_order(particles.position, support_ratio / n, workers), workers,
                      scratch);
    const double sorted = since(begin);
    neighbours.search(particles.position, workers);
    seconds.sort.push_back(sorted);
    seconds.all.push_back(since(begin));
    seconds.lists.push_back(seconds.all.back() - sorted);
  }
  for (std::size_t i = 0; i < particles.size(); ++i) seconds.neighbours += neighbours.count(i);
  seconds.neighbours /= static_cast<double>(particles.size());
  return seconds;
}

#ifdef OILSKIN_TREENSEARCH
Seconds measure_treensearch(int n, const Workers& workers, int rounds) {
  fluid::Particles particles = shaken_lattice(n);
  // It works with floats. Of the arrays that permute() orders, it orders places, velocities and numbers.
  std::vector<std::array<float, 3>> position(particles.size());
  tns::TreeNSearch search;
  search.set_n_threads(workers.threads());
  search.set_search_radius(static_cast<float>(support_ratio / n));
  const int set = search.add_point_set(position[0].data(), static_cast<int>(particles.size()));
  search.set_active_search(set, set);
  Seconds seconds;
  for (int round = 0; round < rounds; ++round) {
    move(n, particles);
    for (std::size_t i = 0; i < particles.size(); ++i)
      for (int k = 0; k < 3; ++k) position[i][static_cast<std::size_t>(k)] = float(particles.position[i][k]);
    const auto begin = std::chrono::steady_clock::now();
    search.run();
    seconds.lists.push_back(since(begin));
    if (round + 1 == rounds) break;
    search.prepare_zsort();
    search.apply_zsort(set, particles.position[0].data(), 3);
    search.apply_zsort(set, particles.velocity[0].data(), 3);
    search.apply_zsort(set, particles.id.data(), 1);
    seconds.all.push_back(since(begin));
    seconds.sort.push_back(seconds.all.back() - seconds.lists.back());
  }
  for (std::size_t i = 0; i < particles.size(); ++i)
    seconds.neighbours += search.get_neighborlist(set, set, static_cast<int>(i)).size();
  seconds.neighbours /= static_cast<double>(particles.size());
  return seconds;
}
#endif

void print(const char* name, std::size_t points, std::vector<double> seconds) {
  if (seconds.empty()) return;
  std::sort(seconds.begin(), seconds.end());
  const double millions = 1e-6 * static_cast<double>(points);
  std::printf("  %-9s %6.2f ms best, %6.2f ms median: %5.1f, %5.1f Mpt/s\n", name, 1e3 * seconds.front(),
              1e3 * seconds[seconds.size() / 2], millions / seconds.front(),
              millions / seconds[seconds.size() / 2]);
}

void print(std::size_t points, const Seconds& seconds) {
  print("sort", points, seconds.sort);
  print("lists", points, seconds.lists);
  print("both", points, seconds.all);
  std::printf("  %.2f neighbours\n", seconds.neighbours);
}

}  // namespace

int main(int argc, char** argv) {
  const int n = argc > 1 ? std::atoi(argv[1]) : 50;
  const int threads = argc > 2 ? std::atoi(argv[2]) : 2;
  const int rounds = argc > 3 ? std::atoi(argv[3]) : 30;
  if (n < 1 || n > 500 || rounds < 1) return 2;
  const Workers workers(threads);
  const std::size_t points =
      static_cast<std::size_t>(n) * static_cast<std::size_t>(n) * static_cast<std::size_t>(n);
  const char* names[] = {"baseline", "AVX2", "AVX-512"};
  for (const fluid::InstructionSet set : fluid::all_instruction_sets) {
    if (!fluid::is_available(set)) continue;
    fluid::use(set);
    const Seconds seconds = measure(n, workers, rounds);
    std::printf("%zu points, %d threads, %s\n", points, workers.threads(), names[static_cast<int>(set)]);
    print(points, seconds);
  }
#ifdef OILSKIN_TREENSEARCH
  std::printf("TreeNSearch\n");
  print(points, measure_treensearch(n, workers, rounds));
#endif
  return 0;
}
