#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "output/effect_table.h"

namespace oilskin::demo {
namespace {

// All lengths are in pixels.
constexpr double panel_width = 400, panel_height = 300, margin_left = 56, margin_top = 64, margin_bottom = 48;
constexpr const char *dark = "#b3541e", *light = "#7fa8c9";

std::string format(const char* pattern, double value) {
  std::array<char, 48> text{};
  std::snprintf(text.data(), text.size(), pattern, value);
  return text.data();
}

std::string escaped(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    if (c == '&')
      safe += "&amp;";
    else if (c == '<')
      safe += "&lt;";
    else
      safe += c;
  }
  return safe;
}

std::string rectangle(double x, double y, double width, double height, const std::string& colour) {
  return "<rect x=\"" + format("%.1f", x) + "\" y=\"" + format("%.1f", y) + "\" width=\"" +
         format("%.1f", width) + "\" height=\"" + format("%.1f", height) + "\" fill=\"" + colour + "\"/>\n";
}

std::string line(double x0, double y0, double x1, double y1, const std::string& colour) {
  return "<line x1=\"" + format("%.1f", x0) + "\" y1=\"" + format("%.1f", y0) + "\" x2=\"" +
         format("%.1f", x1) + "\" y2=\"" + format("%.1f", y1) + "\" stroke=\"" + colour + "\"/>\n";
}

std::string label(double x, double y, const std::string& anchor, int size, const std::string& text) {
  return "<text x=\"" + format("%.1f", x) + "\" y=\"" + format("%.1f", y) + "\" text-anchor=\"" + anchor +
         "\" font-size=\"" + std::to_string(size) + "\">" + escaped(text) + "</text>\n";
}

/// 1, 2 or 5 times a power of ten, so that `largest` has at most 6 of it.
double tick_of(double largest) {
  const double power = std::pow(10, std::floor(std::log10(largest / 5)));
  for (const double factor : {1., 2., 5.})
    if (largest <= 6 * factor * power) return factor * power;
  return 10 * power;
}

struct Bar {
  std::string name, note;
  Spread height;
  double part = 0;  // drawn dark
};

/// Bars over one axis that begins at 0.
class Panel {
 public:
  Panel(double x, const std::string& title, std::vector<Bar> bars)
      : left_(x + margin_left), title_(title), bars_(std::move(bars)) {
    double largest = 0;
    for (const Bar& bar : bars_) largest = std::max(largest, bar.height.max);
    tick_ = tick_of(largest > 0 ? largest : 1);
    top_ = tick_ * std::ceil(1.05 * std::max(largest, tick_) / tick_);
  }

  std::string draw() const {
    std::string text = label(left_, margin_top - 14, "start", 13, title_) + axis();
    for (std::size_t k = 0; k < bars_.size(); ++k) text += draw(bars_[k], k);
    return text;
  }

 private:
  static constexpr double width = panel_width - margin_left - 16;

  double y(double value) const { return margin_top + panel_height * (1 - value / top_); }

  std::string axis() const {
    std::string text;
    for (int k = 0; k * tick_ <= top_ * 1.001; ++k) {
      text += line(left_, y(k * tick_), left_ + width, y(k * tick_), "#ddd");
      text += label(left_ - 6, y(k * tick_) + 4, "end", 11, format("%g", k * tick_));
    }
    return text;
  }

  std::string draw(const Bar& bar, std::size_t k) const {
    const double step = width / static_cast<double>(bars_.size()), middle = left_ + (k + 0.5) * step;
    const double x = middle - 0.35 * step, high = y(bar.height.median), foot = y(0);
    const double split = y(std::min(bar.part, bar.height.median));
    std::string text = rectangle(x, high, 0.7 * step, split - high, light);
    if (bar.part > 0) text += rectangle(x, split, 0.7 * step, foot - split, dark);
    text += line(middle, y(bar.height.min), middle, y(bar.height.max), "black");
    text += label(middle, y(bar.height.max) - 5, "middle", 11, bar.note);
    return text + label(middle, foot + 16, "middle", 10, bar.name);
  }

  double left_, tick_ = 1, top_ = 1;
  std::string title_;
  std::vector<Bar> bars_;
};

Spread scaled(const Spread& s, double factor) {
  return {s.median * factor, s.min * factor, s.max * factor};
}

std::vector<Bar> time_bars(const std::vector<EffectCost>& costs) {
  std::vector<Bar> bars;
  for (const EffectCost& cost : costs) {
    const double per_second = 1 / cost.runs.front().simulated_seconds;
    const Spread ratio = cost.ratio(&RunCost::wall_seconds, costs.front());
    bars.push_back({cost.name, format("×%.2f", ratio.median),
                    scaled(cost.of(&RunCost::wall_seconds), per_second),
                    per_second * cost.of(&RunCost::effects_seconds).median});
  }
  return bars;
}

std::vector<Bar> memory_bars(const std::vector<EffectCost>& costs) {
  constexpr double per_byte = 1. / (1024 * 1024);
  std::vector<Bar> bars;
  for (const EffectCost& cost : costs) {
    const Spread ratio = cost.ratio(&RunCost::peak_memory, costs.front());
    bars.push_back(
        {cost.name, format("×%.2f", ratio.median), scaled(cost.of(&RunCost::peak_memory), per_byte), 0});
  }
  return bars;
}

}  // namespace

std::string effects_svg(const EffectsTitle& title, const std::vector<EffectCost>& costs) {
  const double width = 2 * panel_width, height = margin_top + panel_height + margin_bottom;
  std::string text = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + format("%.0f", width) +
                     "\" height=\"" + format("%.0f", height) + "\" font-family=\"sans-serif\">\n";
  text += rectangle(0, 0, width, height, "white");
  text += label(16, 24, "start", 15, "Cost of effects: " + title.scene);
  text += Panel(0, "wall seconds per simulated second", time_bars(costs)).draw();
  text += Panel(panel_width, "peak memory [MiB]", memory_bars(costs)).draw();
  const double y = height - 14;
  text +=
      rectangle(margin_left, y - 9, 10, 10, dark) + label(margin_left + 15, y, "start", 11, "stage effects");
  text += rectangle(margin_left + 110, y - 9, 10, 10, light);
  text += label(margin_left + 125, y, "start", 11, "the rest. Lines: least to largest of the runs; × none");
  return text + "</svg>\n";
}

}  // namespace oilskin::demo
