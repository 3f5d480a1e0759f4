// `oilskin mesh`: frames of an earlier run, made once, and what is refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "app/program.h"

namespace oilskin::test {
namespace {

const char* const pool = R"({"host": "mock", "dt": 0.002, "duration": 0.02, "fluid": {"spacing": 0.01},
  "emitters": [{"shape": "box", "min": [-0.04, 0.02, -0.04], "max": [0.04, 0.06, 0.04]}],
  "cloth": [{"grid": [9, 9], "size": [0.2, 0.2], "pins": "corners"}]})";

/// A run with two frames or more; each test has its own.
class Mesh : public testing::Test {
 protected:
  void SetUp() override {
    const Outcome run = oilskin({"run", folder.write("pool.json", pool), "--out", folder.path("run"),
                                 "--frames-per-second", "100", "--no-render", "--quiet"});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    if (!exists("run/particles_0001.vtp")) GTEST_SKIP() << "built without VTK: a run stores no frames";
  }
  bool exists(const std::string& name) const { return std::filesystem::exists(folder.path(name)); }
  Outcome mesh(std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments = {"mesh", folder.path("run")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return oilskin(arguments);
  }
  /// Refused, in one line of ours that holds all of `parts`.
  void expect_refused(const std::vector<std::string>& more, const std::vector<std::string>& parts) const {
    const Outcome outcome = mesh(more);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.out;
    EXPECT_EQ(outcome.err.compare(0, 9, "oilskin: "), 0) << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    for (const std::string& part : parts)
      EXPECT_NE(outcome.err.find(part), std::string::npos) << "no \"" << part << "\" in: " << outcome.err;
  }

  Folder folder;
};

TEST_F(Mesh, existing_meshes_are_kept_unless_their_options_differ) {
  EXPECT_EQ(mesh().exit_code, 0);
  const std::string first = folder.read("run/surface_0001.ply");
  EXPECT_NE(first.find("element face"), std::string::npos);
  std::filesystem::remove(folder.path("run/surface_0000.ply"));
  const Outcome again = mesh();
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_NE(again.out.find("were there already"), std::string::npos) << again.out;
  EXPECT_TRUE(exists("run/surface_0000.ply"));

  expect_refused({"--cell", "0.004"}, {"surface_000", "\"cell\":0.005", "\"cell\":0.004", "--overwrite"});
  EXPECT_EQ(folder.read("run/surface_0001.ply"), first);
  // The same said in other words is the same.
  EXPECT_EQ(mesh({"--cell", "0.005", "--spacing", "0.01"}).exit_code, 0);
  EXPECT_EQ(mesh({"--cell", "0.004", "--out", folder.path("fine")}).exit_code, 0);
  EXPECT_TRUE(exists("fine/surface_0001.ply"));
  EXPECT_EQ(mesh({"--cell", "0.004", "--overwrite"}).exit_code, 0);
  EXPECT_EQ(folder.read("run/surface_0001.ply"), folder.read("fine/surface_0001.ply"));
  folder.write("run/surface_0001.ply", "of another program");
  expect_refused({"--cell", "0.004"}, {"surface_0001.ply", "unknown options"});
}

TEST_F(Mesh, a_file_that_was_cut_off_is_made_again) {
  for (const std::string format : {"ply", "glb"}) {
    const Outcome made = mesh({"--formats", format});
    if (made.err.find("libtinygltf-dev") != std::string::npos) continue;
    EXPECT_EQ(made.exit_code, 0) << made.err;
    const std::string name = "run/surface_0001." + format, whole = folder.read(name);
    std::filesystem::resize_file(folder.path(name), whole.size() - 1);
    EXPECT_EQ(mesh({"--missing", "--formats", format}).out, "1\n");
    EXPECT_EQ(mesh({"--formats", format}).exit_code, 0);
    EXPECT_EQ(folder.read(name), whole);
    EXPECT_EQ(mesh({"--missing", "--formats", format}).out, "");
  }
}

TEST_F(Mesh, surfaces_of_the_run_itself_are_ones_of_its_options) {
  const Outcome run =
      oilskin({"run", folder.path("pool.json"), "--out", folder.path("run"), "--frames-per-second", "100",
               "--no-render", "--quiet", "--set", "surface.gap=0.0005", "--set", "surface.mode=touch"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(mesh().exit_code, 0);
  const std::string first = folder.read("run/surface_0001.ply");
  EXPECT_EQ(mesh({"--overwrite"}).exit_code, 0);
  EXPECT_EQ(folder.read("run/surface_0001.ply"), first);
  expect_refused({"--gap", "0.001"}, {"\"gap\":0.0005", "\"gap\":0.001"});
}

TEST_F(Mesh, the_wetness_that_the_run_stored_decides_where_the_mesh_touches_the_cloth) {
  const Outcome run =
      oilskin({"run", folder.path("pool.json"), "--out", folder.path("run"), "--frames-per-second", "100",
               "--no-render", "--quiet", "--set", "duration=0.1", "--set", "effects.wetting.absorption=50",
               "--set", "surface.smoothing=0"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const std::string last = "surface_0010.ply";
  const std::string stored = folder.read("run/" + last);
  ASSERT_FALSE(stored.empty());
  const auto made = [&](const std::string& mode) {
    const Outcome outcome = mesh({"--mode", mode, "--out", folder.path(mode)});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    // The comment names the options; what follows is the mesh.
    const std::string text = folder.read(mode + "/" + last);
    return text.substr(text.find("element vertex"));
  };
  const std::string wet = made("wet");
  EXPECT_NE(wet, made("touch"));
  EXPECT_NE(wet, made("gap"));
}

TEST_F(Mesh, only_missing_formats_are_made_and_missing_frames_are_listed) {
  EXPECT_EQ(mesh({"--missing"}).out, "0\n1\n2\n");
  EXPECT_FALSE(exists("run/surface_0001.ply"));
  const Outcome all = mesh({"--formats", "ply,glb"});
  if (all.err.find("libtinygltf-dev") != std::string::npos) GTEST_SKIP() << "built without TinyGLTF";
  EXPECT_EQ(all.exit_code, 0) << all.err;
  EXPECT_EQ(mesh({"--missing", "--formats", "ply,glb"}).out, "");
  const std::string first = folder.read("run/surface_0001.glb");
  const auto time = std::filesystem::last_write_time(folder.path("run/surface_0001.ply"));
  std::filesystem::remove(folder.path("run/surface_0001.glb"));
  EXPECT_EQ(mesh({"--missing", "--formats", "ply,glb"}).out, "1\n");
  EXPECT_EQ(mesh({"--missing"}).out, "");
  EXPECT_EQ(mesh({"--formats", "ply,glb", "--threads", "2"}).exit_code, 0);
  EXPECT_EQ(folder.read("run/surface_0001.glb"), first);
  EXPECT_EQ(std::filesystem::last_write_time(folder.path("run/surface_0001.ply")), time);
  expect_refused({"--formats", "glb", "--cell", "0.004"}, {"surface_0000.glb", "--overwrite"});
  expect_refused({"--formats", "glb,gltf"}, {"formats", "gltf", "ply, glb, vdb"});
}

TEST_F(Mesh, channels_are_chosen_and_part_of_the_options) {
  EXPECT_EQ(mesh({"--channels", "id,speed"}).exit_code, 0);
  const std::string made = folder.read("run/surface_0001.ply");
  EXPECT_NE(made.find("property float nz\nproperty float speed\nproperty int id\nelement face"),
            std::string::npos);
  expect_refused({}, {"\"channels\":[\"speed\",\"id\"]", "--overwrite"});
  expect_refused({"--channels", "speed,speed"}, {"channels", "twice"});
  expect_refused({"--channels", "depth"}, {"channels", "depth", "velocity, speed, wetness, thickness, id"});
}

TEST_F(Mesh, keys_of_the_surface_are_set_and_the_options_win) {
  EXPECT_EQ(mesh({"--set", "surface.keep_volume=false", "--set", "surface.cell=0.004", "--cell", "0.005"})
                .exit_code,
            0);
  const std::string made = folder.read("run/surface_0001.ply");
  EXPECT_NE(made.find("\"keep_volume\":false"), std::string::npos);
  EXPECT_NE(made.find("\"cell\":0.005"), std::string::npos);
  expect_refused({"--set", "surface.min_blb=2"}, {"surface.min_blb"});
  expect_refused({"--set", "surface.min_blob=-2"}, {"surface.min_blob", "-2"});
  expect_refused({"--set", "fluid.spacing=0.02"}, {"fluid.spacing", "surface"});
  expect_refused({"--set", "surface=3"}, {"surface"});
  expect_refused({"--set", "min_blob"}, {"must be surface.KEY=VALUE"});
  expect_refused({"--density", "-1"}, {"--density", "-1"});
}

/// The volume that the line of a frame states [m³].
double volume_of(const std::string& line) {
  const std::size_t at = line.find("volume ");
  return at == std::string::npos ? 0 : std::stod(line.substr(at + 7));
}

/// A file of two particles with an array.
std::string two_particles(const std::string& array) {
  return R"(<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian"><PolyData>
<Piece NumberOfPoints="2"><Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">
0 0 0 0.05 0 0</DataArray></Points><PointData><DataArray type="Float64" )" +
         array + "</DataArray></PointData></Piece></PolyData></VTKFile>";
}

TEST_F(Mesh, an_array_of_another_length_is_refused_by_name) {
  std::filesystem::create_directory(folder.path("other"));
  folder.write("other/particles_0003.vtp",
               two_particles(R"(Name="velocity" NumberOfComponents="2" format="ascii">0 0 0 0)"));
  const Outcome outcome = oilskin({"mesh", folder.path("other"), "--spacing", "0.01"});
  EXPECT_EQ(outcome.exit_code, 2) << outcome.out;
  EXPECT_NE(outcome.err.find("particles_0003.vtp: \"velocity\" has 2 times 2 values, must have 2 times 3"),
            std::string::npos)
      << outcome.err;
}

TEST_F(Mesh, particles_of_another_program_have_the_volume_of_their_masses) {
  std::filesystem::create_directory(folder.path("other"));
  folder.write("other/particles_0003.vtp", two_particles(R"(Name="mass" format="ascii">0.001 0.003)"));
  const std::vector<std::string> other = {"mesh", folder.path("other"), "--spacing", "0.01"};
  const Outcome plain = oilskin(other);
  EXPECT_EQ(plain.exit_code, 0) << plain.err;
  EXPECT_NEAR(volume_of(plain.out), 2e-6, 2e-8);
  EXPECT_NE(plain.out.find("--density"), std::string::npos) << plain.out;
  std::vector<std::string> with_density = other;
  with_density.insert(with_density.end(), {"--density", "1000", "--overwrite"});
  const Outcome heavy = oilskin(with_density);
  EXPECT_EQ(heavy.exit_code, 0) << heavy.err;
  EXPECT_NEAR(volume_of(heavy.out), 4e-6, 4e-8);
  EXPECT_NE(heavy.out.find("of 4e-06 m3 of water"), std::string::npos) << heavy.out;
  EXPECT_NE(heavy.out.find("0 obstacles of 0 triangles"), std::string::npos) << heavy.out;
  // A mesh made with another density does not pass for this one.
  with_density = other;
  with_density.insert(with_density.end(), {"--density", "500"});
  EXPECT_NE(oilskin(with_density).err.find("\"density\":500"), std::string::npos);
  with_density.back() = "1e-3";
  with_density.push_back("--overwrite");
  EXPECT_NE(oilskin(with_density).err.find("the mass of particle 0 is 0.001 kg"), std::string::npos);
}

TEST_F(Mesh, a_file_that_cannot_be_written_ends_with_three) {
  // A folder that is not empty lies where the file is to go.
  const std::string out = folder.path("run/surface_0001.ply");
  std::filesystem::create_directories(out + "/full");
  const Outcome outcome = mesh({"--overwrite"});
  EXPECT_EQ(outcome.exit_code, 3) << outcome.out;
  EXPECT_NE(outcome.err.find("surface_0001.ply: cannot be written"), std::string::npos) << outcome.err;
}

TEST_F(Mesh, a_spacing_in_other_units_is_refused_with_the_numbers) {
  expect_refused({"--spacing", "10"}, {"--spacing", "is 10 m", "256 particles", "within 0.0"});
  expect_refused({"--spacing", "1e-05"}, {"--spacing", "is 1e-05 m", "within 0.0"});
  expect_refused({"--spacing", "0"}, {"--spacing", "> 0"});
  EXPECT_FALSE(exists("run/surface_0000.ply"));
}

/// A run knows the water of its particles: however densely they lie, its spacing is right.
TEST_F(Mesh, the_spacing_of_a_run_is_not_doubted_if_its_masses_agree) {
  std::filesystem::create_directory(folder.path("pressed"));
  folder.write("pressed/particles_0000.vtp", two_particles(R"(Name="density" format="ascii">1000 1000)"));
  const auto report = [&](const std::string& mass) {
    folder.write(
        "pressed/report.json",
        R"({"settings":{"fluid":{"spacing":1,"rest_density":1000}},"mass":{"particle":)" + mass + "}}");
  };
  report("1000");
  EXPECT_EQ(oilskin({"mesh", folder.path("pressed")}).exit_code, 0);
  report("1e-6");
  const Outcome other = oilskin({"mesh", folder.path("pressed"), "--overwrite"});
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_NE(other.err.find("is 1 m, but half of the 2 particles"), std::string::npos) << other.err;
  report("1000");
  EXPECT_EQ(oilskin({"mesh", folder.path("pressed"), "--overwrite", "--spacing", "1.01"}).exit_code, 2);
}

TEST_F(Mesh, what_may_be_wrong_with_a_folder_is_noted_once) {
  EXPECT_EQ(mesh().out.find("note:"), std::string::npos);
  EXPECT_EQ(mesh({"--overwrite"}).out.find("not read"), std::string::npos);
  const Outcome wide = mesh({"--spacing", "0.03", "--cell", "0.02", "--overwrite"});
  const std::size_t first = wide.out.find("the spacing is 0.03 m");
  ASSERT_NE(first, std::string::npos) << wide.out;
  EXPECT_EQ(wide.out.find("note:", first), std::string::npos) << wide.out;
  folder.write("run/Cloth_0_1.ply", "");
  folder.write("run/particles_1.vtp", "");
  const Outcome named = mesh({"--overwrite"});
  EXPECT_NE(named.out.find("Cloth_0_1.ply and 1 more"), std::string::npos) << named.out;
  // Two frames in one.
  std::string doubled = folder.read("run/particles_0001.vtp");
  const std::size_t begin = doubled.find("<Piece"), end = doubled.find("</PolyData>");
  ASSERT_NE(begin, std::string::npos);
  doubled.insert(end, doubled.substr(begin, end - begin));
  folder.write("run/particles_0001.vtp", doubled);
  const Outcome twice = mesh({"--overwrite", "--frames", "1:1"});
  EXPECT_EQ(twice.exit_code, 0) << twice.err;
  EXPECT_NE(twice.out.find("256 of 512 particles lie where another one lies"), std::string::npos)
      << twice.out;
}

TEST_F(Mesh, a_wetness_in_percent_is_refused_by_name) {
  folder.write(
      "run/cloth_7_0001.ply",
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "property float wetness\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0 0.5\n1 0 0 50\n0 1 0 1\n3 0 1 2\n");
  expect_refused({"--frames", "1:1"},
                 {"cloth_7_0001.ply: the wetness of vertex 1 is 50, must be 0 (dry) to 1"});
}

TEST_F(Mesh, damaged_particles_are_refused_in_one_line) {
  const std::string whole = folder.read("run/particles_0001.vtp");
  const auto with = [&](const std::string& what, const std::string& instead) {
    std::string s = whole;
    return s.replace(s.find(what), what.size(), instead);
  };
  for (const std::string& bad :
       {std::string(), std::string("no file of VTK"), whole.substr(0, whole.size() / 20),
        whole.substr(0, whole.size() / 2), whole.substr(0, whole.size() - 400), with("Points", "Poinds"),
        with("NumberOfPoints=\"256\"", "NumberOfPoints=\"999999\""), with("<PolyData>", "<ImageData>")}) {
    folder.write("run/particles_0001.vtp", bad);
    expect_refused({"--overwrite"}, {"particles_0001.vtp"});
    EXPECT_FALSE(exists("run/surface_0001.ply"));
  }
}

TEST_F(Mesh, a_report_that_is_damaged_or_nested_without_end_is_refused) {
  folder.write("run/report.json", "{\"settings\": 5}");
  expect_refused({}, {"report.json"});
  folder.write("run/report.json", std::string(200000, '['));
  expect_refused({}, {"report.json", "levels deep"});
  std::string deep = "{\"settings\": ";
  for (int i = 0; i < 100000; ++i) deep += "{\"a\":";
  folder.write("run/report.json", deep + "1" + std::string(100001, '}'));
  expect_refused({}, {"report.json", "levels deep"});
}

}  // namespace
}  // namespace oilskin::test
