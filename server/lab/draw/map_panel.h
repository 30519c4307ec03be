// A panel of the stability map, which shows one method, and the scales that all panels share. Private to
// map_*.cpp.
#pragma once

#include <string>

#include "server/lab/draw/drawings.h"

namespace clothlab::lab {

inline constexpr double panel_height = 210;
inline constexpr const char *blown_colour = "#7f1d2d", *theory_colour = "#000000",
                            *measured_colour = "#1a7f37", *doubt_colour = "#c2188b";

/// The colour of a cell that did not blow up, by MapCell::growth: pale where energy is kept.
std::string shade(double growth);

/// The scales of all panels, equal so that panels can be compared. Places count from a panel's top left.
struct PanelScales {
  Scale x, y;
};
PanelScales panel_scales(const StabilityMap& map, double width);

/// `label_y`: true draws the numbers of the vertical axis.
void draw_panel(Svg& svg, const StabilityMap& map, const MethodMap& method, const PanelScales& scales,
                double left, double top, bool label_y);

}  // namespace clothlab::lab
