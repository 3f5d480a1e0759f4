/// What the window does, without the window: its state, and the commands of keys, panel and script.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "view/camera.h"
#include "view/live_scene.h"
#include "view/pick.h"
#include "view/shown_scene.h"

namespace oilskin::demo {

/// A line of a script.
struct ScriptLine {
  std::uint64_t frame = 0;  ///< before the drawing of which it is obeyed
  std::string command;
};

/// Lines `FRAME COMMAND`, in ascending order of frames; # begins a comment. `name` stands in messages. Throws
/// SceneError for lines that are no such line. The commands are not checked.
std::vector<ScriptLine> parse_script(const std::string& text, const std::string& name);

/// Of the panel [pixels].
constexpr int panel_width = 345;

class Viewer {
 public:
  Viewer(LiveScene& live, int width, int height);

  // --- commands
  /// Obeys a command (docs/manual/window.md lists them). A refusal says what is wrong, and changes nothing.
  Status obey(const std::string& command);
  /// The same for a key; an unknown key is ignored. `key`: a letter or a name of the list in
  /// docs/manual/window.md.
  void press(const std::string& key);

  // --- mouse, in pixels from the upper left corner
  /// Takes hold of what lies there. False where nothing does that can be held; static bodies can only with
  /// `even_static`.
  bool grab(double x, double y, bool even_static);
  /// Through a pixel of the window.
  Ray ray(double x, double y) const;
  void drag(double x, double y);
  void let_go();
  void orbit(double dx, double dy);
  void pan(double dx, double dy);
  void zoom(double steps);
  void resize(int width, int height);

  // --- time
  /// As many steps as `wall` seconds ask for at this speed, but none once `budget` seconds have passed
  /// (at least one, where one is due). Throws SceneError where a step is refused.
  void advance(double wall, double budget);

  LiveScene& live() { return live_; }
  const LiveScene& live() const { return live_; }
  const OrbitCamera& camera() const { return camera_; }
  ShowOptions& shown() { return shown_; }
  const ShowOptions& shown() const { return shown_; }
  /// Where the picture of the scene begins: beside the panel, where there is space for both [pixels].
  int left() const;
  int width() const { return width_; }
  int height() const { return height_; }
  bool paused() const { return paused_; }
  double speed() const { return speed_; }  ///< simulated over wall time, at most
  bool panel() const { return panel_; }
  bool wants_to_quit() const { return quits_; }
  const std::vector<View>& views() const { return views_; }
  std::size_t view() const { return view_; }
  /// What the last command had to say: a refusal, or what was done.
  const std::string& message() const { return message_; }
  void say(const std::string& message) { message_ = message; }
  /// The file of a screenshot that was asked for; empty = none. Asked once.
  std::string take_screenshot();

 private:
  Status obey_word(const std::string& word);
  Status set(const std::string& assignment);
  Status step(const std::string& count);
  Status look_from(const std::string& number);
  Status grab_at(const std::string& pixel);
  Status drag_to(const std::string& pixel);
  Status turn(const std::string& angles);
  Status steer(const std::string& angles);
  Status set_speed(const std::string& value);
  Status choose(const std::string& word, const std::string& value);
  void use_view(std::size_t number);

  LiveScene& live_;
  std::vector<View> views_;
  std::size_t view_ = 0, nozzle_ = 0;
  OrbitCamera camera_;
  ShowOptions shown_;
  int width_, height_;
  bool paused_ = false, panel_ = true, quits_ = false;
  double speed_ = 1, due_ = 0;  ///< `due_`: simulated time that is to be made up [s]
  Vec3 plane_point_ = Vec3::Zero(), plane_normal_ = Vec3::Zero();  ///< in which a drag moves
  std::string message_, screenshot_;
  int screenshots_ = 0;
};

}  // namespace oilskin::demo
