#include <algorithm>
#include <cmath>
#include <sstream>

#include "view/viewer.h"

namespace oilskin::demo {
namespace {

constexpr double pi = 3.14159265358979323846;
constexpr double slowest = 1e-4;  // speed

/// Exactly `count` numbers; empty where there are others.
std::vector<double> numbers_of(const std::string& text, std::size_t count) {
  std::istringstream in(text);
  std::vector<double> numbers;
  for (double value = 0; in >> value;) numbers.push_back(value);
  if (!in.eof() || numbers.size() != count) return {};
  for (const double value : numbers)
    if (!std::isfinite(value)) return {};
  return numbers;
}

/// The place of a word in a list; −1 = not there.
int place_of(const std::string& word, const std::vector<std::string>& words) {
  for (std::size_t i = 0; i < words.size(); ++i)
    if (words[i] == word) return static_cast<int>(i);
  return -1;
}

Status needs(const std::string& command, const std::string& what) {
  return Status::refused(command + ": needs " + what);
}

/// Sets a choice by its word, or by `next`.
template <class E>
Status choose_of(const std::string& command, const std::string& word, const std::vector<std::string>& words,
                 E& choice) {
  const int count = static_cast<int>(words.size());
  const int place = word == "next" ? (static_cast<int>(choice) + 1) % count : place_of(word, words);
  std::string all = "one of next";
  for (const std::string& known : words) all.append(", ").append(known);
  if (place < 0) return needs(command, all);
  choice = static_cast<E>(place);
  return Status::accepted();
}

struct Key {
  const char* name;
  const char* command;
};

constexpr Key keys[] = {{"space", "pause"},     {"s", "step 1"},         {"r", "restart"},
                        {"-", "speed /2"},      {"=", "speed *2"},       {"1", "water balls"},
                        {"2", "water surface"}, {"3", "water clear"},    {"4", "water none"},
                        {"v", "view next"},     {"x", "cut next"},       {"b", "bodies next"},
                        {"h", "panel next"},    {"p", "screenshot"},     {"q", "quit"},
                        {"escape", "quit"},     {"left", "nozzle -3 0"}, {"right", "nozzle 3 0"},
                        {"up", "nozzle 0 3"},   {"down", "nozzle 0 -3"}, {"n", "nozzle next"}};

}  // namespace

void Viewer::press(const std::string& key) {
  for (const Key& known : keys)
    if (key == known.name)
      if (const Status status = obey(known.command); !status.ok()) message_ = status.message;
}

Status Viewer::obey(const std::string& text) {
  std::istringstream in(text);
  std::string word, rest;
  in >> word;
  std::getline(in >> std::ws, rest);
  if (word == "set") return set(rest);
  if (word == "step") return step(rest);
  if (word == "speed") return set_speed(rest);
  if (word == "view") return look_from(rest);
  if (word == "grab" || word == "grab_static") return grab_at(text);
  if (word == "drag") return drag_to(rest);
  if (word == "nozzle") return steer(rest);
  if (word == "orbit" || word == "zoom") return turn(text);
  if (word == "screenshot") {
    const std::string number = std::to_string(screenshots_++);
    screenshot_ = rest.empty() ? live_.scene().name + "_" + number + ".png" : rest;
    return Status::accepted();
  }
  if (!rest.empty()) return choose(word, rest);
  return obey_word(word);
}

Status Viewer::obey_word(const std::string& word) {
  if (word == "pause") {
    paused_ = !paused_;
  } else if (word == "run" || word == "stop") {
    paused_ = word == "stop";
  } else if (word == "restart") {
    live_.restart();
    due_ = 0;
  } else if (word == "release") {
    let_go();
  } else if (word == "quit") {
    quits_ = true;
  } else {
    return choose(word, "");
  }
  return Status::accepted();
}

Status Viewer::set(const std::string& assignment) {
  Change made = Change::live;
  Status status = live_.change(assignment, &made);
  if (!status.ok()) return status;
  if (made == Change::restart) due_ = 0;
  message_ = assignment + (made == Change::restart ? ": the scene began again" : "");
  return status;
}

Status Viewer::step(const std::string& count) {
  const std::vector<double> n = count.empty() ? std::vector<double>{1} : numbers_of(count, 1);
  if (n.empty() || n[0] < 1 || n[0] > 1e6 || n[0] != std::floor(n[0]))
    return needs("step", "a whole number of steps, 1 to 1000000");
  paused_ = true;
  for (int k = 0; k < static_cast<int>(n[0]); ++k) live_.step();
  return Status::accepted();
}

Status Viewer::look_from(const std::string& number) {
  if (number == "next") {
    use_view((view_ + 1) % views_.size());
    return Status::accepted();
  }
  const std::vector<double> n = numbers_of(number, 1);
  if (n.empty() || n[0] < 0 || n[0] >= static_cast<double>(views_.size()) || n[0] != std::floor(n[0]))
    return needs("view", "next, or the number of a view, 0 to " + std::to_string(views_.size() - 1));
  use_view(static_cast<std::size_t>(n[0]));
  return Status::accepted();
}

Status Viewer::grab_at(const std::string& text) {
  const std::string word = text.substr(0, text.find(' '));
  const std::vector<double> pixel = numbers_of(text.substr(std::min(text.size(), word.size())), 2);
  if (pixel.empty()) return needs(word, "a pixel: two numbers");
  if (!grab(pixel[0], pixel[1], word == "grab_static"))
    return Status::refused(word + ": there is nothing at this pixel that can be held");
  return Status::accepted();
}

Status Viewer::drag_to(const std::string& text) {
  const std::vector<double> pixel = numbers_of(text, 2);
  if (pixel.empty()) return needs("drag", "a pixel: two numbers");
  drag(pixel[0], pixel[1]);
  return Status::accepted();
}

Status Viewer::turn(const std::string& text) {
  const bool orbits = text.compare(0, 5, "orbit") == 0;
  const std::vector<double> n = numbers_of(text.substr(orbits ? 5 : 4), orbits ? 2 : 1);
  if (orbits && n.empty()) return needs("orbit", "two angles [degrees]: sideways and upwards");
  if (!orbits && (n.empty() || n[0] <= 0)) return needs("zoom", "a factor > 0 of the distance");
  orbits ? camera_.orbit(n[0] * pi / 180, n[1] * pi / 180) : camera_.zoom(n[0]);
  return Status::accepted();
}

/// By angles as seen from the camera: the jet goes where the arrow of the key points.
Status Viewer::steer(const std::string& text) {
  const std::vector<Nozzle> nozzles = live_.simulation().nozzles();
  if (nozzles.empty()) return Status::refused("nozzle: the scene has none");
  if (text == "next") {
    nozzle_ = (nozzle_ + 1) % nozzles.size();
    message_ = "nozzle " + std::to_string(nozzle_);
    return Status::accepted();
  }
  const std::vector<double> n = numbers_of(text, 2);
  if (n.empty()) return needs("nozzle", "next, or two angles [degrees]: to the right and upwards");
  nozzle_ = std::min(nozzle_, nozzles.size() - 1);
  const Vec3 d = nozzles[nozzle_].direction;
  const Vec3 to = n[0] * camera_.axes().col(0) + n[1] * camera_.axes().col(1);
  const Vec3 axis = d.cross(to);
  if (!(axis.norm() > 1e-6 * to.norm())) return Status::accepted();  // it points there already
  return live_.aim_nozzle(nozzle_, Eigen::AngleAxisd(to.norm() * pi / 180, axis.normalized()) * d);
}

Status Viewer::set_speed(const std::string& value) {
  const bool scales = value == "*2" || value == "/2";
  std::vector<double> n = numbers_of(value, 1);
  if (scales) n = {value == "*2" ? 2 * speed_ : 0.5 * speed_};
  if (n.empty() || !(n[0] > 0)) return needs("speed", "a number > 0, *2 or /2");
  speed_ = std::clamp(n[0], slowest, 1.0);
  return Status::accepted();
}

Status Viewer::choose(const std::string& word, const std::string& value) {
  if (word == "water") return choose_of(word, value, {"balls", "surface", "clear", "none"}, shown_.water);
  if (word == "colour") return choose_of(word, value, {"speed", "pressure", "density"}, shown_.colour);
  if (word == "bodies") return choose_of(word, value, {"solid", "clear", "hidden"}, shown_.bodies);
  if (word == "cut") return choose_of(word, value, {"off", "on"}, shown_.cut);
  if (word == "panel") return choose_of(word, value, {"off", "on"}, panel_);
  return Status::refused("\"" + word + "\" is no command: see docs/manual/window.md");
}

std::vector<ScriptLine> parse_script(const std::string& text, const std::string& name) {
  std::vector<ScriptLine> script;
  std::istringstream in(text);
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    line = line.substr(0, line.find('#'));
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    std::istringstream words(line);
    ScriptLine made;
    const std::string where = name + ", line " + std::to_string(number) + ": ";
    std::string frame;
    words >> frame;
    if (frame.find_first_not_of("0123456789") != std::string::npos || frame.size() > 18)
      throw SceneError(where + "must begin with the number of a frame, from 0");
    made.frame = std::stoull(frame);
    std::getline(words >> std::ws, made.command);
    made.command.erase(made.command.find_last_not_of(" \t\r") + 1);
    if (made.command.empty()) throw SceneError(where + "has no command after the number of the frame");
    if (!script.empty() && made.frame < script.back().frame)
      throw SceneError(where + "frame " + std::to_string(made.frame) + " comes after frame " +
                       std::to_string(script.back().frame));
    script.push_back(made);
  }
  return script;
}

}  // namespace oilskin::demo
