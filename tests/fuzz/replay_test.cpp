// Runs a fuzz target without libFuzzer: on its seeds, on mutations of them, on the inputs of its folder
// (OILSKIN_REGRESSIONS: those that once broke it, and those of kinds that break readers), and on the files
// given. `--write-seeds FOLDER` writes the seeds for the fuzzer.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <limits>

#include "fuzz/fuzz_target.h"
#include "support/random.h"

namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::uint8_t>;

std::vector<std::string> files_given;

Bytes read(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return Bytes(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
}

void run(const Bytes& input) {
  LLVMFuzzerTestOneInput(input.data(), input.size());
}

TEST(Replay, seeds_and_their_mutations) {
  const std::vector<Bytes> seeds = oilskin::fuzz::seeds();
  ASSERT_FALSE(seeds.empty());
  run({});
  oilskin::test::Random random(1);
  for (const Bytes& seed : seeds) {
    run(seed);
    for (int round = 0; round < OILSKIN_MUTATIONS; ++round) {
      Bytes mutated = seed;
      for (std::uint32_t k = 0; k < 1 + random.below(4) && !mutated.empty(); ++k)
        mutated[random.below(static_cast<std::uint32_t>(mutated.size()))] =
            static_cast<std::uint8_t>(random.bits());
      if (random.uniform() < 0.1)
        mutated.resize(random.below(static_cast<std::uint32_t>(mutated.size() + 1)));
      run(mutated);
    }
  }
}

#ifdef OILSKIN_BINARY_INPUT
// Counts, indices, flags and numbers of any place in the input.
TEST(Replay, every_word_of_the_shortest_seed_with_extreme_values) {
  const std::vector<Bytes> seeds = oilskin::fuzz::seeds();
  const Bytes seed = *std::min_element(seeds.begin(), seeds.end(),
                                       [](const Bytes& a, const Bytes& b) { return a.size() < b.size(); });
  ASSERT_GT(seed.size(), 64u);
  constexpr double infinity = std::numeric_limits<double>::infinity();
  for (std::size_t at = 0; at + 8 <= seed.size(); at += 4)
    for (double value : {0.0, -1.0, 1e308, -infinity, std::nan("")}) {
      Bytes mutated = seed;
      std::memcpy(mutated.data() + at, &value, 8);
      run(mutated);
    }
  for (std::size_t at = 0; at + 8 <= seed.size(); at += 4)
    for (std::uint64_t value : {~std::uint64_t{0}, std::uint64_t{1} << 60, std::uint64_t{1} << 31}) {
      Bytes mutated = seed;
      std::memcpy(mutated.data() + at, &value, 8);
      run(mutated);
    }
}
#endif

TEST(Replay, inputs_that_break_readers) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(OILSKIN_REGRESSIONS)) files.push_back(entry.path());
  ASSERT_FALSE(files.empty()) << OILSKIN_REGRESSIONS;
  std::sort(files.begin(), files.end());
  files.insert(files.end(), files_given.begin(), files_given.end());
  for (const fs::path& file : files) {
    std::cout << file.string() << std::endl;  // before it ends the program
    const Bytes input = read(file);
    ASSERT_FALSE(input.empty()) << file;
    run(input);
  }
}

int write_seeds(const fs::path& folder) {
  fs::create_directories(folder);
  int number = 0;
  for (const Bytes& seed : oilskin::fuzz::seeds())
    std::ofstream(folder / ("seed" + std::to_string(number++)), std::ios::binary)
        .write(reinterpret_cast<const char*>(seed.data()), static_cast<std::streamsize>(seed.size()));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  if (argc == 3 && std::string(argv[1]) == "--write-seeds") return write_seeds(argv[2]);
  files_given.assign(argv + 1, argv + argc);
  return RUN_ALL_TESTS();
}
