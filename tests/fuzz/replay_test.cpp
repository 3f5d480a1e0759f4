// Runs a fuzz target without libFuzzer: on its seeds, on simple mutations of them, on files that once broke
// it (OILSKIN_REGRESSIONS), and on the files given. `--write-seeds FOLDER` writes the seeds for the fuzzer.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>

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

TEST(Replay, files_that_once_broke_it) {
  std::vector<fs::path> files;
  if (fs::exists(OILSKIN_REGRESSIONS))
    for (const auto& entry : fs::directory_iterator(OILSKIN_REGRESSIONS)) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  files.insert(files.end(), files_given.begin(), files_given.end());
  for (const fs::path& file : files) {
    std::cout << file.string() << std::endl;
    run(read(file));
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
