// The choice as a picture: the settings that were tried, the tolerance, and the chosen setting.
#include "server/lab/draw/drawings.h"

namespace clothlab::lab {

std::string draw(const Choice& choice, Axis axis) {
  PointsPlot plot;
  plot.title = "Cheapest setting with an error of at most " + brief(choice.tolerance) + ": " + choice.scene;
  plot.heading.push_back(brief(choice.time) + " s simulated" +
                         (choice.renderer.empty() ? "" : " on " + choice.renderer) +
                         (choice.complete ? "" : "; not complete"));
  if (choice.horizon < choice.asked) plot.heading.push_back(choice.horizon_reason);
  if (choice.complete && !choice.why.empty()) plot.heading.push_back(choice.why);
  plot.points = &choice.tried;
  plot.empty = "Nothing is measured yet.";
  if (axis == Axis::position) {
    plot.x_label =
        "largest position error up to " + brief(choice.horizon) + " s: RMS, as a share of the cloth's size";
    plot.error = [](const Point& point) { return point.largest_position_error; };
    plot.lines.push_back({choice.tolerance, "tolerance", "tolerance", "#2c7a3f"});
    if (choice.reference_error > 0)
      plot.lines.push_back({choice.reference_error, "reference's own error", "reference", "#5b5bd6"});
  } else {
    const std::size_t which = static_cast<std::size_t>(axis);
    plot.x_label = std::string(axis == Axis::rest ? "distance to the shape of rest"
                                                  : "error of the " + std::string(name(axis))) +
                   ", as a share";
    plot.error = [which](const Point& point) { return point.error[which]; };
    plot.empty = "What was tried has no such error: the choice is made by positions.";
  }
  const auto ring = [&](const Point& point, const char* words, const char* kind) {
    if (const auto index = index_of(choice.tried, point.setting)) plot.rings.push_back({*index, words, kind});
  };
  if (choice.complete) {
    const std::string chosen = std::string("chosen: ") + scene::name(choice.chosen.setting.method);
    ring(choice.chosen, chosen.c_str(), "chosen");
    if (choice.runner_up) ring(*choice.runner_up, "runner-up", "runner-up");
  }
  ring(choice.present, "now", "present");
  plot.notes = choice.notes;
  return draw(plot);
}

}  // namespace clothlab::lab
