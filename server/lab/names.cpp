// The names of axes, jobs and results on the command line, over the WebSocket and in files.
#include <algorithm>

#include "server/lab/job.h"

namespace clothlab::lab {

namespace {
constexpr std::array kinds{"chart", "stability", "choose", "simplify",
                           "compare"};  // in the order of Job and Outcome
constexpr std::array axis_names{"position", "energy", "strain", "rest"};
}  // namespace

const char* name(Axis axis) {
  return axis_names[static_cast<std::size_t>(axis)];
}

std::optional<Axis> axis_of(const std::string& name) {
  const auto found = std::find(axis_names.begin(), axis_names.end(), name);
  if (found == axis_names.end()) return std::nullopt;
  return all_axes[static_cast<std::size_t>(found - axis_names.begin())];
}

const char* name(const Job& job) {
  return kinds[job.index()];
}

const char* name(const Outcome& outcome) {
  return kinds[outcome.index()];
}

}  // namespace clothlab::lab
