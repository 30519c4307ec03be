// The chart of speed against accuracy as a picture.
#include "server/lab/draw/drawings.h"
#include "server/lab/exports.h"
#include "server/scene/method.h"

namespace clothlab::lab {

namespace {

std::string x_label(const Chart& chart, Axis axis) {
  const std::string size = " of the cloth's size (" + brief(chart.size) + " m)";
  switch (axis) {
    case Axis::position:
      return "position error at " + brief(chart.horizon) + " s: RMS distance to the reference, as a share" +
             size;
    case Axis::energy:
      return "error of the total energy: RMS over time, as a share of the largest kinetic + elastic energy";
    case Axis::strain:
      return "error of the largest strain within " + brief(chart.time) + " s, as a share of it";
    case Axis::rest:
      return "distance to the shape of rest: RMS, as a share" + size;
  }
  return "";
}

std::vector<PointsPlot::Line> lines(const Chart& chart, Axis axis) {
  const AxisFacts& facts = chart.axes[static_cast<std::size_t>(axis)];
  std::vector<PointsPlot::Line> lines;
  if (axis == Axis::position || axis == Axis::rest)
    lines.push_back({one_pixel, "one pixel", "one-pixel", "#2c7a3f"});
  if (facts.float32_floor && *facts.float32_floor > 0)
    lines.push_back({*facts.float32_floor, "float32 floor", "float32", "#7a4a00"});
  if (facts.reference_error && *facts.reference_error > 0)
    lines.push_back({*facts.reference_error, "reference's own error", "reference", "#5b5bd6"});
  return lines;
}

}  // namespace

std::string draw(const Chart& chart, Axis axis) {
  const std::size_t which = static_cast<std::size_t>(axis);
  const AxisFacts& facts = chart.axes[which];
  PointsPlot plot;
  plot.title = "Speed against accuracy: " + chart.scene;
  plot.heading.push_back(brief(chart.time) + " s simulated" +
                         (chart.renderer.empty() ? "" : " on " + chart.renderer) +
                         (chart.complete ? "" : "; not complete"));
  if (axis == Axis::position && !chart.horizon_reason.empty()) plot.heading.push_back(chart.horizon_reason);
  plot.x_label = x_label(chart, axis);
  plot.points = &chart.points;
  plot.error = [which](const Point& point) { return point.error[which]; };
  plot.empty = facts.available || facts.reason.empty()
                   ? (chart.complete ? "No point has this error." : "Nothing is measured yet.")
                   : facts.reason;
  plot.lines = lines(chart, axis);
  if (const auto index = index_of(chart.points, chart.present))
    plot.rings.push_back({*index, "now", "present"});
  for (const std::string& words : left_out(chart)) plot.notes.push_back("Left out: " + words + ".");
  for (const std::string& words : chart.notes) plot.notes.push_back(words);
  return draw(plot);
}

}  // namespace clothlab::lab
