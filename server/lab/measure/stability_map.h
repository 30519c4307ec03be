// Where each method becomes unstable: time step against a number of the scene, stiffness by default; the
// measured boundary, theory's line, and how fast energy grows on both sides.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/lab/measure/control.h"
#include "server/lab/measure/setting.h"
#include "server/scene/document.h"

namespace clothlab::lab {

struct MapCell {
  double dt = 0;  ///< [s]
  double growth =
      0;  ///< log10 of the most energy that moved or stretched over what it is with a stable step; 0 to 6
  bool blew_up = false;
};

/// One value of the number that is varied.
struct MapColumn {
  double value = 0;              ///< of the field, or the factor on all stiffnesses
  std::optional<double> theory;  ///< longest stable step [s]; none: no limit; 0: no step is stable
  std::optional<double> held;    ///< longest step shorter than `failed` that held [s]
  std::optional<double> failed;  ///< shortest that failed [s]; none: none tried did
  bool disagrees = false;        ///< measured and theory more than 5 % apart
  std::string reason;            ///< what is likely behind it
  std::vector<MapCell> cells;    ///< every step that was tried, rising dt
};

struct MethodMap {
  scene::Method method = scene::Method::symplectic_euler;
  std::vector<MapColumn> columns;  ///< rising value
};

struct StabilityMap {
  std::string scene, renderer;
  std::string field;  ///< JSON Pointer, or "stiffness": all stiffnesses of all cloths times a factor
  std::string unit;   ///< "N/m", "kg", "times the present", ... or empty
  double present_value = 1, present_dt = 0;
  scene::Method present_method = scene::Method::symplectic_euler;
  double time = 0;  ///< simulated at most [s] ...
  int steps = 0;    ///< ... and steps at most, a trial
  std::vector<MethodMap> methods;
  std::vector<std::string> notes;  ///< disagreements first, whole sentences
  bool complete = false;
};

struct MapRequest {
  std::vector<scene::Method> methods;  ///< empty: all
  std::string field = "stiffness";     ///< or the JSON Pointer of a number of the scene
  /// Of the field. None: a hundredth and a hundred times the present value, or as far as the scene allows; a
  /// quarter and four times where only whole numbers are allowed; twice the present value and 0 below 0.
  std::optional<double> from, to;
  int columns = 9;  ///< 2 to 41, evenly spaced in the logarithm where from > 0
};

/// Needs a current GL context. A trial holds unless sim::BlowUp calls it a blow-up, told nothing of any
/// limit. Error: no such number in the scene ("field"), a range that is not one ("from", "to", "columns") or
/// not allowed there (the field), or cancelled.
Result<StabilityMap> stability_map(const scene::Document& document, const MapRequest& request,
                                   const Control<StabilityMap>& control);

}  // namespace clothlab::lab
