// Results of the lab as JSON, CSV and SVG. The command line writes what the page shows: there is one drawing.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "server/lab/job.h"

namespace clothlab::lab {

/// Every number there is, with its unit in its name; see README.md here.
json to_json(const Outcome& outcome);

/// The result that to_json wrote; numbers that were not finite are NaN, limits of dt infinite. Error: it is
/// no such JSON, with what is wrong.
Result<Outcome> from_json(const json& value);

/// What a chart leaves out, for people: "verlet, vbd (3 points): the budget is spent", a text a reason.
std::vector<std::string> left_out(const Chart& chart);

/// A header and a row a point, cell, trial or variant.
std::string csv(const Outcome& outcome);

/// A picture of its own, without scripts and without inline styles. `axis` is the chart's (and the choice's)
/// horizontal one, the other kinds have none. Every mark that stands for a setting carries the attribute
/// data-index, its place in the JSON's list of points; the root carries the scales (data-x0, data-x1,
/// data-y0, data-y1: the range of values; data-left, data-right, data-top, data-bottom: where that is in the
/// view box).
std::string svg(const Outcome& outcome, Axis axis = Axis::position);

}  // namespace clothlab::lab
