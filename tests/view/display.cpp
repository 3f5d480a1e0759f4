#include "view/display.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <png.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>

namespace oilskin::test {
namespace {

using nlohmann::json;

constexpr int longest_wait = 60;  // [s]

/// Ends a child and waits for it.
void end(pid_t child) {
  if (child <= 0) return;
  if (kill(child, SIGTERM) == 0) waitpid(child, nullptr, 0);
}

[[noreturn]] void become_server(const std::string& name) {
  const int nowhere = open("/dev/null", O_WRONLY);
  dup2(nowhere, 1);
  dup2(nowhere, 2);
  execl(OILSKIN_XVFB, "Xvfb", name.c_str(), "-screen", "0", "1280x800x24", "-noreset", "-nolisten", "tcp",
        nullptr);
  _exit(127);
}

/// Whether this server, and no other of the same name, takes clients.
bool answers(const std::string& name, pid_t server) {
  const std::string question = "DISPLAY=" + name + " " OILSKIN_XDOTOOL " getdisplaygeometry >/dev/null 2>&1";
  for (int k = 0; k < 50 && waitpid(server, nullptr, WNOHANG) == 0; ++k) {
    usleep(200000);
    if (std::system(question.c_str()) == 0) return waitpid(server, nullptr, WNOHANG) == 0;
  }
  return false;
}

}  // namespace

int Picture::count(const std::function<bool(int, int, int)>& passes, int from_x) const {
  int sum = 0;
  for (int y = 0; y < height; ++y)
    for (int x = from_x; x < width; ++x) {
      const unsigned char* p = &rgb[3 * (std::size_t(y) * std::size_t(width) + std::size_t(x))];
      sum += passes(p[0], p[1], p[2]);
    }
  return sum;
}

Picture read_picture(const std::string& path) {
  png_image image = {};
  image.version = PNG_IMAGE_VERSION;
  if (png_image_begin_read_from_file(&image, path.c_str()) == 0) return {};
  image.format = PNG_FORMAT_RGB;
  Picture picture{int(image.width), int(image.height), std::vector<unsigned char>(PNG_IMAGE_SIZE(image))};
  if (png_image_finish_read(&image, nullptr, picture.rgb.data(), 0, nullptr) == 0) return {};
  return picture;
}

bool is_water(int r, int g, int b) {
  return b > r + 40 && b > g + 8;
}

bool is_cloth(int r, int g, int b) {
  return r > b + 35 && r > g + 12;
}

Display::Display() {
  // The first number from there on that is free.
  const int first = 100 + getpid() % 400;
  for (int number = first; number < first + 20 && name_.empty(); ++number) {
    const std::string name = ":" + std::to_string(number);
    server_ = fork();
    if (server_ == 0) become_server(name);
    if (answers(name, server_))
      name_ = name;
    else
      end(server_);
  }
}

Display::~Display() {
  end(server_);
}

ViewWindow::ViewWindow(const Display& display, const std::vector<std::string>& arguments)
    : display_(display.name()) {
  std::vector<std::string> all = {OILSKIN_PROGRAM, "view"};
  all.insert(all.end(), arguments.begin(), arguments.end());
  all.insert(all.end(), {"--log", folder_.path("log"), "--threads", "2"});
  program_ = fork();
  if (program_ != 0) return;
  setenv("DISPLAY", display_.c_str(), 1);
  setenv("LIBGL_ALWAYS_SOFTWARE", "1", 1);
  if (chdir(folder_.path().c_str()) != 0) _exit(126);
  dup2(open(folder_.path("err").c_str(), O_CREAT | O_WRONLY | O_TRUNC, 0600), 2);
  std::vector<char*> argv;
  for (std::string& a : all) argv.push_back(a.data());
  argv.push_back(nullptr);
  execv(argv[0], argv.data());
  _exit(127);
}

ViewWindow::~ViewWindow() {
  end(program_);
}

bool ViewWindow::runs() const {
  return program_ > 0 && kill(program_, 0) == 0 && waitpid(program_, nullptr, WNOHANG | WNOWAIT) == 0;
}

json ViewWindow::now() const {
  const std::string log = folder_.read("log");
  const std::size_t last = log.rfind('\n');
  if (last == std::string::npos || last == 0) return {};
  const std::size_t before = log.rfind('\n', last - 1);
  const std::size_t begin = before == std::string::npos ? 0 : before + 1;
  return json::parse(log.substr(begin, last - begin), nullptr, false);
}

json ViewWindow::until(const std::function<bool(const json&)>& passes) const {
  for (int k = 0; k < 50 * longest_wait; ++k) {
    const json line = now();
    if (line.is_object() && passes(line)) return line;
    usleep(20000);
  }
  ADD_FAILURE() << "nothing of the kind within " << longest_wait << " s; the last line is " << now().dump()
                << "\n"
                << folder_.read("err");
  return {};
}

json ViewWindow::after_frames(int count) const {
  const json line = until([](const json&) { return true; });
  if (!line.is_object()) return {};
  const int frame = line["frame"].get<int>() + count;
  return until([&](const json& later) { return later["frame"].get<int>() >= frame; });
}

void ViewWindow::events(const std::string& arguments) const {
  const std::string xdotool = "DISPLAY=" + display_ + " " OILSKIN_XDOTOOL " ";
  const std::string focus = xdotool + "search --sync --name 'oilskin: ' windowfocus --sync >/dev/null 2>&1; ";
  EXPECT_EQ(std::system((focus + xdotool + arguments).c_str()), 0) << arguments;
}

void ViewWindow::click(double x, double y) const {
  const std::string place = std::to_string(int(x)) + " " + std::to_string(int(y));
  events("mousemove --sync " + place);
  after_frames(3);  // the panel looks at the place before the button
  events("mousedown 1");
  after_frames(3);
  events("mouseup 1");
}

int ViewWindow::wait() {
  int status = 0;
  waitpid(program_, &status, 0);
  program_ = 0;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace oilskin::test
