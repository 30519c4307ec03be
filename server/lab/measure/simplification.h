// What a scene's parts are worth: how leaving a part out, or making the mesh coarser, changes error and cost.
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
  std::string name;  ///< "without bend springs", "half the mesh resolution", ..., or some joined by "and"
  json patch;        ///< merge patch that turns the scene into this variant
  bool measured = false;
  std::string reason;  ///< why the variant was not measured: "the scene has no bend springs"
  Errors error;        ///< against the reference of the whole scene
  std::optional<double>
      change;  ///< RMS distance to the whole scene with the same setting, at the horizon, over the size
  std::optional<Cost> cost;
  Spread cost_ratio;  ///< the variant's cost over the whole scene's, both timed in turns
  Saving saving = Saving::unknown;
  double dt_limit = 0;               ///< [s]; infinite: none
  bool recommended_to_drop = false;  ///< leaving this out is recommended
};

struct Simplification {
  std::string scene, renderer;
  Origin origin{};
  double tolerance = 0, time = 0, horizon = 0, size = 0;
  Setting setting;  ///< the scene's own; a coarser mesh or another model takes the same share of its limit
  Variant whole;    ///< the scene as it is
  std::vector<Variant> variants;
  Variant recommended;  ///< the scene without all parts that can go; its patch is empty where none can
  /// True if `recommended` leaves out more than one part, and so is none of `variants`.
  bool drops_several() const;
  std::string why;  ///< a sentence a line: on each simpler model of the cloth, then on what can go
  std::vector<std::string> notes;
  bool complete = false;
};

struct SimplifyRequest {
  double tolerance = 1e-2;     ///< largest `change` allowed: RMS distance over the size; (0, 1]
  std::optional<double> time;  ///< simulated time [s]; none: 1
  /// Times a scene once [ms per simulated second]; none: the scene is run and timed by the clock. For tests,
  /// whose outcome must not depend on the machine's other work.
  std::function<double(const scene::Scene&)> timer = {};
};

/// Needs a current GL context.
Result<Simplification> simplify(const scene::Document& document, const SimplifyRequest& request,
                                const Control<Simplification>& control);

}  // namespace clothlab::lab
