// A virtual X server, the window in it, and real mouse and key events.
#pragma once

#include <sys/types.h>

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/program.h"

namespace oilskin::test {

/// Three bytes per pixel, rows from above.
struct Picture {
  int width = 0, height = 0;
  std::vector<unsigned char> rgb;

  /// The number of pixels right of `from_x` whose colour passes.
  int count(const std::function<bool(int r, int g, int b)>& passes, int from_x = 345) const;
};

/// Reads a PNG file; an empty picture where that fails.
Picture read_picture(const std::string& path);

/// The colours of the water, and those of cloth.
bool is_water(int r, int g, int b);
bool is_cloth(int r, int g, int b);

class Display {
 public:
  Display();
  ~Display();
  Display(const Display&) = delete;
  Display& operator=(const Display&) = delete;
  /// `:N`; empty where no server started.
  const std::string& name() const { return name_; }

 private:
  pid_t server_ = 0;
  std::string name_;
};

/// `oilskin view` in a display.
class ViewWindow {
 public:
  ViewWindow(const Display& display, const std::vector<std::string>& arguments);
  ~ViewWindow();
  ViewWindow(const ViewWindow&) = delete;
  ViewWindow& operator=(const ViewWindow&) = delete;

  /// The last line of the log; null before the first.
  nlohmann::json now() const;
  /// Waits until a line passes, for a minute at most, and returns it; null where none did.
  nlohmann::json until(const std::function<bool(const nlohmann::json&)>& passes) const;
  /// Waits for so many more frames.
  nlohmann::json after_frames(int count) const;
  /// xdotool ARGUMENTS, after the window has the keyboard.
  void events(const std::string& arguments) const;
  void key(const std::string& name) const { events("key " + name); }
  void click(double x, double y) const;
  /// Waits for the end; the exit code, or 128 + the signal.
  int wait();
  bool runs() const;
  const Folder& folder() const { return folder_; }

 private:
  std::string display_;
  Folder folder_;
  pid_t program_ = 0;
};

}  // namespace oilskin::test
