/// Draws a moment of a run: two views or more side by side, into a window or off screen.
#pragma once

#include <memory>
#include <string>

#include "output/frames.h"

namespace oilskin::demo {

class Picture {
 public:
  Picture(const Scene& scene, bool window);
  ~Picture();

  void show(const FrameData& data);
  /// The last moment shown, as PNG, while its data lives. Throws OutputError.
  void save(const std::string& path);
  bool window_open() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace oilskin::demo
