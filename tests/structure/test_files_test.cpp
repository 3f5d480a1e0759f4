// Names and lengths of the test sources.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <string>
#include <utility>
#include <vector>

namespace {

namespace fs = std::filesystem;

constexpr long max_lines = 400;

std::string text_of(const fs::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::vector<fs::path> test_sources() {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(OILSKIN_ROOT) / "tests")) {
    const std::string suffix = entry.path().extension().string();
    if (suffix == ".cpp" || suffix == ".h") files.push_back(entry.path());
  }
  return files;
}

/// Suite and name of every test that a source defines.
std::vector<std::pair<std::string, std::string>> tests_of(const std::string& source) {
  static const std::regex macro(R"(\bTEST(?:_F|_P)?\(\s*(\w+),\s*(\w+)\s*\))"
                                R"(|\bTYPED_TEST(?:_P)?\(\s*(\w+),\s*(\w+)\s*\))");
  std::vector<std::pair<std::string, std::string>> tests;
  for (std::sregex_iterator it(source.begin(), source.end(), macro), end; it != end; ++it)
    tests.emplace_back((*it)[1].str() + (*it)[3].str(), (*it)[2].str() + (*it)[4].str());
  return tests;
}

/// Suite in PascalCase, test in snake_case.
bool is_in_style(const std::string& suite, const std::string& name) {
  static const std::regex pascal("[A-Z][A-Za-z0-9]*"), snake("[a-z][a-z0-9]*(_[a-z0-9]+)*");
  return std::regex_match(suite, pascal) && std::regex_match(name, snake);
}

TEST(TestSources, suites_are_in_pascal_case_and_tests_in_snake_case) {
  std::size_t count = 0;
  for (const fs::path& file : test_sources())
    for (const auto& [suite, name] : tests_of(text_of(file))) {
      ++count;
      EXPECT_TRUE(is_in_style(suite, name)) << file.filename() << ": " << suite << "." << name;
    }
  EXPECT_GT(count, 400u);
}

TEST(TestSources, other_styles_are_found) {
  const std::string test = "TEST";  // apart, so that this file holds no such test
  const auto tests =
      tests_of(test + "(Suite, camelCase) {\nTYPED_" + test + "_P(\n    Other,\n    snake_case) {\n");
  ASSERT_EQ(tests.size(), 2u);
  EXPECT_FALSE(is_in_style(tests[0].first, tests[0].second));
  EXPECT_TRUE(is_in_style(tests[1].first, tests[1].second));
  EXPECT_FALSE(is_in_style("Suite", "PascalCase"));
  EXPECT_FALSE(is_in_style("suite", "snake_case"));
  EXPECT_FALSE(is_in_style("Suite", "double__underscore"));
}

TEST(TestSources, files_have_at_most_400_lines) {
  for (const fs::path& file : test_sources()) {
    const std::string text = text_of(file);
    EXPECT_LE(std::count(text.begin(), text.end(), '\n'), max_lines) << file;
  }
}

}  // namespace
