#include "server/lab/draw/points_layout.h"
#include "server/scene/method.h"

#include <algorithm>
#include <cmath>

namespace clothlab::lab {

namespace {

constexpr double plot_left = 78, plot_height = 360, strip_gap = 6;

/// The cost of a setting that blew up [ms per simulated second], if its steps cost what they do at the
/// nearest measured dt of the same method and iterations.
std::optional<double> inferred_cost(const std::vector<Point>& points, const Setting& blown) {
  std::optional<double> cost;
  double nearest = std::numeric_limits<double>::infinity();
  for (const Point& point : points) {
    if (!point.cost || point.setting.method != blown.method) continue;
    if (iterates(blown.method) && point.setting.iterations != blown.iterations) continue;
    const double apart = std::abs(std::log(point.setting.dt / blown.dt));
    if (apart >= nearest) continue;
    nearest = apart;
    cost = point.cost->median * point.setting.dt / blown.dt;
  }
  return cost;
}

/// The smallest and the largest value that an axis must show.
struct Extent {
  double least = std::numeric_limits<double>::infinity(), most = 0;
  void include(double value) {
    if (!(value > 0) || !std::isfinite(value)) return;
    least = std::min(least, value);
    most = std::max(most, value);
  }
  bool empty() const { return most == 0; }
};

void collect(Layout& layout) {
  const std::vector<Point>& points = *layout.plot->points;
  for (std::size_t index = 0; index < points.size(); ++index) {
    const Point& point = points[index];
    if (point.blew_up_at) {
      Cross cross{index, std::nullopt, false};
      if (point.cost)
        cross.cost = point.cost->median;
      else if ((cross.cost = inferred_cost(points, point.setting)))
        cross.inferred = true;
      layout.crosses.push_back(cross);
      continue;
    }
    const std::optional<double> error = layout.plot->error(point);
    if (!error || !point.cost || !std::isfinite(*error)) continue;
    layout.places.push_back({index, *error, point.cost->median, 0, 0});
  }
}

void set_scales(Layout& layout, double top) {
  Extent errors, costs;
  for (const Place& place : layout.places) {
    errors.include(std::min(place.error, 1.0));
    costs.include(place.cost);
    if (place.error > 1) ++layout.points_above_one;
  }
  for (const Cross& cross : layout.crosses)
    if (cross.cost) costs.include(*cross.cost);
  const double least = errors.least;
  // A line far below all points would squeeze them together. The axis leaves it out; its name is at the edge.
  for (const PointsPlot::Line& line : layout.plot->lines)
    if (errors.empty() || line.value > least / 30) errors.include(std::min(line.value, 1.0));
  if (layout.places.empty()) errors = {1e-4, 1};
  costs.include(real_time);
  const double bottom = top + plot_height;
  const double right = picture_width - margin - (layout.crosses.empty() ? 0 : strip_width + strip_gap);
  layout.x = log_scale(errors.least, errors.most, plot_left, right);
  layout.x.high = std::min(layout.x.high, 1.0);  // larger errors are all drawn on the right edge
  layout.y = log_scale(costs.least, costs.most, bottom, top);
  layout.strip_left = layout.crosses.empty() ? right : right + strip_gap;
  for (Place& place : layout.places) {
    place.x = layout.x(place.error > 0 ? place.error : layout.x.low);
    place.y = layout.y(place.cost);
  }
}

}  // namespace

Layout layout_of(const PointsPlot& plot, double top) {
  Layout layout;
  layout.plot = &plot;
  collect(layout);
  set_scales(layout, top);
  return layout;
}

std::vector<Place> front(std::vector<Place> candidates) {
  std::erase_if(candidates, [](const Place& place) { return place.error > 1; });
  std::sort(candidates.begin(), candidates.end(), [](const Place& a, const Place& b) {
    return std::pair(a.error, a.cost) < std::pair(b.error, b.cost);
  });
  std::vector<Place> best;
  for (const Place& place : candidates)
    if (best.empty() || place.cost < best.back().cost) best.push_back(place);
  return best;
}

std::vector<Place> of_method(const Layout& layout, scene::Method method) {
  std::vector<Place> own;
  for (const Place& place : layout.places)
    if (layout.method(place.index) == method) own.push_back(place);
  return own;
}

std::optional<std::pair<double, double>> where(const Layout& layout, std::size_t index) {
  for (const Place& place : layout.places)
    if (place.index == index) return std::pair(place.x, place.y);
  for (const Cross& cross : layout.crosses)
    if (cross.index == index) return std::pair(layout.lane(index), layout.height(cross));
  return std::nullopt;
}

}  // namespace clothlab::lab
