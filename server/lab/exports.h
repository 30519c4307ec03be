// Results of the lab as JSON, CSV and SVG. The command line and the page use the same drawings.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "server/lab/job.h"

namespace clothlab::lab {

/// The whole result; the names of numbers contain their units. See README.md here.
json to_json(const Outcome& outcome);

/// Reads a result that to_json wrote. Numbers that were not finite become NaN, but a step limit becomes
/// infinite. Error: what is wrong with the JSON.
Result<Outcome> from_json(const json& value);

/// The points that a chart leaves out, for people, one text for each reason: "verlet, vbd (3 points): the
/// budget is spent".
std::vector<std::string> left_out(const Chart& chart);

/// A header, then one row for each point (chart), cell (stability), trial (choose), variant (simplify) or
/// moment (compare).
std::string csv(const Outcome& outcome);

/// A complete SVG file (of a comparison none: empty), without scripts and without inline styles. `axis` is
/// the horizontal axis of a chart or a choice; the other results have no axis to choose. In a chart or a
/// choice every mark of a setting has the attribute data-index, its place in the JSON's list of points, and
/// the root has the scales (data-x0, data-x1, data-y0, data-y1: the ranges of values; data-left, data-right,
/// data-top, data-bottom: where these are in the view box). In a stability map the panel of each method has
/// the scales.
std::string svg(const Outcome& outcome, Axis axis = Axis::position);

}  // namespace clothlab::lab
