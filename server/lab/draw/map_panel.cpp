#include "server/lab/draw/map_panel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "server/base/text.h"

namespace clothlab::lab {

namespace {

struct Colour {
  double at, red, green, blue;
};
/// Colours by growth (`at`): blue if energy is lost, pale if it is kept, orange to brown if it grows.
constexpr std::array<Colour, 6> shades{{{-3, 33, 102, 172},
                                        {-1, 146, 197, 222},
                                        {0, 244, 244, 240},
                                        {0.5, 253, 219, 160},
                                        {2, 224, 130, 20},
                                        {4, 150, 80, 10}}};

std::string fill_of(const MapCell& cell) {
  return cell.blew_up ? blown_colour : shade(cell.growth);
}

std::string with_unit(double value, const std::string& unit) {
  return brief(value) + (unit.empty() ? "" : " " + unit);
}

/// The two edges of each cell along one axis, in the view box: half way to the neighbouring cells' middles.
std::vector<std::pair<double, double>> bounds(const std::vector<double>& middles, double low, double high) {
  std::vector<std::pair<double, double>> all;
  for (std::size_t index = 0; index < middles.size(); ++index) {
    const double here = middles[index];
    const double before = index > 0 ? (middles[index - 1] + here) / 2
                                    : (middles.size() > 1 ? here - (middles[1] - here) / 2 : low);
    const double after = index + 1 < middles.size()
                             ? (middles[index + 1] + here) / 2
                             : (middles.size() > 1 ? here + (here - middles[index - 1]) / 2 : high);
    const auto [from, to] = std::minmax(before, after);
    all.emplace_back(std::clamp(from, low, high), std::clamp(to, low, high));
  }
  return all;
}

class Panel {
 public:
  Panel(Svg& svg, const StabilityMap& map, const MethodMap& method, const PanelScales& scales, double left,
        double top)
      : svg_(svg), map_(map), method_(method), x_(scales.x), y_(scales.y) {
    x_.from += left;
    x_.to += left;
    y_.from += top;
    y_.to += top;
  }

  void draw(bool label_y) {
    Attributes attributes{{"class", "panel"}, {"data-method", scene::name(method_.method)}};
    for (const Attribute& attribute : scale_attributes(x_, y_)) attributes.push_back(attribute);
    svg_.open("g", attributes);
    draw_frame(label_y);
    std::vector<double> middles;
    for (const MapColumn& column : method_.columns) middles.push_back(x_(column.value));
    const auto sides = bounds(middles, x_.from, x_.to);
    for (std::size_t index = 0; index < method_.columns.size(); ++index) draw_cells(index, sides[index]);
    draw_theory();
    for (std::size_t index = 0; index < method_.columns.size(); ++index) draw_boundary(index, sides[index]);
    draw_present();
    svg_.close();
  }

 private:
  void draw_frame(bool label_y) {
    svg_.text(x_.from, y_.to - 7, scene::name(method_.method), text_size, "start",
              {{"class", "text"}, {"fill", ink}, {"font-weight", "bold"}});
    if (method_.method == map_.present_method)
      svg_.text(x_.to, y_.to - 7, "the scene's own", small_size, "end",
                {{"class", "text soft"}, {"fill", soft_ink}});
    svg_.add("rect", {{"class", "frame"},
                      {"x", x_.from},
                      {"y", y_.to},
                      {"width", x_.to - x_.from},
                      {"height", y_.from - y_.to},
                      {"fill", "none"},
                      {"stroke", "#888888"}});
    for (const Tick& tick : ticks(x_, 5)) {
      const double at = x_(tick.value);
      svg_.line(at, y_.from, at, y_.from + (tick.label.empty() ? 3 : 5),
                {{"class", "frame"}, {"stroke", "#888888"}});
      if (!tick.label.empty())
        svg_.text(at, y_.from + 18, tick.label, small_size, "middle", {{"class", "text"}, {"fill", ink}});
    }
    Scale milliseconds = y_;
    milliseconds.low *= 1000;
    milliseconds.high *= 1000;
    for (const Tick& tick : ticks(milliseconds, 6)) {
      const double at = milliseconds(tick.value);
      svg_.line(x_.from - (tick.label.empty() ? 3 : 5), at, x_.from, at,
                {{"class", "frame"}, {"stroke", "#888888"}});
      if (!tick.label.empty() && label_y)
        svg_.text(x_.from - 8, at + 4.5, tick.label, small_size, "end", {{"class", "text"}, {"fill", ink}});
    }
  }

  void draw_cells(std::size_t index, const std::pair<double, double>& sides) {
    const MapColumn& column = method_.columns[index];
    std::vector<double> middles;
    for (const MapCell& cell : column.cells) middles.push_back(y_(cell.dt));
    const auto heights = bounds(middles, y_.to, y_.from);
    for (std::size_t cell = 0; cell < column.cells.size(); ++cell) {
      const MapCell& here = column.cells[cell];
      const std::string energy =
          here.blew_up ? "blew up" : "energy times " + brief(std::pow(10.0, here.growth), 2);
      svg_.add("rect",
               {{"class", here.blew_up ? "cell blown" : "cell"},
                {"data-column", std::to_string(index)},
                {"data-cell", std::to_string(cell)},
                {"x", sides.first},
                {"y", heights[cell].first},
                {"width", sides.second - sides.first},
                {"height", heights[cell].second - heights[cell].first},
                {"fill", fill_of(here)},
                {"stroke", fill_of(here)},
                {"stroke-width", 0.4}},
               std::string(scene::name(method_.method)) + ", " + with_unit(column.value, map_.unit) +
                   ", dt " + brief(1000 * here.dt) + " ms: " + energy);
    }
  }

  void draw_theory() {
    std::vector<std::pair<double, double>> corners;
    for (const MapColumn& column : method_.columns)
      if (column.theory && *column.theory >= y_.low && *column.theory <= y_.high)
        corners.emplace_back(x_(column.value), y_(*column.theory));
    for (const auto& [kind, colour, width] :
         {std::tuple{"theory halo", paper, 4.0}, std::tuple{"theory", theory_colour, 1.6}})
      if (corners.size() > 1)
        svg_.add("path", {{"class", kind},
                          {"d", polyline_path(corners)},
                          {"fill", "none"},
                          {"stroke", colour},
                          {"stroke-width", width},
                          {"pointer-events", "none"}});
    if (corners.size() == 1)
      svg_.add("circle", {{"class", "theory"},
                          {"cx", corners[0].first},
                          {"cy", corners[0].second},
                          {"r", 3.0},
                          {"fill", theory_colour},
                          {"stroke", paper}});
    if (!corners.empty() || method_.columns.empty()) return;
    const bool unlimited = std::all_of(method_.columns.begin(), method_.columns.end(),
                                       [](const MapColumn& column) { return !column.theory; });
    const bool never = std::all_of(method_.columns.begin(), method_.columns.end(),
                                   [](const MapColumn& column) { return column.theory == 0.0; });
    if (unlimited || never)
      write_over(svg_, x_.from + 6, y_.to + 17, unlimited ? "theory: no limit" : "theory: no step is stable",
                 small_size, "start", {{"class", "text over"}, {"fill", ink}});
  }

  /// A bar between the longest step that held and the shortest that failed, and a mark if theory disagrees.
  void draw_boundary(std::size_t index, const std::pair<double, double>& sides) {
    const MapColumn& column = method_.columns[index];
    std::string title = std::string(scene::name(method_.method)) + ", " + with_unit(column.value, map_.unit);
    if (column.held) title += ", held " + brief(1000 * *column.held) + " ms";
    if (column.failed) title += ", failed " + brief(1000 * *column.failed) + " ms";
    if (column.theory)
      title += *column.theory > 0 ? ", theory " + brief(1000 * *column.theory) + " ms"
                                  : ", theory: no step is stable";
    if (!column.reason.empty()) title += ": " + column.reason;
    if (column.failed) {
      const double held = y_(column.held ? *column.held : y_.low), failed = y_(*column.failed);
      const double inset = 0.12 * (sides.second - sides.first);
      svg_.add("rect",
               {{"class", "measured"},
                {"data-column", std::to_string(index)},
                {"x", sides.first + inset},
                {"y", column.held ? (held + failed) / 2 - std::max((held - failed) / 2, 1.6) : failed - 1.6},
                {"width", sides.second - sides.first - 2 * inset},
                {"height", column.held ? std::max(held - failed, 3.2) : 3.2},
                {"fill", measured_colour},
                {"stroke", paper},
                {"stroke-width", 0.8}},
               title);
    }
    if (!column.disagrees) return;
    const double at = y_(column.failed ? *column.failed : column.held ? *column.held : y_.high);
    const double x = (sides.first + sides.second) / 2, y = std::max(at - 13, y_.to + 8);
    svg_.add("path",
             {{"class", "disagrees"},
              {"data-column", std::to_string(index)},
              {"d", mark_path(0, x, y, 5.5)},
              {"fill", doubt_colour},
              {"stroke", paper}},
             title);
  }

  void draw_present() {
    const auto within = [](const Scale& scale, double value) {
      return value >= scale.low && value <= scale.high;
    };
    if (method_.method != map_.present_method || !within(x_, map_.present_value) ||
        !within(y_, map_.present_dt))
      return;
    for (const auto& [colour, width] : {std::pair{paper, 5.0}, std::pair{ink, 2.2}})
      svg_.add("circle", {{"class", "ring present"},
                          {"cx", x_(map_.present_value)},
                          {"cy", y_(map_.present_dt)},
                          {"r", 8.0},
                          {"fill", "none"},
                          {"stroke", colour},
                          {"stroke-width", width},
                          {"pointer-events", "none"}});
  }

  Svg& svg_;
  const StabilityMap& map_;
  const MethodMap& method_;
  Scale x_, y_;
};

}  // namespace

std::string shade(double growth) {
  const double at =
      std::isnan(growth) ? shades.back().at : std::clamp(growth, shades[0].at, shades.back().at);
  std::size_t next = 1;
  while (next + 1 < shades.size() && at > shades[next].at) ++next;
  const Colour &low = shades[next - 1], &high = shades[next];
  const double share = (at - low.at) / (high.at - low.at);
  const auto mix = [share](double from, double to) {
    return static_cast<unsigned>(std::lround(from + share * (to - from)));
  };
  return formatted("#%02x%02x%02x", mix(low.red, high.red), mix(low.green, high.green),
                   mix(low.blue, high.blue));
}

PanelScales panel_scales(const StabilityMap& map, double width) {
  double least = map.present_value, most = map.present_value;
  double shortest = map.present_dt > 0 ? map.present_dt : 1e-3, longest = shortest;
  const auto include = [&](double dt) {
    if (!(dt > 0) || !std::isfinite(dt)) return;
    shortest = std::min(shortest, dt);
    longest = std::max(longest, dt);
  };
  bool first = true;
  for (const MethodMap& method : map.methods)
    for (const MapColumn& column : method.columns) {
      least = first ? column.value : std::min(least, column.value);
      most = first ? column.value : std::max(most, column.value);
      first = false;
      if (column.held) include(*column.held);
      if (column.failed) include(*column.failed);
      for (const MapCell& cell : column.cells) include(cell.dt);
    }
  PanelScales scales;
  if (least > 0) {
    // About half a column of room on both sides.
    const double room = std::pow(std::max(most / least, 1.1), 0.06);
    scales.x = {least / room, most * room, 0, width, true};
  } else {
    const double room = most > least ? 0.06 * (most - least) : std::max(std::abs(most), 1.0);
    scales.x = {least - room, most + room, 0, width, false};
  }
  scales.y = log_scale(shortest, longest, panel_height, 0);
  return scales;
}

void draw_panel(Svg& svg, const StabilityMap& map, const MethodMap& method, const PanelScales& scales,
                double left, double top, bool label_y) {
  Panel(svg, map, method, scales, left, top).draw(label_y);
}

}  // namespace clothlab::lab
