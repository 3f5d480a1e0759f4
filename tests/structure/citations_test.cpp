// What comments and documents cite exists in docs/theory: equations, a letter of the page and a number in
// parentheses, and references, an author and a year in brackets.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

/// The page that numbers its equations with a letter.
const std::map<char, std::string> page_of = {
    {'F', "fluid.md"},           {'B', "boundary.md"},          {'C', "contact.md"},
    {'T', "continuous_test.md"}, {'R', "reconstruction.md"},    {'G', "effects_forces.md"},
    {'S', "effects_tension.md"}, {'V', "effects_viscosity.md"}, {'W', "effects_wetting.md"}};

std::vector<std::string> lines_of(const fs::path& file) {
  std::ifstream in(file);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

void add_matches(const std::string& text, const std::regex& pattern, std::set<std::string>& found) {
  for (std::sregex_iterator it(text.begin(), text.end(), pattern), end; it != end; ++it)
    found.insert((*it)[1]);
}

/// Numbers of equations within parentheses, ends of a range included, and keys of references within brackets.
std::set<std::string> cited_in(const std::string& line) {
  static const std::regex parentheses("(\\([FBCGTRSVW]\\.[0-9][^()]*\\))");
  static const std::regex brackets("(\\[[A-Z][A-Za-z]+[0-9]{4}[a-z]?([,;][^\\]]*)?\\])");
  static const std::regex number("\\b([FBCGTRSVW]\\.[0-9]+)");
  static const std::regex key("\\b([A-Z][A-Za-z]+[0-9]{4}[a-z]?)\\b");
  std::set<std::string> groups, found;
  add_matches(line, parentheses, groups);
  for (const std::string& group : groups) add_matches(group, number, found);
  groups.clear();
  add_matches(line, brackets, groups);
  for (const std::string& group : groups) add_matches(group, key, found);
  return found;
}

/// How often each number and key is defined. An equation of its letter's page ends its line with the number,
/// set off by blanks or \qquad; a reference begins a line of references.md.
std::map<std::string, int> defined_in(const fs::path& theory) {
  static const std::regex number("(?:  |quad ?)\\(([FBCGTRSVW]\\.[0-9]+)\\)[$`\\s]*$");
  static const std::regex key("^[^A-Za-z]*([A-Z][A-Za-z]+[0-9]{4}[a-z]?)\\b.*");
  std::map<std::string, int> found;
  std::smatch match;
  for (const auto& [letter, page] : page_of)
    for (const std::string& line : lines_of(theory / page))
      if (std::regex_search(line, match, number) && match.str(1)[0] == letter) ++found[match[1]];
  for (const std::string& line : lines_of(theory / "references.md"))
    if (std::regex_match(line, match, key)) ++found[match[1]];
  return found;
}

/// The sources and pages that may cite.
std::vector<fs::path> citing_files(const fs::path& root) {
  std::vector<fs::path> files;
  for (const char* top : {"src", "bullet_adapter", "demos", "tests", "docs"}) {
    if (!fs::exists(root / top)) continue;
    for (const auto& entry : fs::recursive_directory_iterator(root / top)) {
      const std::string suffix = entry.path().extension().string();
      if (suffix == ".h" || suffix == ".cpp" || suffix == ".md") files.push_back(entry.path());
    }
  }
  return files;
}

/// One line for each citation of something that docs/theory does not define.
std::vector<std::string> dangling_citations(const fs::path& root) {
  const std::map<std::string, int> defined = defined_in(root / "docs/theory");
  std::vector<std::string> found;
  for (const fs::path& file : citing_files(root)) {
    int number = 0;
    for (const std::string& line : lines_of(file)) {
      ++number;
      for (const std::string& what : cited_in(line))
        if (defined.count(what) == 0)
          found.push_back(fs::relative(file, root).generic_string() + ":" + std::to_string(number) +
                          ": docs/theory does not define " + what);
    }
  }
  return found;
}

TEST(Citations, equations_and_references_exist) {
  for (const std::string& fault : dangling_citations(OILSKIN_ROOT)) ADD_FAILURE() << fault;
}

TEST(Citations, each_number_and_key_is_defined_once_and_numbers_run_from_one) {
  std::map<char, std::set<int>> numbers;
  for (const auto& [what, times] : defined_in(fs::path(OILSKIN_ROOT) / "docs/theory")) {
    EXPECT_EQ(times, 1) << what;
    if (what[1] == '.') numbers[what[0]].insert(std::stoi(what.substr(2)));
  }
  for (const auto& [letter, page] : page_of) {
    ASSERT_FALSE(numbers[letter].empty()) << "no numbered equation in docs/theory/" << page;
    EXPECT_EQ(*numbers[letter].begin(), 1) << page;
    EXPECT_EQ(*numbers[letter].rbegin(), static_cast<int>(numbers[letter].size())) << page;
  }
}

// Written apart, so that this file itself cites nothing.
std::string number(const std::string& inner) {
  return "(" + inner + ")";
}
std::string key(const std::string& inner) {
  return "[" + inner + "]";
}

/// Faults of a tree with two equations and one reference, `line` in a source file and `sentence` in the page.
std::size_t faults_with(const std::string& line, const std::string& sentence = "") {
  std::string name = (fs::temp_directory_path() / "oilskin-citations-XXXXXX").string();
  const fs::path root = mkdtemp(name.data());
  fs::create_directories(root / "docs/theory");
  fs::create_directories(root / "src/fluid");
  std::ofstream(root / "docs/theory/fluid.md")
      << "p = k ρ     " << number("F.1") << "\n$$q = 1 \\qquad " << number("F.2") << "$$\n"
      << sentence << "\n";
  std::ofstream(root / "docs/theory/references.md")
      << "- **" << key("Author2015") << "** A. Author. A title.\n";
  std::ofstream(root / "src/fluid/a.cpp") << "// " << line << "\n";
  const std::size_t count = dangling_citations(root).size();
  fs::remove_all(root);
  return count;
}

TEST(Citations, the_test_itself_catches_what_does_not_exist) {
  EXPECT_EQ(faults_with(number("F.3")), 1u);
  EXPECT_EQ(faults_with(number("F.1–F.4")), 1u);
  EXPECT_EQ(faults_with("as " + number("F.3, R.1") + " says"), 2u);
  EXPECT_EQ(faults_with(key("Author2016")), 1u);
  EXPECT_EQ(faults_with(key("Author2015; Other2016, Alg. 3")), 1u);
  EXPECT_EQ(faults_with("", "A sentence that ends with " + number("F.3")), 1u);
  EXPECT_EQ(faults_with("", "x = 1    " + number("B.1")), 1u);
}

TEST(Citations, the_test_itself_lets_pass_what_exists) {
  EXPECT_EQ(faults_with(number("F.1") + " and " + number("F.1–F.2") + ", " + key("Author2015, Alg. 3")), 0u);
  EXPECT_EQ(faults_with("", "x = 1    " + number("F.3")), 0u);
  EXPECT_EQ(faults_with("int x[Count]; f(F, 1);"), 0u);
}

}  // namespace
