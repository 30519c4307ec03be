// The lines, rings and names in a plot of error against cost: all that must find room for words.
#include <algorithm>
#include <array>
#include <limits>

#include "server/lab/draw/points_layout.h"
#include "server/scene/method.h"

namespace clothlab::lab {

namespace {

/// The name of a vertical line, written above the plot.
struct LineName {
  const PointsPlot::Line* line = nullptr;
  std::string words;
  double x = 0, left = 0, right = 0;  ///< x of the line; x of the name's two ends [view box]
  bool inside = true;                 ///< false: the line is beyond the left edge, and only its name is drawn
  std::size_t row = 0;                ///< 0 is the lowest
};

/// The penalty for two names that collide: their words overlap, or the line of one crosses the other's words;
/// 0: they do not collide.
std::size_t collision(const LineName& a, const LineName& b) {
  constexpr double gap = 6;
  constexpr std::size_t words = 100, through = 30;
  if (a.row == b.row) return a.left < b.right + gap && b.left < a.right + gap ? words : 0;
  const LineName &upper = a.row > b.row ? a : b, &lower = a.row > b.row ? b : a;
  return upper.inside && upper.x > lower.left - 2 && upper.x < lower.right + 2 ? through : 0;
}

/// The left end of a name, from its line, in widths of the name: name centred, left or right of the line.
constexpr std::array<double, 3> alignments{-0.5, -1.0, 0.0};

/// Chooses a row and an alignment for each name by trying all combinations: as few collisions as possible,
/// then low rows, then centred names.
std::vector<LineName> line_names(const Layout& layout, std::size_t rows) {
  std::vector<LineName> names;
  for (const PointsPlot::Line& line : layout.plot->lines) {
    LineName name{&line, line.words, layout.x(line.value), 0, 0, line.value >= layout.x.low, 0};
    if (!name.inside) name.words = "◂ " + line.words + " " + brief(line.value, 2);
    names.push_back(name);
  }
  const std::size_t choices = rows * alignments.size();
  std::size_t ways = 1;
  for (std::size_t index = 0; index < names.size(); ++index) ways *= choices;
  std::vector<LineName> best = names;
  std::size_t least = std::numeric_limits<std::size_t>::max();
  for (std::size_t way = 0; way < ways; ++way) {
    std::size_t left = way, cost = 0;
    for (LineName& name : names) {
      const std::size_t alignment = left % alignments.size();
      name.row = left % choices / alignments.size();
      left /= choices;
      const double width = text_width(name.words, small_size);
      name.left = std::clamp(name.x + alignments[alignment] * width, margin, picture_width - margin - width);
      name.right = name.left + width;
      cost += 2 * name.row + (alignment == 0 ? 0 : 1);
    }
    for (std::size_t one = 0; one < names.size(); ++one)
      for (std::size_t other = one + 1; other < names.size(); ++other)
        cost += collision(names[one], names[other]);
    if (cost >= least) continue;
    least = cost;
    best = names;
  }
  return best;
}

}  // namespace

void draw_lines(Svg& svg, const Layout& layout, std::size_t rows) {
  svg.open("g", {{"class", "lines"}});
  for (const LineName& name : line_names(layout, rows)) {
    const double base = layout.y.to - 7 - static_cast<double>(name.row) * 17;
    const std::string kind = std::string("line ") + name.line->kind;
    if (name.inside)
      svg.line(name.x, base + 3, name.x, layout.y.from,
               {{"class", kind},
                {"stroke", name.line->colour},
                {"stroke-width", 1.5},
                {"stroke-dasharray", "6 4"}});
    svg.text(name.left, base, name.words, small_size, "start",
             {{"class", "text " + kind}, {"fill", name.line->colour}});
  }
  const double now = layout.y(real_time);
  svg.line(layout.x.from, now, layout.x.to, now,
           {{"class", "line real-time"},
            {"stroke", real_time_colour},
            {"stroke-width", 1.5},
            {"stroke-dasharray", "6 4"}});
  svg.close();
}

void draw_rings(Svg& svg, const Layout& layout, Places& taken) {
  double radius = 9;
  std::size_t before = std::numeric_limits<std::size_t>::max();
  for (const PointsPlot::Ring& ring : layout.plot->rings) {
    const auto at = where(layout, ring.index);
    radius = ring.index == before ? radius + 4 : 9;  // two rings about one point differ in size
    before = ring.index;
    if (!at) continue;
    svg.add("circle", {{"class", std::string("ring ") + ring.kind},
                       {"cx", at->first},
                       {"cy", at->second},
                       {"r", radius},
                       {"fill", "none"},
                       {"stroke", ink},
                       {"stroke-width", 2.0},
                       {"pointer-events", "none"}});
    taken.take({at->first - radius, at->second - radius, at->first + radius, at->second + radius});
    if (const auto box = taken.beside(at->first, at->second, radius, ring.words, small_size))
      write_over(svg, box->left, box->bottom - 2, ring.words, small_size, "start",
                 {{"class", std::string("text over ") + ring.kind}, {"fill", ink}, {"font-weight", "bold"}});
  }
}

namespace {
/// "0.76 ms" or "1.1 ms ×4": dt and, for a method that iterates, its iterations.
std::string step_words(const Setting& setting) {
  std::string words = brief(1000 * setting.dt) + " ms";
  if (iterates(setting.method)) words += " ×" + std::to_string(setting.iterations);
  return words;
}

}  // namespace

void draw_labels(Svg& svg, const Layout& layout, Places& taken) {
  svg.open("g", {{"class", "labels"}, {"pointer-events", "none"}});
  // The name of the real-time line comes first. It may stand anywhere along the line, above or below it.
  const double now = layout.y(real_time), width = text_width("real time", small_size);
  const double above = now - 3 - small_size, below = now + 3;
  bool placed = false;
  for (double x = layout.x.to - 6 - width; x > layout.x.from + 4 && !placed; x -= 8)
    for (const double top : {above, below}) {
      const Box box{x, top, x + width, top + small_size};
      if (!taken.is_free(box)) continue;
      taken.take(box);
      write_over(svg, x, box.bottom - 2, "real time", small_size, "start",
                 {{"class", "text over line real-time"}, {"fill", real_time_colour}});
      placed = true;
      break;
    }
  std::vector<std::size_t> order;
  for (const Place& place : front(layout.places)) order.push_back(place.index);
  for (const scene::Method method : scene::methods) {
    const std::vector<Place> best = front(of_method(layout, method));
    if (best.empty()) continue;
    order.push_back(best.back().index);
    order.push_back(best.front().index);
  }
  std::vector<std::size_t> done;
  for (const std::size_t index : order) {
    if (std::find(done.begin(), done.end(), index) != done.end()) continue;
    done.push_back(index);
    const auto at = where(layout, index);
    const std::string words = step_words(layout.point(index).setting);
    if (const auto box = taken.beside(at->first, at->second, mark_radius, words, small_size - 1))
      write_over(svg, box->left, box->bottom - 2, words, small_size - 1, "start",
                 {{"class", "text over soft"}, {"fill", soft_ink}});
  }
  svg.close();
}

}  // namespace clothlab::lab
