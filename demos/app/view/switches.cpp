#include "view/switches.h"

#include <algorithm>

namespace oilskin::demo {
namespace {

/// The effects of `oilskin effects`, for scenes that have others or none.
constexpr const char* default_wetting = R"({"textile": "cotton"})";
constexpr const char* default_tension = R"({"coefficient": 0.0728, "contact_angle": 60})";
constexpr const char* default_viscosity = R"({"coefficient": 0.01})";

bool begins(const std::string& text, const std::string& with) {
  return text.compare(0, with.size(), with) == 0;
}

}  // namespace

const std::vector<Switch>& switches() {
  using G = SwitchGroup;
  static const std::vector<Switch> all = {
      {G::effects, "wetting", "effects.wetting", {"null", default_wetting}},
      {G::effects, "surface tension", "effects.surface_tension", {"null", default_tension}},
      {G::effects, "implicit viscosity", "effects.viscosity", {"null", default_viscosity}},
      {G::contact, "continuous test", "contact.ccd", {"false", "true"}},
      {G::contact, "impact zones", "contact.zones", {"false", "true"}},
      {G::contact, "repulsion", "contact.repulsion", {"\"split\"", "\"bridson\"", "\"none\""}, false},
      {G::contact, "closed in", "contact.infeasible", {"\"stall\"", "\"remove\"", "\"allow\""}, false},
      {G::contact, "verify", "contact.verify", {"false", "true"}},
      {G::fluid, "solver", "fluid.solver", {"\"dfsph\"", "\"pcisph\"", "\"mcg03\""}, false},
      {G::fluid, "walls", "fluid.boundary", {"\"mirrored\"", "\"contact_only\""}, false},
      {G::fluid, "occlusion", "fluid.occlusion", {"false", "true"}},
      {G::fluid, "contact-aware", "fluid.contact_aware", {"false", "true"}},
  };
  return all;
}

Change change_of(const std::string& key) {
  for (const char* live : {"effects", "contact", "surface", "pictures"})
    if (key == live || begins(key, std::string(live) + ".")) return Change::live;
  return key == "gravity" || key == "max_particles" || key == "step_budget" ? Change::live : Change::restart;
}

Json value_at(const Json& scene, const std::string& key) {
  const Json* at = &scene;
  for (std::size_t begin = 0; begin <= key.size();) {
    const std::size_t end = std::min(key.find('.', begin), key.size());
    const std::string name = key.substr(begin, end - begin);
    begin = end + 1;
    if (!at->is_object() || !at->contains(name)) return {};
    at = &(*at)[name];
  }
  return *at;
}

int choice_in(const Switch& row, const Json& scene) {
  const Json value = value_at(scene, row.key);
  for (std::size_t i = 0; i < row.choices.size(); ++i)
    if (value == Json::parse(row.choices[i])) return static_cast<int>(i);
  return row.group == SwitchGroup::effects && value.is_object() ? 1 : -1;
}

std::string assignment_of(const Switch& row, int choice, const Json& original) {
  const Json own = value_at(original, row.key);
  const bool takes_own = row.group == SwitchGroup::effects && choice == 1 && own.is_object();
  const std::string value = takes_own ? own.dump() : row.choices[static_cast<std::size_t>(choice)];
  return std::string(row.key) + "=" + value;
}

}  // namespace oilskin::demo
