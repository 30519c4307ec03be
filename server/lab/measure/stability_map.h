// Where each method becomes unstable: a map of the time step against a number of the scene (stiffness by
// default), with the measured boundary, theory's line, and the growth of energy on both sides.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/lab/measure/control.h"
#include "server/lab/measure/setting.h"
#include "server/scene/document.h"

namespace clothlab::lab {

inline constexpr double most_growth = 6.0;  ///< of energy, that a map tells apart

/// One trial: a run of the scene with one time step.
struct MapCell {
  double dt = 0;  ///< [s]
  double growth =
      0;  ///< log10 of the largest kinetic + elastic energy over that with a stable step; 0 to most_growth
  bool blew_up = false;
};

/// The trials at one value of the varied number.
struct MapColumn {
  double value = 0;              ///< of the varied number, or the factor on all stiffnesses
  std::optional<double> theory;  ///< longest stable step [s]; none: no limit; 0: no step is stable
  std::optional<double> held;    ///< longest step shorter than `failed` that held [s]
  std::optional<double> failed;  ///< shortest step that failed [s]; none: no trial failed
  bool disagrees = false;        ///< the measured boundary and theory are more than 5 % apart
  std::string reason;            ///< the likely cause, if they disagree
  std::vector<MapCell> cells;    ///< every step that was tried, in the order of rising dt
};

struct MethodMap {
  scene::Method method = scene::Method::symplectic_euler;
  std::vector<MapColumn> columns;  ///< in the order of rising value
};

struct StabilityMap {
  std::string scene, renderer;
  Origin origin{};
  std::string field;  ///< JSON Pointer, or "stiffness": all stiffnesses of all cloths times a factor
  std::string unit;   ///< "N/m", "kg", "times the present", ... or empty
  double present_value = 1, present_dt = 0;
  scene::Method present_method = scene::Method::symplectic_euler;
  double time = 0;  ///< the longest simulated time of a trial [s]
  int steps = 0;    ///< the largest number of steps of a trial
  std::vector<MethodMap> methods;
  std::vector<std::string> notes;  ///< whole sentences; disagreements with theory come first
  bool complete = false;
};

struct MapRequest {
  std::vector<scene::Method> methods;  ///< empty: all that suit the scene
  std::string field = "stiffness";     ///< or the JSON Pointer of a number of the scene
  /// The range of the field. None, as far as the scene allows: a hundredth and a hundred times the present
  /// value; a quarter and four times where only whole numbers are allowed; twice the present value and 0
  /// where that value is negative.
  std::optional<double> from, to;
  int columns = 9;  ///< 2 to 41; evenly spaced, in the logarithm where from > 0
};

/// Needs a current GL context. A trial holds unless sim::BlowUp, which is given no step limit here, calls it
/// a blow-up. Error: no such number in the scene ("field"), an invalid range ("from", "to", "columns"), a
/// value that the scene does not allow (the field), or cancelled.
Result<StabilityMap> stability_map(const scene::Document& document, const MapRequest& request,
                                   const Control<StabilityMap>& control);

}  // namespace clothlab::lab
