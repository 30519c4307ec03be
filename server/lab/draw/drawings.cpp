#include "server/lab/draw/drawings.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "server/base/text.h"
#include "server/scene/method.h"

namespace clothlab::lab {

namespace {
constexpr double line_height = 1.35;  // a multiple of the font size

}  // namespace

const char* colour(scene::Method method) {
  // In the order of scene::Method; the last four wait for methods to come. Marks differ too (mark_path).
  constexpr std::array<const char*, 12> colours{"#8c8c8c", "#e69f00", "#0072b2", "#56b4e9",
                                                "#d55e00", "#cc79a7", "#009e73", "#7a5fb5",
                                                "#332288", "#999933", "#882255", "#44aa99"};
  static_assert(colours.size() >= scene::methods.size(), "each method needs a colour");
  return colours[static_cast<std::size_t>(method)];
}

std::size_t mark_shape(scene::Method method) {
  return static_cast<std::size_t>(method);
}

std::string scene_and_renderer(const std::string& scene, const std::string& renderer) {
  return "scene " + scene + (renderer.empty() ? "" : ", on " + renderer);
}

double write_heading(Svg& svg, const std::string& title, const std::vector<std::string>& lines) {
  double y = margin + title_size * 0.8;
  constexpr double width = picture_width - 2 * margin, bold = 1.1;  // bold letters over plain ones
  // A long title gets smaller letters, so that the picture stays as high as it is.
  const double needed = bold * text_width(title, title_size);
  const double size = std::clamp(title_size * width / needed, small_size, title_size);
  svg.open("g", {{"class", "heading"}});
  for (const std::string& line : wrapped(title, width / bold, size, 1))
    svg.text(margin, y, line, size, "start",
             {{"class", "text title"}, {"fill", ink}, {"font-weight", "bold"}});
  y += 0.3 * title_size;
  for (const std::string& words : lines)
    for (const std::string& line : wrapped(words, width, small_size, 2)) {
      y += line_height * small_size;
      svg.text(margin, y, line, small_size, "start", {{"class", "text soft"}, {"fill", soft_ink}});
    }
  svg.close();
  return y + line_height * small_size;
}

std::size_t note_lines(const std::vector<std::string>& paragraphs, std::size_t most_lines) {
  std::size_t lines = 0;
  for (const std::string& words : paragraphs)
    lines += wrapped(words, picture_width - 2 * margin, small_size, most_lines).size();
  return lines;
}

double write_notes(Svg& svg, double y, const std::vector<std::string>& paragraphs, std::size_t most_lines) {
  svg.open("g", {{"class", "notes"}});
  for (const std::string& words : paragraphs) {
    svg.open("g", {{"class", "note"}}, words);
    for (const std::string& line : wrapped(words, picture_width - 2 * margin, small_size, most_lines)) {
      svg.text(margin, y, line, small_size, "start", {{"class", "text soft"}, {"fill", soft_ink}});
      y += line_height * small_size;
    }
    svg.close();
  }
  svg.close();
  return y;
}

void write_over(Svg& svg, double x, double y, const std::string& words, double font_size, const char* anchor,
                const Attributes& attributes) {
  Attributes all = attributes;
  all.insert(
      all.end(),
      {{"stroke", paper}, {"stroke-width", 3.0}, {"stroke-linejoin", "round"}, {"paint-order", "stroke"}});
  svg.text(x, y, words, font_size, anchor, all);
}

Attributes scale_attributes(const Scale& x, const Scale& y) {
  return {{"data-x0", with_significant_digits(x.low, 9)},
          {"data-x1", with_significant_digits(x.high, 9)},
          {"data-y0", with_significant_digits(y.low, 9)},
          {"data-y1", with_significant_digits(y.high, 9)},
          {"data-left", x.from},
          {"data-right", x.to},
          {"data-top", y.to},
          {"data-bottom", y.from},
          {"data-x-scale", x.log ? "log" : "linear"},
          {"data-y-scale", y.log ? "log" : "linear"}};
}

Attributes body_attributes(double top, double bottom) {
  return {{"data-body-top", top}, {"data-body-bottom", bottom}};
}

void draw_axes(Svg& svg, const Scale& x, const Scale& y, const std::string& x_label,
               const std::string& y_label) {
  svg.open("g", {{"class", "axes"}});
  for (const Tick& tick : ticks(x)) {
    const double at = x(tick.value);
    svg.line(at, y.from, at, y.to,
             {{"class", tick.label.empty() ? "grid minor" : "grid"},
              {"stroke", tick.label.empty() ? "#f1f1f1" : "#dddddd"}});
    if (!tick.label.empty())
      svg.text(at, y.from + 18, tick.label, small_size, "middle", {{"class", "text"}, {"fill", ink}});
  }
  for (const Tick& tick : ticks(y)) {
    const double at = y(tick.value);
    svg.line(x.from, at, x.to, at,
             {{"class", tick.label.empty() ? "grid minor" : "grid"},
              {"stroke", tick.label.empty() ? "#f1f1f1" : "#dddddd"}});
    if (!tick.label.empty())
      svg.text(x.from - 6, at + 4.5, tick.label, small_size, "end", {{"class", "text"}, {"fill", ink}});
  }
  svg.add("rect", {{"class", "frame"},
                   {"x", x.from},
                   {"y", y.to},
                   {"width", x.to - x.from},
                   {"height", y.from - y.to},
                   {"fill", "none"},
                   {"stroke", "#888888"}});
  double below = y.from + 38;
  for (const std::string& line : wrapped(x_label, picture_width - 2 * margin, text_size, 2)) {
    // Centred below the axis, but moved where the text would otherwise leave the picture.
    const double half = text_width(line, text_size) / 2, middle = (x.from + x.to) / 2;
    const double at = std::max(margin + half, std::min(middle, picture_width - margin - half));
    svg.text(at, below, line, text_size, "middle", {{"class", "text label"}, {"fill", ink}});
    below += line_height * text_size;
  }
  const double middle = (y.from + y.to) / 2;
  svg.text(20, middle, y_label, text_size, "middle",
           {{"class", "text label"}, {"fill", ink}, {"transform", formatted("rotate(-90 20 %.1f)", middle)}});
  svg.close();
}

std::optional<std::size_t> index_of(const std::vector<Point>& points, const Setting& setting) {
  for (std::size_t index = 0; index < points.size(); ++index) {
    const Setting& other = points[index].setting;
    if (other.method == setting.method && std::abs(other.dt - setting.dt) <= 1e-9 * setting.dt &&
        (!iterates(setting.method) || other.iterations == setting.iterations))
      return index;
  }
  return std::nullopt;
}

}  // namespace clothlab::lab
