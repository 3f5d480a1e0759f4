// A module may include core and the modules before it, nothing else; Bullet, FCL, JSON, command-line and
// picture libraries stay where they belong. Reads the include lines.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

/// Which modules of src each module may include, apart from itself and the public headers. `world` is never
/// named: it sees all.
const std::map<std::string, std::set<std::string>> may_see = {
    {"src/oilskin", {}},
    {"src/core", {}},
    {"src/fluid", {"core"}},
    {"src/proximity", {"core"}},
    {"src/ccd", {"core"}},
    {"src/contact", {"core", "fluid", "proximity", "ccd"}},
    {"src/effects", {"core", "fluid"}},
    {"src/reconstruction", {"core", "proximity"}},
    {"src/world", {"core", "fluid", "proximity", "ccd", "contact", "reconstruction", "world"}},
    {"bullet_adapter", {"core"}},
};

/// The modules of src/fluid, which are one-way as well: each may see those named here and the headers at the
/// top of src/fluid. Of the files at the top only the solver sees the modules but `pairs`, and nobody there
/// sees the solver.
const std::map<std::string, std::set<std::string>> fluid_may_see = {
    {"src/fluid/emission", {"emission"}},
    {"src/fluid/boundary", {"boundary", "pairs"}},
    {"src/fluid/pressure", {"boundary", "pairs", "pressure"}},
    {"src/fluid/pairs", {"pairs"}},
    {"src/fluid", {"pairs"}},
};

const std::set<std::string> rooms = {"core",    "fluid",   "proximity",      "ccd",
                                     "contact", "effects", "reconstruction", "world"};

/// Which folders of demos/app each folder may include, apart from itself. The files of demos/app itself (main
/// and the commands) may include all, and no folder may include them.
const std::map<std::string, std::set<std::string>> app_may_see = {
    {"scene", {}},
    {"geometry", {}},
    {"hosts", {"scene"}},
    {"output", {"scene", "geometry", "hosts"}},
    {"checks", {"scene", "geometry", "hosts", "output"}},
    {"render", {"scene", "geometry", "output"}},
    {"view", {"scene", "geometry", "hosts", "output"}},
    {"run", {"scene", "hosts", "output", "checks", "render"}},
};

/// Which folders of demos/study each folder may include, apart from itself and those of demos/app. The files
/// of demos/study itself (the commands) may include all, and no folder may include them.
const std::map<std::string, std::set<std::string>> study_may_see = {
    {"cases", {}},
    {"comparators", {}},
    {"run", {"cases"}},
    {"tables", {"cases", "comparators", "run"}},
};

/// The internal headers of src that demos may include, each with its only user: what they offer is not part
/// of the public interface.
const std::map<std::string, std::string> internal_headers_of_demos = {
    {"ccd/point_triangle.h", "demos/app/ccd_command.h"},
    {"core/closest_point.h", "demos/app/geometry/nearest_surface.h"},
};

/// Libraries and the only places that may include them.
const std::vector<std::pair<std::vector<std::string>, std::vector<std::string>>> fenced = {
    {{"bullet/", "Bullet", "btBullet", "LinearMath/", "oilskin/bullet.h"},
     {"bullet_adapter/", "demos/app/hosts/bullet_", "demos/examples/", "demos/tools/bullet_ccd_compare.cpp"}},
    {{"fcl/"}, {"src/proximity/surface_tree.cpp"}},
    {{"tbb/", "oneapi/"}, {"src/core/parallel.cpp"}},
    {{"nlohmann/"}, {"demos/app/scene/fields.h"}},
    {{"CLI/"}, {"demos/app/main.cpp"}},
    {{"vtk"}, {"demos/app/render/"}},
    {{"GLFW/", "imgui", "backends/imgui", "GL/", "png.h"}, {"demos/app/view/"}},
    {{"tiny_gltf"}, {"demos/app/output/gltf_file.cpp"}},
    {{"openvdb/"}, {"demos/app/output/vdb_file.cpp"}},
};

bool begins(const std::string& text, const std::string& with) {
  return text.compare(0, with.size(), with) == 0;
}

/// What an #include line names; empty for other lines.
std::string included(const std::string& line) {
  const std::size_t hash = line.find_first_not_of(" \t");
  if (hash == std::string::npos || line[hash] != '#') return "";
  const std::size_t word = line.find_first_not_of(" \t", hash + 1);
  if (word == std::string::npos || line.compare(word, 7, "include") != 0) return "";
  const std::size_t open = line.find_first_of("<\"", word + 7);
  if (open == std::string::npos) return "";
  const std::size_t close = line.find_first_of(">\"", open + 1);
  return close == std::string::npos ? "" : line.substr(open + 1, close - open - 1);
}

std::string fault_of_room(const std::string& file, const std::string& target) {
  const std::string other = target.substr(0, target.find('/'));
  if (target.find('/') == std::string::npos || rooms.count(other) == 0) return "";
  for (const auto& [room, seen] : may_see) {
    if (!begins(file, room + "/")) continue;
    // Sources beside the public headers may use core; the headers may not.
    if (room == "src/oilskin" && other == "core" && fs::path(file).extension() == ".cpp") continue;
    const std::string own = fs::path(room).filename().string();
    if (other != own && seen.count(other) == 0)
      return file + " includes \"" + target + "\": " + room + " may not see " + other;
  }
  return "";
}

std::string fault_in_fluid(const std::string& file, const std::string& target) {
  const bool is_solver = begins(file, "src/fluid/fluid_solver.");
  if (!begins(file, "src/fluid/") || !begins(target, "fluid/") || is_solver) return "";
  const auto& seen = fluid_may_see.at(fs::path(file).parent_path().generic_string());
  const std::string module = fs::path(target).parent_path().filename().string();
  const bool at_top = module == "fluid" && target != "fluid/fluid_solver.h";
  return at_top || seen.count(module) > 0 ? "" : file + " may not include \"" + target + "\"";
}

/// No effect sees another: each folder of src/effects includes its own headers only.
std::string fault_in_effects(const std::string& file, const std::string& target) {
  if (!begins(file, "src/effects/") || !begins(target, "effects/")) return "";
  const bool is_own = fs::path("src") / fs::path(target).parent_path() == fs::path(file).parent_path();
  return is_own ? "" : file + " may not include \"" + target + "\"";
}

/// The first folder of a path; empty where there is none.
std::string first_folder(const std::string& path) {
  const std::size_t slash = path.find('/');
  return slash == std::string::npos ? "" : path.substr(0, slash);
}

bool is_quoted(const std::string& line) {
  return line.find('"') < line.find('<');
}

/// Demos use what everybody may use, but for the headers named above.
std::string fault_of_internal_header(const std::string& file, const std::string& target) {
  if (!begins(file, "demos/") || rooms.count(first_folder(target)) == 0) return "";
  const auto found = internal_headers_of_demos.find(target);
  if (found != internal_headers_of_demos.end() && found->second == file) return "";
  return file + " includes \"" + target + "\": demos may include public headers of src only";
}

std::string fault_of_app_folder(const std::string& file, const std::string& line, const std::string& target) {
  const std::string app = "demos/app/";
  if (!begins(file, app) || !is_quoted(line) || begins(target, "oilskin/")) return "";
  const std::string own = first_folder(file.substr(app.size())), other = first_folder(target);
  if (own.empty() || own == other) return "";
  const auto seen = app_may_see.find(own);
  if (seen == app_may_see.end()) return file + " lies in a folder that this test does not know";
  if (seen->second.count(other) > 0 || internal_headers_of_demos.count(target) > 0) return "";
  return file + " includes \"" + target + "\": " + own + " may not see it";
}

/// Headers of demos/study are named from there; `study/commit.h` is made by the build.
std::string fault_of_study_folder(const std::string& file, const std::string& target) {
  const std::string study = "demos/study/", include = "study/";
  if (begins(file, "demos/app/") && begins(target, include) && file != "demos/app/main.cpp")
    return file + " includes \"" + target + "\": the study lies above the program's folders";
  if (!begins(file, study) || !begins(target, include) || target == "study/commit.h") return "";
  const std::string own = first_folder(file.substr(study.size())),
                    other = first_folder(target.substr(include.size()));
  if (own.empty() || own == other) return "";
  const auto seen = study_may_see.find(own);
  if (seen == study_may_see.end()) return file + " lies in a folder that this test does not know";
  return seen->second.count(other) > 0 ? ""
                                       : file + " includes \"" + target + "\": " + own + " may not see it";
}

std::string fault_of_example(const std::string& file, const std::string& line, const std::string& target) {
  if (!begins(file, "demos/examples/") || !is_quoted(line) || begins(target, "oilskin/")) return "";
  return file + " includes \"" + target + "\": examples include public headers and Bullet's only";
}

std::string fault_of_library(const std::string& file, const std::string& target) {
  for (const auto& [prefixes, places] : fenced) {
    const bool named =
        std::any_of(prefixes.begin(), prefixes.end(), [&](const auto& p) { return begins(target, p); });
    const bool allowed =
        std::any_of(places.begin(), places.end(), [&](const auto& p) { return begins(file, p); });
    if (named && !allowed)
      return file + " includes <" + target + ">, which belongs to " + places.front() + " only";
  }
  return "";
}

/// Every forbidden include below `root`, one line each.
std::vector<std::string> faults(const fs::path& root) {
  std::vector<std::string> found;
  for (const char* top : {"src", "bullet_adapter", "demos"}) {
    if (!fs::exists(root / top)) continue;
    for (const auto& entry : fs::recursive_directory_iterator(root / top)) {
      const std::string suffix = entry.path().extension().string();
      if (suffix != ".h" && suffix != ".cpp") continue;
      const std::string file = fs::relative(entry.path(), root).generic_string();
      std::ifstream in(entry.path());
      for (std::string line; std::getline(in, line);) {
        const std::string target = included(line);
        if (target.empty()) continue;
        for (const std::string& fault :
             {fault_of_room(file, target), fault_in_fluid(file, target), fault_in_effects(file, target),
              fault_of_library(file, target), fault_of_internal_header(file, target),
              fault_of_app_folder(file, line, target), fault_of_study_folder(file, target),
              fault_of_example(file, line, target)})
          if (!fault.empty()) found.push_back(fault);
      }
    }
  }
  return found;
}

TEST(Structure, no_module_includes_what_it_may_not_see) {
  for (const std::string& fault : faults(OILSKIN_ROOT)) ADD_FAILURE() << fault;
}

/// A tree with one file that has one include line.
std::size_t faults_with(const std::string& file, const std::string& include) {
  std::string name = (fs::temp_directory_path() / "oilskin-structure-XXXXXX").string();
  const fs::path root = mkdtemp(name.data());
  fs::create_directories((root / file).parent_path());
  std::ofstream(root / file) << "// a comment\n" << include << "\n";
  const std::size_t count = faults(root).size();
  fs::remove_all(root);
  return count;
}

TEST(Structure, the_test_itself_catches_back_edges) {
  EXPECT_EQ(faults_with("src/core/a.h", "#include \"fluid/particles.h\""), 1u);
  EXPECT_EQ(faults_with("src/fluid/a.cpp", "#  include \"contact/contacts.h\""), 1u);
  EXPECT_EQ(faults_with("src/reconstruction/a.cpp", "#include \"contact/contacts.h\""), 1u);
  EXPECT_EQ(faults_with("src/contact/a.cpp", "#include \"world/world_impl.h\""), 1u);
  EXPECT_EQ(faults_with("src/oilskin/a.h", "#include \"core/parallel.h\""), 1u);
  EXPECT_EQ(faults_with("src/oilskin/a.cpp", "#include \"core/parallel.h\""), 0u);
  EXPECT_EQ(faults_with("src/oilskin/a.cpp", "#include \"contact/zones.h\""), 1u);
  EXPECT_EQ(faults_with("src/world/a.cpp", "#include <BulletSoftBody/btSoftBody.h>"), 1u);
  EXPECT_EQ(faults_with("src/contact/a.cpp", "#include <fcl/fcl.h>"), 1u);
  EXPECT_EQ(faults_with("src/fluid/a.cpp", "#include <tbb/parallel_for.h>"), 1u);
  EXPECT_EQ(faults_with("bullet_adapter/a.cpp", "#include <nlohmann/json.hpp>"), 1u);
  EXPECT_EQ(faults_with("src/fluid/boundary/a.cpp", "#include \"fluid/pressure/step_state.h\""), 1u);
  EXPECT_EQ(faults_with("src/fluid/pressure/a.cpp", "#include \"fluid/fluid_solver.h\""), 1u);
  EXPECT_EQ(faults_with("src/fluid/neighbours.h", "#include \"fluid/boundary/boundary.h\""), 1u);
  EXPECT_EQ(faults_with("src/fluid/pairs/a.h", "#include \"fluid/pressure/step_state.h\""), 1u);
  EXPECT_EQ(faults_with("src/effects/tension/a.cpp", "#include \"effects/viscosity/wall_drag.h\""), 1u);
}

TEST(Structure, the_test_itself_catches_back_edges_in_demos) {
  EXPECT_EQ(faults_with("demos/app/scene/a.h", "#include \"run/runner.h\""), 1u);
  EXPECT_EQ(faults_with("demos/app/scene/a.cpp", "#include \"output/water_mesh.h\""), 1u);
  EXPECT_EQ(faults_with("demos/app/render/a.cpp", "#include \"mesh_command.h\""), 1u);
  EXPECT_EQ(faults_with("demos/app/geometry/a.h", "#include \"scene/scene.h\""), 1u);
  EXPECT_EQ(faults_with("demos/app/hosts/a.cpp", "#include \"simulation.h\""), 1u) << "names no folder";
  EXPECT_EQ(faults_with("demos/app/other/a.cpp", "#include \"scene/scene.h\""), 1u);
  EXPECT_EQ(faults_with("demos/app/checks/a.cpp", "#include \"fluid/kernels.h\""), 2u)
      << "no folder, internal";
  EXPECT_EQ(faults_with("demos/app/a.cpp", "#include \"core/closest_point.h\""), 1u);
  EXPECT_EQ(faults_with("demos/app/a.cpp", "#include <btBulletDynamicsCommon.h>"), 1u);
  EXPECT_EQ(faults_with("demos/app/checks/a.cpp", "#include \"oilskin/bullet.h\""), 1u);
  EXPECT_EQ(faults_with("demos/app/output/a.cpp", "#include <vtkActor.h>"), 1u);
  EXPECT_EQ(faults_with("demos/app/output/a.cpp", "#include <GLFW/glfw3.h>"), 1u);
  EXPECT_EQ(faults_with("demos/app/view/a.cpp", "#include \"run/runner.h\""), 1u);
  EXPECT_EQ(faults_with("demos/app/scene/a.cpp", "#include <nlohmann/json.hpp>"), 1u);
  EXPECT_EQ(faults_with("demos/app/run/a.cpp", "#include <CLI/CLI.hpp>"), 1u);
  EXPECT_EQ(faults_with("demos/study/cases/a.cpp", "#include \"study/run/case_run.h\""), 1u);
  EXPECT_EQ(faults_with("demos/study/comparators/a.cpp", "#include \"study/cases/case.h\""), 1u);
  EXPECT_EQ(faults_with("demos/study/run/a.cpp", "#include \"study/study_command.h\""), 1u);
  EXPECT_EQ(faults_with("demos/app/checks/a.cpp", "#include \"study/cases/case.h\""), 2u) << "neither folder";
  EXPECT_EQ(faults_with("demos/examples/a.cpp", "#include \"scene/scene.h\""), 1u);
  EXPECT_EQ(faults_with("demos/examples/a.cpp", "#include \"../app/scene/scene.h\""), 1u);
  EXPECT_EQ(faults_with("demos/examples/a.cpp", "#include <core/hash.h>"), 1u);
  EXPECT_EQ(faults_with("demos/examples/a.cpp", "#include <nlohmann/json.hpp>"), 1u);
}

TEST(Structure, the_test_itself_lets_forward_edges_pass) {
  EXPECT_EQ(faults_with("src/fluid/a.cpp", "#include \"core/hash.h\""), 0u);
  EXPECT_EQ(faults_with("src/fluid/fluid_solver.cpp", "#include \"fluid/pressure/step_state.h\""), 0u);
  EXPECT_EQ(faults_with("src/fluid/pressure/a.cpp", "#include \"fluid/boundary/boundary.h\""), 0u);
  EXPECT_EQ(faults_with("src/fluid/boundary/a.cpp", "#include \"fluid/neighbours.h\""), 0u);
  EXPECT_EQ(faults_with("src/effects/tension/a.cpp", "#include \"effects/tension/a.h\""), 0u);
  EXPECT_EQ(faults_with("src/contact/a.cpp", "#include \"ccd/point_triangle.h\""), 0u);
  EXPECT_EQ(faults_with("src/contact/a.cpp", "#include \"contact/contacts.h\""), 0u);
  EXPECT_EQ(faults_with("src/world/a.cpp", "#include \"contact/contacts.h\""), 0u);
  EXPECT_EQ(faults_with("demos/app/scene/a.cpp", "#include \"scene/scene.h\""), 0u);
  EXPECT_EQ(faults_with("demos/app/run/a.cpp", "#include \"checks/totals.h\""), 0u);
  EXPECT_EQ(faults_with("demos/app/main.cpp", "#include \"run/runner.h\""), 0u);
  EXPECT_EQ(faults_with("demos/app/main.cpp", "#include \"study/study_command.h\""), 0u);
  EXPECT_EQ(faults_with("demos/study/run/a.cpp", "#include \"study/cases/case.h\""), 0u);
  EXPECT_EQ(faults_with("demos/study/cases/a.cpp", "#include \"checks/check.h\""), 0u);
  EXPECT_EQ(faults_with("demos/app/ccd_command.h", "#include \"ccd/point_triangle.h\""), 0u);
  EXPECT_EQ(faults_with("demos/app/render/a.cpp", "#include <vtkActor.h>"), 0u);
  EXPECT_EQ(faults_with("demos/app/view/a.cpp", "#include <imgui.h>"), 0u);
  EXPECT_EQ(faults_with("demos/app/hosts/bullet_simulation.cpp", "#include \"oilskin/bullet.h\""), 0u);
  EXPECT_EQ(faults_with("demos/examples/a.cpp", "#include \"oilskin/bullet.h\""), 0u);
  EXPECT_EQ(faults_with("demos/examples/a.cpp", "#include <BulletSoftBody/btSoftBody.h>"), 0u);
  EXPECT_EQ(faults_with("src/core/a.cpp", "// #include \"fluid/particles.h\""), 0u);
}

// --- Pages name tests as proof: each must exist.

std::string text_of(const fs::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// `Suite.test` in backticks, where Suite begins with a capital letter.
std::vector<std::pair<std::string, std::string>> tests_named_in(const std::string& page) {
  static const std::regex name("`([A-Z][A-Za-z]*)\\.([A-Za-z_0-9]+)`");
  std::vector<std::pair<std::string, std::string>> found;
  for (std::sregex_iterator it(page.begin(), page.end(), name), end; it != end; ++it)
    found.emplace_back((*it)[1], (*it)[2]);
  return found;
}

/// All test sources in one line each, without blanks, so that a definition may be broken over lines.
std::string definitions(const fs::path& tests) {
  std::string all;
  for (const auto& entry : fs::recursive_directory_iterator(tests)) {
    const std::string suffix = entry.path().extension().string();
    if (suffix != ".cpp" && suffix != ".h") continue;
    for (const char c : text_of(entry.path()))
      if (!std::isspace(static_cast<unsigned char>(c))) all += c;
  }
  return all;
}

TEST(Structure, tests_that_pages_name_as_proof_exist) {
  const fs::path root = OILSKIN_ROOT;
  const std::string sources = definitions(root / "tests");
  for (const char* page : {"docs/theory/contact.md", "docs/validation/embedding.md"}) {
    const auto named = tests_named_in(text_of(root / page));
    EXPECT_GT(named.size(), 10u) << page;
    for (const auto& [suite, test] : named)
      EXPECT_NE(sources.find("(" + suite + "," + test + ")"), std::string::npos)
          << page << " names " << suite << "." << test << ", which no test defines";
  }
}

}  // namespace
