/// The settings that the window changes while a scene runs.
#pragma once

#include <string>
#include <vector>

#include "scene/fields.h"

namespace oilskin::demo {

/// What a change of a setting needs.
enum class Change {
  live,    ///< acts from the next step on
  restart  ///< the scene begins again
};

enum class SwitchGroup { effects, contact, fluid };

/// One row of the panel: a key of the scene file.
struct Switch {
  SwitchGroup group;
  const char* label;
  const char* key;                   ///< by its dotted path
  std::vector<const char*> choices;  ///< JSON texts; the first two are off and on where `is_toggle`
  bool is_toggle = true;
};

/// Every switch, in the order of the panel.
const std::vector<Switch>& switches();

/// What a change of a key needs, for any key of a scene.
Change change_of(const std::string& key);

/// The value at a dotted path; null where there is none.
Json value_at(const Json& scene, const std::string& key);

/// Which of its choices a switch has in a scene, as the scene is written by write_scene(); −1 = none of them,
/// but an effect with other settings counts as on.
int choice_in(const Switch& row, const Json& scene);

/// `key=value` for a choice. An effect that is switched on gets the settings that it has in `original`, the
/// scene as it was loaded, where it has some.
std::string assignment_of(const Switch& row, int choice, const Json& original);

}  // namespace oilskin::demo
