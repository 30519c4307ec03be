// The places of settings in a plot of error against cost. Private to points_*.cpp.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "server/lab/draw/drawings.h"

namespace clothlab::lab {

inline constexpr double mark_radius = 4.6, small_radius = 3.4, cross_radius = 3.6;
inline constexpr double strip_width = 60;
inline constexpr const char* real_time_colour = "#b03a2e";

/// A point that did not blow up, with its place in the plot.
struct Place {
  std::size_t index = 0;       ///< in PointsPlot::points
  double error = 0, cost = 0;  ///< error as a share; cost [ms per simulated second]
  double x = 0, y = 0;         ///< [view box]
};

/// A point that blew up. It is drawn as a cross in the strip to the right of the plot.
struct Cross {
  std::size_t index = 0;       ///< in PointsPlot::points
  std::optional<double> cost;  ///< [ms per simulated second]
  bool inferred = false;       ///< `cost` was not measured, but follows from runs that did not blow up
};

struct Layout {
  const PointsPlot* plot = nullptr;
  Scale x, y;
  double strip_left = 0;  ///< left edge of the strip of crosses; without crosses the plot's right edge
  std::vector<Place> places;
  std::vector<Cross> crosses;
  std::size_t points_above_one = 0;  ///< points with an error above 1

  const Point& point(std::size_t index) const { return (*plot->points)[index]; }
  scene::Method method(std::size_t index) const { return point(index).setting.method; }
  /// x of a point's cross in the strip, where each method has a lane.
  double lane(std::size_t index) const {
    const double lanes = static_cast<double>(scene_methods);
    return strip_left + 3 +
           (strip_width - 6) * (static_cast<double>(mark_shape(method(index))) + 0.5) / lanes;
  }
  double height(const Cross& cross) const { return cross.cost ? y(*cross.cost) : y.from - 5; }
  static constexpr std::size_t scene_methods = 8;
};

/// Places all points of the plot, whose frame starts at `top`.
Layout layout_of(const PointsPlot& plot, double top);

/// The Pareto front of `candidates`, by rising error: each place costs less than every place of smaller
/// error. Places with an error above 1 are left out, as such a result has no accuracy at all.
std::vector<Place> front(std::vector<Place> candidates);
std::vector<Place> of_method(const Layout& layout, scene::Method method);
/// x and y of the point `index` in the view box, if it is drawn.
std::optional<std::pair<double, double>> where(const Layout& layout, std::size_t index);

// Parts of the picture, from back to front.
void draw_lines(Svg& svg, const Layout& layout, std::size_t rows);
void draw_crosses(Svg& svg, const Layout& layout);
void draw_curves(Svg& svg, const Layout& layout);
void draw_marks(Svg& svg, const Layout& layout, Places& taken);
void draw_rings(Svg& svg, const Layout& layout, Places& taken);
void draw_labels(Svg& svg, const Layout& layout, Places& taken);

}  // namespace clothlab::lab
