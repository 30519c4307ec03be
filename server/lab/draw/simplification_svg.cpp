// The simplification as a picture. Each variant, which leaves out a part of the model, has a row: its cost on
// the left, and how much it changes the result on the right.
#include <algorithm>
#include <cmath>
#include <sstream>

#include "server/lab/draw/drawings.h"

namespace clothlab::lab {

namespace {

constexpr double names_width = 236, row_height = 28, cost_right = 440, change_left = 478;
constexpr const char *kept_colour = "#8c8c8c", *dropped_colour = "#1a7f37";

struct Row {
  const Variant* variant = nullptr;
  std::size_t index = 0;  ///< in Simplification::variants, as in the JSON
  bool listed = false;    ///< false: not one of these, but the whole scene or the recommendation
};

struct Plot {
  const Simplification* simplification = nullptr;
  std::vector<Row> rows;
  Scale cost, change;
  double top = 0, bottom = 0;
};

Plot plot_of(const Simplification& simplification, double top) {
  Plot plot;
  plot.simplification = &simplification;
  plot.rows.push_back({&simplification.whole, 0, false});
  for (std::size_t index = 0; index < simplification.variants.size(); ++index)
    plot.rows.push_back({&simplification.variants[index], index, true});
  if (simplification.drops_several()) plot.rows.push_back({&simplification.recommended, 0, false});
  double dearest = 1.1, least = simplification.tolerance, most = simplification.tolerance;
  for (const Row& row : plot.rows) {
    if (!row.variant->measured) continue;
    const Spread& ratio = row.variant->cost_ratio;
    if (std::isfinite(ratio.median)) dearest = std::max(dearest, 1.05 * ratio.median);
    // One round with a very high cost must not take up most of the axis.
    if (std::isfinite(ratio.high))
      dearest = std::max(dearest, 1.02 * std::min(ratio.high, 1.5 * ratio.median));
    if (const auto change = row.variant->change; change && *change > 0 && std::isfinite(*change)) {
      least = std::min(least, *change);
      most = std::max(most, *change);
    }
  }
  plot.top = top;
  plot.bottom = top + row_height * static_cast<double>(plot.rows.size());
  plot.cost = {0, dearest, margin + names_width, cost_right, false};
  plot.change = log_scale(least, most, change_left, picture_width - margin, 30);
  return plot;
}

void draw_axis(Svg& svg, const Plot& plot, const Scale& scale, int most, const std::string& label) {
  svg.open("g", {{"class", "axes"}});
  for (const Tick& tick : ticks(scale, most)) {
    if (tick.label.empty()) continue;
    const double at = scale(tick.value);
    svg.line(at, plot.top, at, plot.bottom, {{"class", "grid"}, {"stroke", "#dddddd"}});
    svg.text(at, plot.bottom + 18, tick.label, small_size, "middle", {{"class", "text"}, {"fill", ink}});
  }
  svg.add("rect", {{"class", "frame"},
                   {"x", scale.from},
                   {"y", plot.top},
                   {"width", scale.to - scale.from},
                   {"height", plot.bottom - plot.top},
                   {"fill", "none"},
                   {"stroke", "#888888"}});
  svg.text((scale.from + scale.to) / 2, plot.bottom + 38, label, text_size, "middle",
           {{"class", "text label"}, {"fill", ink}});
  svg.close();
}

std::string title_of(const Variant& variant) {
  if (!variant.measured) return variant.name + ": " + variant.reason;
  std::string title = variant.name + ": " + text(variant.cost_ratio) + " of the cost";
  if (variant.cost) title += " (" + brief(variant.cost->median) + " ms/s)";
  if (variant.change) title += ", changes " + brief(*variant.change, 2) + " of the size";
  if (variant.error[0]) title += ", error " + brief(*variant.error[0], 2);
  if (std::isfinite(variant.dt_limit) && variant.dt_limit > 0)
    title += ", steps up to " + brief(1000 * variant.dt_limit) + " ms";
  if (variant.saving == Saving::cannot_tell) title += "; the noise hides whether it saves 5 %";
  return title + (variant.recommended_to_drop ? "; recommended" : "");
}

std::string one_line(const std::string& words, double width) {
  const std::vector<std::string> lines = wrapped(words, width, small_size, 1);
  return lines.empty() ? "" : lines.front();
}

/// Draws the interval that holds the cost ratio, with a mark at each end. An end beyond the axis has no mark.
void draw_interval(Svg& svg, const Scale& cost, const Spread& ratio, double middle) {
  if (!std::isfinite(ratio.high) || ratio.high <= ratio.low) return;
  const double low = cost(std::min(ratio.low, cost.high)), high = cost(std::min(ratio.high, cost.high));
  const Attributes look{{"class", "interval"}, {"stroke", ink}, {"stroke-width", 1.5}};
  svg.line(low, middle, high, middle, look);
  svg.line(low, middle - 4, low, middle + 4, look);
  if (ratio.high <= cost.high) svg.line(high, middle - 4, high, middle + 4, look);
}

void draw_row(Svg& svg, const Plot& plot, std::size_t place) {
  const Row& row = plot.rows[place];
  const Variant& variant = *row.variant;
  const double middle = plot.top + row_height * (static_cast<double>(place) + 0.5);
  const bool recommended = variant.recommended_to_drop && variant.measured;
  Attributes attributes{{"class", variant.measured ? (recommended ? "mark drop" : "mark") : "absent"}};
  if (row.listed) attributes.push_back({"data-index", std::to_string(row.index)});
  svg.open("g", attributes, title_of(variant));
  const std::string name = one_line((recommended ? "✓ " : "") + variant.name, names_width - 10);
  svg.text(margin + names_width - 8, middle + 4.5, name, small_size, "end",
           {{"class", variant.measured ? "text" : "text soft"},
            {"fill", variant.measured ? ink : soft_ink},
            {"font-weight", recommended ? "bold" : "normal"}});
  const char* fill = recommended ? dropped_colour : kept_colour;
  if (!variant.measured) {
    write_over(svg, plot.cost.from + 8, middle + 4.5,
               one_line(variant.reason, picture_width - margin - plot.cost.from - 16), small_size, "start",
               {{"class", "text soft over"}, {"fill", soft_ink}});
    svg.close();
    return;
  }
  const double end = plot.cost(variant.cost_ratio.median);
  svg.add("rect", {{"class", recommended ? "bar drop" : "bar"},
                   {"x", plot.cost.from},
                   {"y", middle - 7},
                   {"width", end - plot.cost.from},
                   {"height", 14.0},
                   {"fill", fill}});
  draw_interval(svg, plot.cost, variant.cost_ratio, middle);
  if (variant.change && &variant != &plot.simplification->whole) {
    const double at = plot.change(*variant.change > 0 ? *variant.change : plot.change.low);
    svg.add("path", {{"class", recommended ? "dot drop" : "dot"},
                     {"d", mark_path(1, at, middle, 6)},
                     {"fill", fill},
                     {"stroke", paper}});
  }
  svg.close();
}

}  // namespace

std::string draw(const Simplification& simplification) {
  const std::string title = "What each part of " + simplification.scene + " costs and changes";
  std::vector<std::string> heading{text(simplification.setting) + ", " + brief(simplification.time) +
                                   " s simulated" +
                                   (simplification.renderer.empty() ? "" : " on " + simplification.renderer) +
                                   (simplification.complete ? "" : "; not complete")};
  std::istringstream why(simplification.why);
  for (std::string line; std::getline(why, line);) heading.push_back(line);
  double lines = 0;
  for (const std::string& words : heading)
    lines += static_cast<double>(wrapped(words, picture_width - 2 * margin, small_size, 2).size());
  const double top = 46 + 17.55 * lines + 20;
  const Plot plot = plot_of(simplification, top);
  const double notes_top = plot.bottom + 66;
  const double height = notes_top + 17.55 * static_cast<double>(note_lines(simplification.notes, 2)) - 6;

  Svg svg(picture_width, std::ceil(height), title, body_attributes(top - 26, notes_top - 14));
  write_heading(svg, title, heading);
  draw_axis(svg, plot, plot.cost, 4, "cost / cost of the whole scene");
  draw_axis(svg, plot, plot.change, 4, "change / size of the cloth");
  const double whole = plot.cost(1), tolerance = plot.change(simplification.tolerance);
  svg.line(whole, plot.top, whole, plot.bottom,
           {{"class", "line whole"}, {"stroke", soft_ink}, {"stroke-dasharray", "6 4"}});
  svg.line(tolerance, plot.top - 4, tolerance, plot.bottom,
           {{"class", "line tolerance"},
            {"stroke", "#2c7a3f"},
            {"stroke-width", 1.5},
            {"stroke-dasharray", "6 4"}});
  svg.text(tolerance, plot.top - 8, "tolerance", small_size, "middle",
           {{"class", "text line tolerance"}, {"fill", "#2c7a3f"}});
  for (std::size_t place = 0; place < plot.rows.size(); ++place) draw_row(svg, plot, place);
  write_notes(svg, notes_top, simplification.notes, 2);
  return svg.finish();
}

}  // namespace clothlab::lab
