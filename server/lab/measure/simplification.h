// What a scene's parts are worth: what leaving one out, or making it coarser, does to error and cost.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "server/lab/measure/chart.h"
#include "server/lab/measure/spread.h"
#include "server/scene/document.h"

namespace clothlab::lab {

struct Variant {
  std::string name;  ///< "without bend springs", "half the mesh resolution", ..., "all of these together"
  json patch;        ///< merge patch of the scene that makes it so
  bool measured = false;
  std::string reason;  ///< why not measured: "the scene has no bend springs"
  Errors error;        ///< against the reference of the whole scene
  std::optional<double>
      change;  ///< RMS distance to the whole scene stepped alike, at the horizon, over the size
  std::optional<Cost> cost;
  Spread cost_ratio;  ///< over the whole scene's, timed taking turns
  Saving saving = Saving::unknown;
  double dt_limit = 0;  ///< [s]; infinite: none
  bool drop = false;    ///< recommended
};

struct Simplification {
  std::string scene, renderer;
  double tolerance = 0, time = 0, horizon = 0, size = 0;
  Setting setting;  ///< all variants are stepped by
  Variant whole;    ///< the scene as it is
  std::vector<Variant> variants;
  Variant recommended;  ///< all that can go, together, measured; its patch is empty where nothing can
  /// Whether `recommended` is none of the variants alone.
  bool together() const;
  std::string why;  ///< one sentence
  std::vector<std::string> notes;
  bool complete = false;
};

struct SimplifyRequest {
  double tolerance = 1e-2;     ///< what a part may change, RMS position over size
  std::optional<double> time;  ///< [s]; none: 1
  /// Times a scene once, in ms a simulated second; none: a stopwatch. For tests, which no machine's other
  /// work is to decide.
  std::function<double(const scene::Scene&)> timer = {};
};

/// Needs a current GL context.
Result<Simplification> simplify(const scene::Document& document, const SimplifyRequest& request,
                                const Control<Simplification>& control);

}  // namespace clothlab::lab
