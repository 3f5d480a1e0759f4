// Neighbour lists of a shaken lattice of n³ points with about 37 neighbours, whose points move between the
// rounds: sort into cells, new order of the positions, lists. Prints millions of points per second for every
// instruction set that this machine has, the best and the median of the rounds.
//
// use: neighbours_benchmark [n = 50] [threads = 2] [rounds = 30]
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>

#include "fluid/emission/random.h"
#include "fluid/neighbours.h"
#include "fluid/particles.h"

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
};

double since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

Seconds measure(int n, const Workers& workers, int rounds) {
  fluid::Particles particles = shaken_lattice(n);
  fluid::Particles::Scratch scratch;
  fluid::Neighbours neighbours;
  Seconds seconds;
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t i = 0; i < particles.size(); ++i)
      particles.position[i] += 0.05 / n * particles.velocity[i];
    const auto begin = std::chrono::steady_clock::now();
    particles.permute(neighbours.cell_order(particles.position, support_ratio / n, workers), workers,
                      scratch);
    const double sorted = since(begin);
    neighbours.search(particles.position, workers);
    seconds.sort.push_back(sorted);
    seconds.all.push_back(since(begin));
    seconds.lists.push_back(seconds.all.back() - sorted);
  }
  return seconds;
}

void print(const char* name, std::size_t points, std::vector<double> seconds) {
  std::sort(seconds.begin(), seconds.end());
  const double millions = 1e-6 * static_cast<double>(points);
  std::printf("  %-9s %6.2f ms best, %6.2f ms median: %5.1f, %5.1f Mpt/s\n", name, 1e3 * seconds.front(),
              1e3 * seconds[seconds.size() / 2], millions / seconds.front(),
              millions / seconds[seconds.size() / 2]);
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
    print("sort", points, seconds.sort);
    print("lists", points, seconds.lists);
    print("both", points, seconds.all);
  }
  return 0;
}
