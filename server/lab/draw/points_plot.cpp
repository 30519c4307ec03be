// Error against cost, both logarithmic. A thin curve connects each method's points of equal iterations, a
// thick curve the method's front, and a broad band the front of all methods. Settings that blew up are
// crosses in a strip on the right, in one lane per method.
#include <algorithm>
#include <cmath>

#include "server/lab/draw/points_layout.h"
#include "server/scene/method.h"

namespace clothlab::lab {

namespace {

constexpr double legend_column = 172, legend_row = 20;

/// An entry of the legend: a function that draws its sign with the middle at (x, y), and its words.
struct Entry {
  std::function<void(Svg&, double x, double y)> sign;
  std::string words;
};

std::vector<Entry> legend(const Layout& layout) {
  std::vector<Entry> entries;
  bool several = false;
  for (const scene::Method method : scene::methods) {
    bool present = false;
    std::optional<int> iterations;
    for (const Point& point : *layout.plot->points) {
      if (point.setting.method != method) continue;
      present = true;
      if (iterations && iterates(method) && *iterations != point.setting.iterations) several = true;
      iterations = point.setting.iterations;
    }
    if (!present) continue;
    entries.push_back({[method](Svg& svg, double x, double y) {
                         svg.line(x - 11, y, x + 11, y,
                                  {{"class", "curve"},
                                   {"data-method", scene::name(method)},
                                   {"stroke", colour(method)},
                                   {"stroke-width", 2.4}});
                         svg.add("path", {{"class", "sign"},
                                          {"data-method", scene::name(method)},
                                          {"d", mark_path(mark_shape(method), x, y, mark_radius)},
                                          {"fill", colour(method)},
                                          {"stroke", paper},
                                          {"stroke-width", 0.8}});
                       },
                       scene::name(method)});
  }
  if (front(layout.places).size() > 1)
    entries.push_back({[](Svg& svg, double x, double y) {
                         svg.line(x - 9, y, x + 9, y,
                                  {{"class", "front"},
                                   {"stroke", "#ffd24d"},
                                   {"stroke-width", 11.0},
                                   {"stroke-opacity", "0.45"},
                                   {"stroke-linecap", "round"}});
                       },
                       "best of all"});
  if (several)
    entries.push_back({[](Svg& svg, double x, double y) {
                         svg.line(x - 11, y, x + 11, y, {{"class", "curve thin"}, {"stroke", soft_ink}});
                       },
                       "same iterations"});
  if (!layout.crosses.empty())
    entries.push_back({[](Svg& svg, double x, double y) {
                         svg.add("path", {{"class", "blown"},
                                          {"d", cross_path(x, y, cross_radius)},
                                          {"stroke", ink},
                                          {"stroke-width", 2.0}});
                       },
                       "blew up"});
  return entries;
}

double draw_legend(Svg& svg, const std::vector<Entry>& entries, double y) {
  svg.open("g", {{"class", "legend"}});
  for (std::size_t index = 0; index < entries.size(); ++index) {
    const double x = margin + legend_column * static_cast<double>(index % 4);
    const double base = y + legend_row * static_cast<double>(index / 4);
    entries[index].sign(svg, x + 14, base - 4.5);
    svg.text(x + 32, base, entries[index].words, small_size, "start", {{"class", "text"}, {"fill", ink}});
  }
  svg.close();
  return y + legend_row * static_cast<double>((entries.size() + 3) / 4);
}

void say_empty(Svg& svg, const Layout& layout) {
  if (!layout.places.empty()) return;
  const double middle = (layout.x.from + layout.x.to) / 2;
  double y = (layout.y.from + layout.y.to) / 2 - 20;
  for (const std::string& line :
       wrapped(layout.plot->empty, layout.x.to - layout.x.from - 60, text_size, 5)) {
    write_over(svg, middle, y, line, text_size, "middle", {{"class", "text over"}, {"fill", ink}});
    y += 20;
  }
}

}  // namespace

std::string draw(const PointsPlot& plot) {
  constexpr std::size_t note_lines_each = 3;
  double heading_lines = 0;
  for (const std::string& words : plot.heading)
    heading_lines += static_cast<double>(wrapped(words, picture_width - 2 * margin, small_size, 2).size());
  const std::size_t line_rows = std::min<std::size_t>(std::max<std::size_t>(plot.lines.size(), 1), 3);
  const double top = 46 + 17.55 * heading_lines + 17 * static_cast<double>(line_rows);
  const Layout layout = layout_of(plot, top);
  std::vector<std::string> notes = plot.notes;
  if (layout.points_above_one > 0)
    notes.push_back(count(layout.points_above_one, "point") + " with an error above 1 " +
                    (layout.points_above_one == 1 ? "stands" : "stand") + " on the right edge.");
  const std::vector<Entry> entries = legend(layout);
  const double label_lines =
      static_cast<double>(wrapped(plot.x_label, picture_width - 2 * margin, text_size, 2).size());
  const double legend_top = layout.y.from + 38 + 19 * label_lines + 8;
  const double notes_top = legend_top + legend_row * static_cast<double>((entries.size() + 3) / 4) + 4;
  const double height =
      notes_top + 17.55 * static_cast<double>(note_lines(notes, note_lines_each)) + (notes.empty() ? 0 : 4);

  Attributes root = scale_attributes(layout.x, layout.y);
  for (const Attribute& attribute :
       body_attributes(top - 17 * static_cast<double>(line_rows) - 6, notes_top - 12))
    root.push_back(attribute);
  Svg svg(picture_width, std::ceil(height), plot.title, root);
  write_heading(svg, plot.title, plot.heading);
  draw_axes(svg, layout.x, layout.y, plot.x_label, "ms of stepping per simulated second");
  draw_lines(svg, layout, line_rows);
  draw_crosses(svg, layout);
  draw_curves(svg, layout);
  const double right = layout.crosses.empty() ? picture_width - 4 : layout.x.to - 1;
  Places taken({layout.x.from + 2, layout.y.to + 2, right, layout.y.from - 2});
  draw_marks(svg, layout, taken);
  draw_rings(svg, layout, taken);
  draw_labels(svg, layout, taken);
  say_empty(svg, layout);
  draw_legend(svg, entries, legend_top);
  write_notes(svg, notes_top, notes, note_lines_each);
  return svg.finish();
}

}  // namespace clothlab::lab
