// The stability map as a picture. Each method has a panel: the varied number runs to the right, dt upwards.
// Every trial is a cell, shaded by the growth of energy, with theory's line and the measured boundary on top.
#include <algorithm>
#include <cmath>

#include "server/base/text.h"
#include "server/lab/draw/map_panel.h"

namespace clothlab::lab {

namespace {

constexpr double panels_left = 70, panel_gap = 22, panel_title = 22, ticks_below = 24;

/// The methods in drawing order: first those with a stability limit, as only they have a boundary to see.
std::vector<const MethodMap*> ordered(const StabilityMap& map) {
  std::vector<const MethodMap*> methods;
  for (const MethodMap& method : map.methods) methods.push_back(&method);
  std::stable_partition(methods.begin(), methods.end(),
                        [](const MethodMap* method) { return !scene::any_step_is_stable(method->method); });
  return methods;
}

bool loses_energy(const StabilityMap& map) {
  for (const MethodMap& method : map.methods)
    for (const MapColumn& column : method.columns)
      for (const MapCell& cell : column.cells)
        if (cell.growth < -0.05) return true;
  return false;
}

double draw_legend(Svg& svg, double y, bool loses) {
  constexpr int pieces = 28;
  constexpr double width = 8;
  const double least = loses ? -2 : 0, most = 4, left = margin + 96;
  svg.open("g", {{"class", "legend"}});
  const auto words = [&](double x, const char* text, const char* anchor) {
    svg.text(x, y, text, small_size, anchor, {{"class", "text"}, {"fill", ink}});
  };
  words(left - 6, loses ? "loses energy" : "keeps energy", "end");
  for (int piece = 0; piece < pieces; ++piece)
    svg.add("rect", {{"x", left + piece * width},
                     {"y", y - 11},
                     {"width", width + 0.4},
                     {"height", 13.0},
                     {"fill", shade(least + (most - least) * (piece + 0.5) / pieces)}});
  const double end = left + pieces * width;
  words(end + 6, "grows", "start");
  svg.add("rect",
          {{"x", end + 66}, {"y", y - 11}, {"width", 22.0}, {"height", 13.0}, {"fill", blown_colour}});
  words(end + 94, "blew up", "start");
  y += 22;
  svg.line(margin, y - 4.5, margin + 22, y - 4.5,
           {{"class", "theory"}, {"stroke", theory_colour}, {"stroke-width", 1.6}});
  words(margin + 28, "theory", "start");
  svg.add("rect", {{"class", "measured"},
                   {"x", margin + 96},
                   {"y", y - 6.5},
                   {"width", 22.0},
                   {"height", 3.6},
                   {"fill", measured_colour}});
  words(margin + 124, "measured", "start");
  svg.add("path",
          {{"class", "disagrees"}, {"d", mark_path(0, margin + 220, y - 5, 5.5)}, {"fill", doubt_colour}});
  words(margin + 232, "more than 5 % apart", "start");
  svg.add("circle", {{"class", "ring present"},
                     {"cx", margin + 400},
                     {"cy", y - 4.5},
                     {"r", 7.0},
                     {"fill", "none"},
                     {"stroke", ink},
                     {"stroke-width", 2.2}});
  words(margin + 414, "now", "start");
  svg.close();
  return y + 22;
}

}  // namespace

std::string draw(const StabilityMap& map) {
  const std::vector<const MethodMap*> methods = ordered(map);
  const std::size_t in_a_row = methods.size() < 2 ? 1 : 2;
  const double columns = static_cast<double>(in_a_row);
  const double width = (picture_width - margin - panels_left - panel_gap * (columns - 1)) / columns;
  const PanelScales scales = panel_scales(map, width);
  const double rows = std::max(1.0, std::ceil(static_cast<double>(methods.size()) / columns));
  constexpr double row_height = panel_title + panel_height + ticks_below;
  const std::vector<std::string> heading{
      "At most " + brief(map.time) + " s and " + std::to_string(map.steps) + " steps a trial" +
      (map.renderer.empty() ? "" : " on " + map.renderer) + (map.complete ? "" : "; not complete")};
  const std::string title = "Stability of " + map.scene + ": dt against " + map.field;
  const double top = 64, labels = top + rows * row_height + 12, legend_top = labels + 26;
  const double notes_top = legend_top + 2 * 22 + 4;
  const double height = notes_top + 17.55 * static_cast<double>(note_lines(map.notes, 2)) + 4;

  Attributes root = body_attributes(top - 8, notes_top - 14);
  root.push_back({"data-x-scale", scales.x.log ? "log" : "linear"});
  root.push_back({"data-y-scale", "log"});
  Svg svg(picture_width, std::ceil(height), title, root);
  write_heading(svg, title, heading);
  for (std::size_t index = 0; index < methods.size(); ++index) {
    const double left = panels_left + static_cast<double>(index % in_a_row) * (width + panel_gap);
    const double panel_top = top + static_cast<double>(index / in_a_row) * row_height + panel_title;
    draw_panel(svg, map, *methods[index], scales, left, panel_top, index % in_a_row == 0);
  }
  if (methods.empty())
    svg.text(picture_width / 2, top + row_height / 2, "Nothing is measured yet.", text_size, "middle",
             {{"class", "text"}, {"fill", ink}});
  // All stiffnesses have a unit; an axis of a sweep may have their name, but no unit.
  const std::string x_label =
      (map.field == "stiffness" && !map.unit.empty() ? "all stiffnesses" : map.field) +
      (map.unit.empty() ? "" : " [" + map.unit + "]");
  svg.text((panels_left + picture_width - margin) / 2, labels, x_label, text_size, "middle",
           {{"class", "text label"}, {"fill", ink}});
  const double middle = top + rows * row_height / 2;
  svg.text(20, middle, "dt [ms]", text_size, "middle",
           {{"class", "text label"}, {"fill", ink}, {"transform", formatted("rotate(-90 20 %.1f)", middle)}});
  draw_legend(svg, legend_top, loses_energy(map));
  write_notes(svg, notes_top, map.notes, 2);
  return svg.finish();
}

}  // namespace clothlab::lab
