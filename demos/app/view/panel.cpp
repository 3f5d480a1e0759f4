#include "view/panel.h"

#include <imgui.h>

#include <algorithm>
#include <cstdio>

#include "scene/views.h"

namespace oilskin::demo {
namespace {

constexpr float width_of_panel = panel_width, bar_height = 18;  // [pixels]

using Places = std::map<std::string, std::array<float, 2>>;

void obey(Viewer& viewer, const std::string& command) {
  if (const Status status = viewer.obey(command); !status.ok()) viewer.say(status.message);
}

void note_place(Places& places, const std::string& key) {
  const ImVec2 min = ImGui::GetItemRectMin(), max = ImGui::GetItemRectMax();
  const float height = max.y - min.y;
  places[key] = {min.x + 0.5f * height, min.y + 0.5f * height};
}

/// A button that obeys a command.
void button(Viewer& viewer, Places& places, const char* label, const char* command) {
  if (ImGui::Button(label)) obey(viewer, command);
  note_place(places, command);
}

void draw_state(const Viewer& viewer, const PanelNumbers& numbers) {
  const LiveScene& live = viewer.live();
  ImGui::Text("%s   t = %.3f s   step %llu", live.scene().name.c_str(), live.time(),
              static_cast<unsigned long long>(live.counts().steps));
  ImGui::Text("%zu particles   %.0f fps   %.2gx real time", live.world().particle_count(),
              numbers.frames_per_second, numbers.real_time);
  const bool verifies = live.scene().contact.verify;
  if (verifies && live.counts().crossings > 0)
    ImGui::TextColored({0.8f, 0.1f, 0.1f, 1}, "%llu crossings",
                       static_cast<unsigned long long>(live.counts().crossings));
  else
    ImGui::TextUnformatted(verifies ? "no crossing, every step checked"
                                    : "crossings are not counted (verify is off)");
}

void draw_time(Viewer& viewer, Places& places) {
  button(viewer, places, viewer.paused() ? "run" : "pause", "pause");
  ImGui::SameLine();
  button(viewer, places, "step", "step 1");
  ImGui::SameLine();
  button(viewer, places, "restart", "restart");
  ImGui::SameLine();
  button(viewer, places, "picture", "screenshot");
  float speed = static_cast<float>(viewer.speed());
  if (ImGui::SliderFloat("speed", &speed, 0.01f, 1, "%.3g", ImGuiSliderFlags_Logarithmic))
    obey(viewer, "speed " + std::to_string(speed));
}

/// One word of several.
template <class E>
void choices(Viewer& viewer, Places& places, const char* command, E current,
             std::initializer_list<const char*> words) {
  ImGui::AlignTextToFramePadding();
  ImGui::TextUnformatted(command);
  int number = 0;
  for (const char* word : words) {
    ImGui::SameLine(number == 0 ? 62.0f : 0.0f);
    const std::string text = std::string(command) + " " + word;
    if (ImGui::RadioButton((std::string(word) + "##" + command).c_str(), static_cast<int>(current) == number))
      obey(viewer, text);
    note_place(places, text);
    ++number;
  }
}

/// The colours of the water from left to right, with the ends of their scale.
void draw_legend(const ColourScale& scale) {
  ImDrawList* list = ImGui::GetWindowDrawList();
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float width = width_of_panel - 30, part = width / 5;
  const auto colour = [](int i) {
    const double* c = water_colour_stops[i];
    return ImGui::GetColorU32(
        {static_cast<float>(c[0]), static_cast<float>(c[1]), static_cast<float>(c[2]), 1});
  };
  for (int i = 0; i < 5; ++i) {
    const float x = at.x + part * static_cast<float>(i);
    list->AddRectFilledMultiColor({x, at.y}, {x + part, at.y + 10}, colour(i), colour(i + 1), colour(i + 1),
                                  colour(i));
  }
  ImGui::Dummy({width, 12});
  ImGui::Text("%.4g to %.4g   %s", scale.from, scale.to, scale.title);
}

void draw_looks(Viewer& viewer, Places& places) {
  const ShowOptions& shown = viewer.shown();
  choices(viewer, places, "water", shown.water, {"balls", "surface", "clear", "none"});
  choices(viewer, places, "colour", shown.colour, {"speed", "pressure", "density"});
  choices(viewer, places, "bodies", shown.bodies, {"solid", "clear", "hidden"});
  choices(viewer, places, "cut", shown.cut, {"off", "on"});
  ImGui::TextUnformatted("view");
  for (std::size_t k = 0; k < viewer.views().size(); ++k) {
    ImGui::SameLine(k == 0 ? 62.0f : 0.0f);
    if (ImGui::SmallButton(std::to_string(k).c_str())) obey(viewer, "view " + std::to_string(k));
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", viewer.views()[k].title.c_str());
  }
  draw_legend(colour_scale(viewer.live().scene(), shown.colour));
}

void draw_toggle(Viewer& viewer, const Switch& row, int choice) {
  bool is_on = choice == 1;
  if (ImGui::Checkbox(row.label, &is_on))
    obey(viewer, "set " + assignment_of(row, is_on ? 1 : 0, viewer.live().original()));
}

void draw_combo(Viewer& viewer, const Switch& row, int choice) {
  std::string shown = choice < 0 ? "other" : row.choices[static_cast<std::size_t>(choice)];
  shown.erase(std::remove(shown.begin(), shown.end(), '"'), shown.end());
  ImGui::SetNextItemWidth(120);
  if (!ImGui::BeginCombo(row.label, shown.c_str())) return;
  for (int k = 0; k < static_cast<int>(row.choices.size()); ++k)
    if (ImGui::Selectable(row.choices[static_cast<std::size_t>(k)], k == choice))
      obey(viewer, "set " + assignment_of(row, k, viewer.live().original()));
  ImGui::EndCombo();
}

void draw_switches(Viewer& viewer, Places& places, SwitchGroup group, const char* title) {
  if (!ImGui::CollapsingHeader(title, ImGuiTreeNodeFlags_DefaultOpen)) return;
  int column = 0;
  for (const Switch& row : switches()) {
    if (row.group != group) continue;
    const int choice = choice_in(row, viewer.live().settings());
    if (row.is_toggle && column % 2 == 1) ImGui::SameLine(0.5f * width_of_panel);
    row.is_toggle ? draw_toggle(viewer, row, choice) : draw_combo(viewer, row, choice);
    note_place(places, row.key);
    column = row.is_toggle ? column + 1 : 0;
  }
}

void draw_bar(const std::vector<CostPart>& parts, const char* title) {
  const double sum = sum_of(parts);
  ImGui::Text("%s %.1f ms", title, 1e3 * sum);
  ImDrawList* list = ImGui::GetWindowDrawList();
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float width = width_of_panel - 30;
  float x = at.x;
  for (const CostPart& part : parts) {
    const float w = sum > 0 ? width * static_cast<float>(part.seconds / sum) : 0;
    const ImU32 colour = IM_COL32(part.colour[0], part.colour[1], part.colour[2], 255);
    list->AddRectFilled({x, at.y}, {x + w, at.y + bar_height}, colour);
    x += w;
  }
  ImGui::Dummy({width, bar_height});
}

/// Names and times beside squares of their colours, in two columns.
void draw_names(const std::vector<CostPart>& parts) {
  ImDrawList* list = ImGui::GetWindowDrawList();
  int column = 0;
  for (const CostPart& part : parts) {
    if (part.seconds <= 0) continue;
    if (column % 2 == 1) ImGui::SameLine(0.5f * width_of_panel);
    const ImVec2 at = ImGui::GetCursorScreenPos();
    list->AddRectFilled({at.x, at.y + 2}, {at.x + 10, at.y + 12},
                        IM_COL32(part.colour[0], part.colour[1], part.colour[2], 255));
    ImGui::Dummy({12, 12});
    ImGui::SameLine();
    ImGui::Text("%s %.2f", part.name, 1e3 * part.seconds);
    ++column;
  }
}

void draw_costs(const Viewer& viewer, const PanelNumbers& numbers) {
  if (!ImGui::CollapsingHeader("costs [ms]", ImGuiTreeNodeFlags_DefaultOpen)) return;
  const std::vector<CostPart> step = cost_parts(viewer.live().costs()), frame = cost_parts(numbers.frame);
  draw_bar(step, "step");
  draw_names(step);
  draw_bar(frame, "frame");
  draw_names(frame);
}

void draw_notes(const Viewer& viewer, const PanelNumbers& numbers) {
  ImGui::PushTextWrapPos(width_of_panel - 15);
  if (!viewer.message().empty()) ImGui::TextUnformatted(viewer.message().c_str());
  if (!numbers.mesh_refusal.empty()) ImGui::Text("no water mesh: %s", numbers.mesh_refusal.c_str());
  for (const std::string& text : flag_texts(viewer.live().counts().flags))
    ImGui::TextDisabled("flag: %s", text.c_str());
  ImGui::PopTextWrapPos();
}

}  // namespace

Places draw_panel(Viewer& viewer, const PanelNumbers& numbers) {
  Places places;
  if (!viewer.panel()) return places;
  ImGui::SetNextWindowPos({0, 0}, ImGuiCond_Always);
  ImGui::SetNextWindowSize({width_of_panel, static_cast<float>(viewer.height())}, ImGuiCond_Always);
  ImGui::SetNextWindowBgAlpha(0.82f);
  ImGui::Begin("oilskin", nullptr,
               ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize);
  draw_state(viewer, numbers);
  draw_time(viewer, places);
  ImGui::Separator();
  draw_looks(viewer, places);
  draw_switches(viewer, places, SwitchGroup::effects, "effects");
  draw_switches(viewer, places, SwitchGroup::contact, "contact");
  draw_switches(viewer, places, SwitchGroup::fluid, "fluid (the scene begins again)");
  draw_costs(viewer, numbers);
  draw_notes(viewer, numbers);
  ImGui::End();
  return places;
}

}  // namespace oilskin::demo
