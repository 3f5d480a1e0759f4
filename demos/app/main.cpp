/// The program `oilskin`: list, run, view, ccd, mesh, effects, validate, study.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <new>

#include "ccd_command.h"
#include "effects_command.h"
#include "hosts/bullet_simulation.h"
#include "mesh_command.h"
#include "oilskin/version.h"
#include "output/output_error.h"
#include "run/runner.h"
#include "scene/fields.h"
#include "scene/options.h"
#include "scene/scene_library.h"
#include "scene/scene_reader.h"
#include "study/run/case_run.h"
#include "study/study_command.h"
#include "study/validate_command.h"
#include "view/view_options.h"

namespace oilskin::demo {
namespace {

void list_scenes() {
  for (const std::string& name : shipped_scenes()) {
    const Json json = read_json_file(scenes_directory() + "/" + name + ".json");
    std::printf("%-12s %s\n", name.c_str(), json.value("description", std::string()).c_str());
  }
}

/// Bullet's single and double precision cannot live in one process: the program beside this one has the
/// other.
void become_the_other_precision(HostKind wanted, char** argv) {
  const char* name = wanted == HostKind::bullet64 ? "oilskin-f64" : "oilskin";
  std::error_code error;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
  const std::string other = (self.parent_path() / name).string();
  execv(other.c_str(), argv);
  throw SceneError(std::string("host: needs the program ") + name + " beside this one, which is not there");
}

int run(RunOptions& options, char** argv) {
  const Scene scene = load_scene(options);
  if (scene.host != HostKind::mock && scene.host != built_in_host())
    become_the_other_precision(scene.host, argv);
  return run_scene(scene, options, make_simulation);
}

int view(const ViewOptions& options, char** argv) {
  const Scene scene = load_scene(options.run);
  if (scene.host != HostKind::mock && scene.host != built_in_host())
    become_the_other_precision(scene.host, argv);
  return view_scene(scene, options, make_simulation);
}

StepRange parse_steps(const std::string& text) {
  StepRange range;
  char end = 0;
  unsigned long long first = 0, last = 0;
  if (std::sscanf(text.c_str(), "%llu:%llu%c", &first, &last, &end) != 2 || first > last || text[0] == '-')
    throw SceneError("--trace-steps " + text + ": must be A:B, two steps with A <= B, counted from 0");
  range.first = first;
  range.last = last;
  return range;
}

struct CommandLine {
  CLI::App app{"Leak-free water for Bullet's cloth", "oilskin"};
  CLI::App *list = nullptr, *run = nullptr, *view = nullptr, *ccd = nullptr, *mesh = nullptr,
           *effects = nullptr, *validate = nullptr, *study = nullptr;
  RunOptions options;
  ViewOptions view_options;
  MeshOptions mesh_options;
  EffectsOptions effects_options;
  ValidateOptions validate_options;
  StudyOptions study_options;
  std::string trace_steps;
  bool render = false;
  std::vector<std::string> ccd_files;

  CommandLine();
  void add_view();
  void add_mesh();
  void add_effects();
  void add_validate();
  void add_study();
};

CommandLine::CommandLine() {
  app.require_subcommand(1);
  app.set_version_flag("--version", "oilskin " OILSKIN_VERSION_STRING);
  list = app.add_subcommand("list", "the scenes that come with it");
  ccd = app.add_subcommand("ccd",
                           "answers every vertex-face query of the files and compares with their labels");
  ccd->add_option("FILE", ccd_files, "CSV files")->required();
  run = app.add_subcommand("run", "runs a scene");
  run->add_option("SCENE", options.scene, "a name from `oilskin list`, or a path to a scene file")
      ->required();
  run->add_option("--out", options.out, "folder for what the run writes (default out/NAME)");
  run->add_option("--duration", options.duration, "simulated time [s]");
  run->add_option("--dt", options.dt, "step of fluid and contact [s]");
  run->add_option("--threads", options.threads, "0 = all hardware threads")->check(CLI::Range(0, 1024));
  run->add_option("--frames-per-second", options.frames_per_second,
                  "of simulated time; 0 = none (default: the scene's, 30)")
      ->check(CLI::Range(0.0, 1e6));
  run->add_flag("--render,!--no-render", render, "draw pictures (default: if the program can)");
  run->add_flag("--view", options.view, "show a window");
  CLI::Option* trace = run->add_option("--trace", options.trace, "motion trace to FILE; - = standard output");
  run->add_option("--trace-steps", trace_steps, "A:B, only these steps, both included, counted from 0")
      ->needs(trace);
  run->add_option("--set", options.set, "KEY=VALUE, one key of the scene by its dotted path; may be repeated")
      ->expected(1)
      ->take_all();
  run->add_flag("--quiet", options.quiet, "print nothing but errors");
  run->add_option("--seed", options.seed, "of everything random")->check(CLI::NonNegativeNumber);
  add_view();
  add_mesh();
  add_effects();
  add_validate();
  add_study();
}

void CommandLine::add_view() {
  ViewOptions& v = view_options;
  view = app.add_subcommand("view", "shows a scene in a window: see, stop, pull and change it while it runs");
  view->add_option("SCENE", v.run.scene, "a name from `oilskin list`, or a path to a scene file")->required();
  view->add_option("--set", v.run.set, "KEY=VALUE, one key of the scene; may be repeated")
      ->expected(1)
      ->take_all();
  view->add_option("--dt", v.run.dt, "step of fluid and contact [s]");
  view->add_option("--seed", v.run.seed, "of everything random")->check(CLI::NonNegativeNumber);
  view->add_option("--threads", v.run.threads, "0 = all hardware threads")->check(CLI::Range(0, 1024));
  view->add_option("--width", v.width, "of the window [pixels] (default 1280)")->check(CLI::Range(64, 16384));
  view->add_option("--height", v.height, "of the window [pixels] (default 800)")
      ->check(CLI::Range(64, 16384));
  view->add_option("--frames", v.frames, "end after so many frames, each 1/30 s of simulated time at speed 1")
      ->check(CLI::PositiveNumber);
  view->add_option("--screenshot", v.screenshot, "PNG file of the last frame");
  view->add_option("--script", v.script, "file of commands and the frames at which they are obeyed");
  view->add_option("--log", v.log, "file for a line of JSON per frame");
}

void CommandLine::add_mesh() {
  MeshOptions& m = mesh_options;
  mesh = app.add_subcommand("mesh", "the water's surface of the frames that a run stored in DIR");
  mesh->add_option("DIR", m.directory,
                   "with particles_NNNN.vtp, and cloth_K_NNNN.ply and body_K_NNNN.ply beside")
      ->required();
  mesh->add_option("--frames", m.frames, "A:B, only these frames, both included (default: all)");
  mesh->add_option("--cell", m.cell, "edge of a grid cell [m] (default: the run's, or half a spacing)");
  mesh->add_option("--gap", m.gap, "between water and obstacles [m] (default: the run's, or 0)");
  mesh->add_option(
      "--mode", m.mode,
      "at obstacles: gap, touch, wet, overlap, reset or none (default: the run's, or gap; wet if "
      "its cloth absorbed)");
  mesh->add_option("--smoothing", m.smoothing, "iterations (default: the run's, or 10)");
  mesh->add_option("--formats", m.formats, "ply,glb,vdb: the files to write (default: the run's, or ply)")
      ->delimiter(',')
      ->allow_extra_args(false);
  mesh->add_option("--channels", m.channels,
                   "velocity,speed,thickness,wetness,id: of the vertices (default: the run's, or velocity)")
      ->delimiter(',')
      ->allow_extra_args(false);
  mesh->add_option(
          "--set", m.set,
          "surface.KEY=VALUE, one key of the scene's surface, e.g. surface.keep_volume=false; may be "
          "repeated; the options above win")
      ->expected(1)
      ->take_all();
  mesh->add_option("--spacing", m.spacing, "of the particles [m] (default: as DIR/report.json says)");
  mesh->add_option("--density", m.density,
                   "of the water [kg/m3]: a particle with a mass has mass/density of water (default: as "
                   "DIR/report.json says)");
  mesh->add_option("--out", m.out, "folder for surface_NNNN.* (default: DIR)");
  mesh->add_option("--threads", m.threads, "0 = all hardware threads")->check(CLI::Range(0, 1024));
  mesh->add_flag("--overwrite", m.overwrite, "make surfaces that are there already again");
  mesh->add_flag("--missing", m.missing, "only print the numbers of the frames that lack a file");
  mesh->add_flag("--quiet", m.quiet, "print nothing but errors");
}

void CommandLine::add_effects() {
  EffectsOptions& e = effects_options;
  effects =
      app.add_subcommand("effects", "what effects cost: time and memory of a scene with none, each and all");
  effects->add_option("SCENE", e.scene,
                      "a name from `oilskin list`, or a path to a scene file (default jet)");
  effects->add_option("--out", e.out, "folder for tables, plot and reports (default out/NAME_effects)");
  effects->add_option("--duration", e.duration, "simulated time of each run [s] (default 0.3)")
      ->check(CLI::PositiveNumber);
  effects->add_option("--threads", e.threads, "0 = all hardware threads")->check(CLI::Range(0, 1024));
  effects->add_option("--repeat", e.repeat, "runs of each, in turn (default 3)")->check(CLI::Range(1, 1000));
  effects->add_option("--set", e.set, "KEY=VALUE, one key of the scene, in all runs; may be repeated")
      ->expected(1)
      ->take_all();
  effects->add_flag("--again", e.again, "repeat runs that are there with the same settings");
  effects->add_flag("--quiet", e.quiet, "print nothing but errors");
}

void CommandLine::add_validate() {
  ValidateOptions& v = validate_options;
  validate = app.add_subcommand("validate", "runs the validation cases against their references");
  validate->add_option("CASE", v.cases, "names from --list (default: all)");
  validate->add_flag("--list", v.list, "print the cases");
  validate->add_option("--out", v.out, "folder for runs and tables (default out/validation)");
  validate->add_option("--levels", v.levels, "only so many spacings of each case, from the coarsest")
      ->check(CLI::PositiveNumber);
  validate
      ->add_option("--spacing", v.spacings, "of the particles [m], instead of the case's; may be repeated")
      ->check(CLI::PositiveNumber);
  validate->add_option("--step", v.step, "length of the step over the case's")->check(CLI::PositiveNumber);
  validate->add_option("--thickness", v.thickness, "of all surfaces, in spacings")
      ->check(CLI::PositiveNumber);
  validate->add_option("--host", v.host, "mock, bullet or bullet64 (default mock)");
  validate->add_option("--preset", v.preset, "none, game, film or measurement (default none)");
  validate->add_option("--set", v.set, "KEY=VALUE, one key of a scene by its dotted path; may be repeated")
      ->expected(1)
      ->take_all();
  validate->add_option("--threads", v.threads, "0 = all hardware threads")->check(CLI::Range(0, 1024));
  validate->add_option("--repeat", v.repeat, "runs of each, for their times (default 1)")
      ->check(CLI::PositiveNumber);
  validate->add_flag("!--no-tables", v.tables, "write no tables");
  validate->add_flag("--again", v.again, "repeat runs that are there with the same settings");
  validate->add_flag("--quiet", v.quiet, "print nothing but errors");
}

void CommandLine::add_study() {
  StudyOptions& s = study_options;
  study = app.add_subcommand("study", "what accuracy costs: one parameter at a time, over cases");
  study->add_option("PART", s.parts, "names from --list (default: all)");
  study->add_flag("--list", s.list, "print the parts");
  study->add_option("--case", s.cases, "only these cases of the sweeps; may be repeated");
  study->add_option("--out", s.out, "folder for runs, tables and plots (default out/study)");
  study->add_option("--threads", s.threads, "0 = all hardware threads (default 1)")
      ->check(CLI::Range(0, 1024));
  study->add_option("--repeat", s.repeat, "runs of each, for their times (default 3)")
      ->check(CLI::PositiveNumber);
  study->add_flag("--again", s.again, "repeat runs that are there with the same settings");
  study->add_flag("--quiet", s.quiet, "print nothing but errors");
}

int dispatch(CommandLine& line, char** argv) {
  if (*line.list) {
    list_scenes();
    return 0;
  }
  if (*line.ccd) return ccd_command(line.ccd_files, std::cout, std::cerr);
  if (*line.view) return view(line.view_options, argv);
  if (*line.mesh) return mesh_command(line.mesh_options);
  if (*line.effects) return effects_command(line.effects_options);
  if (*line.validate) {
    const HostKind host = host_of(line.validate_options.host);
    if (host != HostKind::mock && host != built_in_host()) become_the_other_precision(host, argv);
    return validate_command(line.validate_options, built_in_host(), make_simulation);
  }
  if (*line.study) return study_command(line.study_options, built_in_host(), make_simulation);
  if (line.run->count("--render") > 0) line.options.render = line.render;
  if (!line.trace_steps.empty()) line.options.trace_steps = parse_steps(line.trace_steps);
  return run(line.options, argv);
}

int fail(ExitCode code, const std::string& message) {
  std::fprintf(stderr, "oilskin: %s\n", message.c_str());
  return static_cast<int>(code);
}

int run_program(int argc, char** argv) {
  CommandLine line;
  try {
    line.app.parse(argc, argv);
    return dispatch(line, argv);
  } catch (const CLI::ParseError& e) {
    return line.app.exit(e) == 0 ? 0 : static_cast<int>(ExitCode::bad_input);
  } catch (const SceneError& e) {
    return fail(ExitCode::bad_input, e.what());
  } catch (const OutputError& e) {
    return fail(ExitCode::out_of_resources, e.what());
  } catch (const std::filesystem::filesystem_error& e) {
    return fail(ExitCode::bad_input, e.what());
  } catch (const std::bad_alloc&) {
    return fail(ExitCode::out_of_resources,
                "out of memory; fewer particles (a larger fluid.spacing) need less");
  }
}

}  // namespace
}  // namespace oilskin::demo

// NOLINTNEXTLINE(bugprone-exception-escape): std::terminate prints the message of an unexpected exception
int main(int argc, char** argv) {
  return oilskin::demo::run_program(argc, argv);
}
