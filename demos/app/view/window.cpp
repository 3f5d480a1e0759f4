#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include <chrono>
#include <cstdio>
#include <fstream>
#include <sstream>

#include "scene/fields.h"
#include "view/frame_log.h"
#include "view/painter.h"
#include "view/panel.h"
#include "view/png_file.h"
#include "view/view_options.h"

namespace oilskin::demo {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double frame_time = 1.0 / 30;  // between the frames of --frames [s]
constexpr double step_budget = 0.03;     // of a frame, for steps [s]
constexpr double longest_frame = 0.1;    // of wall time that is made up for [s]

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// GLFW, its window with a context, and ImGui in it.
class Window {
 public:
  Window(Viewer& viewer, const std::string& title) : viewer_(viewer) {
    static std::string fault;
    fault.clear();
    glfwSetErrorCallback([](int, const char* why) { fault = why; });
    if (glfwInit() == 0) throw SceneError("view: there is no display to open a window on: " + fault);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_SAMPLES, 4);
    window_ = glfwCreateWindow(viewer.width(), viewer.height(), title.c_str(), nullptr, nullptr);
    if (window_ == nullptr) {
      glfwTerminate();
      throw SceneError("view: no window with OpenGL 3.3 can be opened: " + fault);
    }
    glfwMakeContextCurrent(window_);
    glfwSwapInterval(1);
    glfwGetCursorPos(window_, &x_, &y_);
    listen();
    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr;
    ImGui::StyleColorsLight();
    ImGui_ImplGlfw_InitForOpenGL(window_, true);
    ImGui_ImplOpenGL3_Init("#version 330 core");
  }
  ~Window() {
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
    glfwDestroyWindow(window_);
    glfwTerminate();
  }
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  bool is_open() const { return glfwWindowShouldClose(window_) == 0; }
  void poll() {
    glfwPollEvents();
    int width = 0, height = 0;
    glfwGetFramebufferSize(window_, &width, &height);
    if (width > 0 && height > 0) viewer_.resize(width, height);
  }
  static void begin_panel() {
    ImGui_ImplOpenGL3_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    ImGui::NewFrame();
  }
  static void draw_panel_over_scene() {
    ImGui::Render();
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  }
  void swap() { glfwSwapBuffers(window_); }

 private:
  enum class Hand { none, holds, turns, moves };

  /// Before ImGui, which calls these callbacks in turn.
  void listen() {
    glfwSetWindowUserPointer(window_, this);
    glfwSetMouseButtonCallback(window_, [](GLFWwindow* w, int button, int action, int mods) {
      self(w).on_button(button, action == GLFW_PRESS, (mods & GLFW_MOD_SHIFT) != 0);
    });
    glfwSetCursorPosCallback(window_, [](GLFWwindow* w, double x, double y) { self(w).on_move(x, y); });
    glfwSetScrollCallback(window_, [](GLFWwindow* w, double, double steps) {
      if (!ImGui::GetIO().WantCaptureMouse) self(w).viewer_.zoom(steps);
    });
    glfwSetKeyCallback(window_, [](GLFWwindow* w, int key, int code, int action, int) {
      if (action != GLFW_RELEASE && !ImGui::GetIO().WantTextInput) self(w).on_key(key, code);
    });
  }
  static Window& self(GLFWwindow* window) { return *static_cast<Window*>(glfwGetWindowUserPointer(window)); }

  /// Left: takes hold, or turns the camera where there is nothing to hold. Right: turns. Middle: moves.
  void on_button(int button, bool pressed, bool shift) {
    if (!pressed) {
      if (hand_ == Hand::holds) viewer_.let_go();
      hand_ = Hand::none;
      return;
    }
    if (ImGui::GetIO().WantCaptureMouse) return;
    if (button == GLFW_MOUSE_BUTTON_MIDDLE)
      hand_ = Hand::moves;
    else if (button == GLFW_MOUSE_BUTTON_LEFT && viewer_.grab(x_ * scale(), y_ * scale(), shift))
      hand_ = Hand::holds;
    else
      hand_ = Hand::turns;
  }

  void on_move(double x, double y) {
    const double dx = x - x_, dy = y - y_;
    x_ = x;
    y_ = y;
    if (hand_ == Hand::holds) viewer_.drag(x * scale(), y * scale());
    if (hand_ == Hand::turns) viewer_.orbit(dx, dy);
    if (hand_ == Hand::moves) viewer_.pan(dx, dy);
  }

  void on_key(int key, int code) {
    static constexpr std::pair<int, const char*> named[] = {
        {GLFW_KEY_SPACE, "space"}, {GLFW_KEY_ESCAPE, "escape"}, {GLFW_KEY_LEFT, "left"},
        {GLFW_KEY_RIGHT, "right"}, {GLFW_KEY_UP, "up"},         {GLFW_KEY_DOWN, "down"}};
    for (const auto& [code_of, name] : named)
      if (key == code_of) return viewer_.press(name);
    if (const char* name = glfwGetKeyName(key, code)) viewer_.press(name);
  }

  /// Pixels of the picture over the mouse's.
  double scale() const {
    int width = 0, height = 0;
    glfwGetWindowSize(window_, &width, &height);
    return height > 0 ? static_cast<double>(viewer_.height()) / height : 1;
  }

  Viewer& viewer_;
  GLFWwindow* window_ = nullptr;
  Hand hand_ = Hand::none;
  double x_ = 0, y_ = 0;  ///< of the mouse, as of the event that is handled
};

/// No script without a file.
std::vector<ScriptLine> read_script(const std::string& path) {
  if (path.empty()) return {};
  std::ifstream file(path);
  if (!file) throw SceneError("--script " + path + ": cannot be read");
  std::ostringstream text;
  text << file.rdbuf();
  return parse_script(text.str(), path);
}

/// One window from its opening to its end.
class Show {
 public:
  Show(LiveScene& live, const ViewOptions& options)
      : options_(options),
        script_(read_script(options.script)),
        viewer_(live, options.width, options.height),
        log_(options.log),
        window_(viewer_, "oilskin: " + live.scene().name),
        painter_(glfwGetProcAddress) {}

  int run() {
    for (std::uint64_t frame = 0; window_.is_open() && !viewer_.wants_to_quit(); ++frame) {
      if (options_.frames && frame == *options_.frames) break;
      draw_frame(frame);
    }
    return static_cast<int>(ExitCode::done);
  }

 private:
  void draw_frame(std::uint64_t frame) {
    window_.poll();
    obey_script(frame);
    take_steps(frame);
    shown_.update(viewer_.live(), viewer_.shown(), options_.run.threads);
    numbers_.frame.shapes = shown_.shapes_seconds();
    numbers_.frame.water_mesh = viewer_.shown().water == ShownWater::balls ? 0 : shown_.mesh_seconds();
    numbers_.mesh_refusal = shown_.mesh_refusal();
    const Clock::time_point start = Clock::now();
    window_.begin_panel();
    const auto places = draw_panel(viewer_, numbers_);
    painter_.draw(shown_, viewer_.shown(), viewer_.camera(), viewer_.left(), viewer_.width(),
                  viewer_.height(), viewer_.live().simulation().grip(), viewer_.views()[viewer_.view()].up);
    window_.draw_panel_over_scene();
    save_pictures(frame);
    log_.write(frame, viewer_, places);
    window_.swap();
    numbers_.frame.drawing = seconds_since(start);
  }

  void obey_script(std::uint64_t frame) {
    for (; next_line_ < script_.size() && script_[next_line_].frame <= frame; ++next_line_) {
      const Status status = viewer_.obey(script_[next_line_].command);
      if (!status.ok()) throw SceneError("--script " + options_.script + ": " + status.message);
    }
  }

  /// With --frames the state of each frame is the same on every machine.
  void take_steps(std::uint64_t frame) {
    const Clock::time_point start = Clock::now();
    const double wall = frame == 0 ? 0 : std::chrono::duration<double>(start - last_).count();
    last_ = start;
    const double before = viewer_.live().time();
    if (options_.frames)
      viewer_.advance(frame == 0 ? 0 : frame_time, std::numeric_limits<double>::infinity());
    else
      viewer_.advance(std::min(wall, longest_frame), step_budget);
    numbers_.frame.steps = seconds_since(start);
    if (!(wall > 0)) return;
    numbers_.frames_per_second += 0.1 * (1 / wall - numbers_.frames_per_second);
    numbers_.real_time += 0.1 * (std::max(0.0, viewer_.live().time() - before) / wall - numbers_.real_time);
  }

  void save_pictures(std::uint64_t frame) {
    std::string file = viewer_.take_screenshot();
    if (!file.empty()) save(file);
    const bool is_last = options_.frames && frame + 1 == *options_.frames;
    if (!options_.screenshot.empty() && (is_last || viewer_.wants_to_quit())) save(options_.screenshot);
  }

  void save(const std::string& file) {
    write_png(file, viewer_.width(), viewer_.height(), painter_.pixels(viewer_.width(), viewer_.height()));
    viewer_.say("wrote " + file);
  }

  const ViewOptions& options_;
  std::vector<ScriptLine> script_;
  std::size_t next_line_ = 0;
  Viewer viewer_;
  FrameLog log_;
  Window window_;
  Painter painter_;
  ShownScene shown_;
  PanelNumbers numbers_;
  Clock::time_point last_;
};

}  // namespace

int view_scene(const Scene& scene, const ViewOptions& options, const MakeSimulation& make_simulation) {
  SimulationOptions simulation;
  simulation.threads = options.run.threads;
  LiveScene live(scene, simulation, make_simulation);
  Show show(live, options);
  return show.run();
}

}  // namespace oilskin::demo
