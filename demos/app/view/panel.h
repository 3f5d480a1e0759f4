/// The panel of the window: buttons, switches, bars.
#pragma once

#include <map>
#include <string>

#include "view/costs.h"
#include "view/viewer.h"

namespace oilskin::demo {

struct PanelNumbers {
  FrameCosts frame;
  double frames_per_second = 0;
  double real_time = 0;  ///< simulated over wall time, as reached
  std::string mesh_refusal;
};

/// Draws the panel into ImGui's frame. Returns the middle of each switch [pixels], by its key.
std::map<std::string, std::array<float, 2>> draw_panel(Viewer& viewer, const PanelNumbers& numbers);

}  // namespace oilskin::demo
