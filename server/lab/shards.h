// A chart or a stability map in parts, one for each method, so that several machines can share the work.
#pragma once

#include <cstddef>
#include <vector>

#include "server/lab/job.h"

namespace clothlab::lab {

/// The jobs, one for each method, whose results are that of `job` together. A chart's `budget` is for each of
/// them. Error: a method that does not suit the scene, or a job that is no chart and no map.
Result<std::vector<Job>> split(const scene::Document& document, const Job& job);

/// The results of some of the `all` jobs of `split`, in their order and at least one, as one result. It is
/// complete if it has all of them and each is complete.
Outcome joined(std::vector<Outcome> parts, std::size_t all);

/// Takes the costs out of a chart's points, and says why in a note.
void leave_out_costs(Chart& chart, const std::string& why);

}  // namespace clothlab::lab
