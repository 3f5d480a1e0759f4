#include "page_api.h"

#include <cstdio>
#include <sstream>

#include "page_scene.h"
#include "scene/fields.h"

namespace {

using oilskin::demo::PageScene;

std::unique_ptr<PageScene> scene;
std::string message, text;

std::vector<std::string> lines(const char* settings) {
  std::istringstream in(settings);
  std::vector<std::string> all;
  for (std::string line; std::getline(in, line);)
    if (!line.empty()) all.push_back(line);
  return all;
}

template <class F>
int attempt(const F& f) {
  message.clear();
  try {
    f();
  } catch (const std::exception& e) {
    message = e.what();
    if (message.empty()) message = "refused";
    return 0;
  }
  return 1;
}

PageScene& opened() {
  if (!scene) throw oilskin::demo::SceneError("no scene is open");
  return *scene;
}

/// The text that f returns; empty, with a message, without a scene.
template <class F>
const char* text_of(const F& f) {
  text.clear();
  attempt([&] { text = f(opened()); });
  return text.c_str();
}

/// The list that f returns, `per` numbers to an element; null, with a message, without a scene.
template <class F>
auto list_of(std::uint32_t* count, std::size_t per, const F& f) -> decltype(f(*scene).data()) {
  *count = 0;
  decltype(f(*scene).data()) data = nullptr;
  attempt([&] {
    const auto& list = f(opened());
    data = list.data();
    *count = static_cast<std::uint32_t>(list.size() / per);
  });
  return data;
}

}  // namespace

extern "C" {

int page_open(const char* scene_text, const char* settings) {
  return attempt([&] { scene = std::make_unique<PageScene>(scene_text, lines(settings)); });
}

int page_step(int count) {
  return attempt([&] {
    for (int i = 0; i < count; ++i) opened().step();
  });
}

int page_set_contact(int on) {
  return attempt([&] { opened().set_contact(on != 0); });
}

int page_grab(double x, double y, double z) {
  return attempt([&] { opened().grab({x, y, z}); });
}

int page_pull(double x, double y, double z) {
  return attempt([&] { opened().pull({x, y, z}); });
}

int page_release() {
  return attempt([&] { opened().release(); });
}

int page_aim(double x, double y, double z) {
  return attempt([&] { opened().aim({x, y, z}); });
}

int page_steps() {
  return scene ? static_cast<int>(scene->counts().steps) : 0;
}

const char* page_message() {
  return message.c_str();
}

const char* page_report() {
  return text_of([](const PageScene& s) { return s.report(); });
}

const char* page_description() {
  return text_of([](const PageScene& s) { return s.description(); });
}

const char* page_state_hash() {
  return text_of([](const PageScene& s) {
    char digits[19];
    std::snprintf(digits, sizeof digits, "0x%016llx", static_cast<unsigned long long>(s.state_hash()));
    return std::string(digits);
  });
}

const float* page_particles(uint32_t* count) {
  return list_of(count, 4, [](PageScene& s) -> const std::vector<float>& { return s.particles(); });
}

const float* page_nodes(uint32_t* count) {
  return list_of(count, 3, [](PageScene& s) -> const std::vector<float>& { return s.nodes(); });
}

const uint32_t* page_triangles(uint32_t* count) {
  return list_of(count, 3, [](PageScene& s) -> const std::vector<std::uint32_t>& { return s.triangles(); });
}

}  // extern "C"
