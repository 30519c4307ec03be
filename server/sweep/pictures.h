// The lab's pictures of a sweep. A chart shows error against cost of the settings: the values of the axes
// that say how a scene is stepped. A map shows which steps blow up over another axis of numbers. Of either
// there is one for each combination of the other axes' values.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "server/sweep/plan.h"
#include "server/sweep/table.h"

namespace clothlab::sweep {

struct Picture {
  std::string name;  ///< of the file, e.g. "chart-rows-21.svg"
  std::string svg;
};

struct Pictures {
  std::vector<Picture> drawn;
  std::size_t beyond = 0;  ///< how many more there would be than `most_pictures`
};

/// More than a reader looks at.
inline constexpr std::size_t most_pictures = 64;

/// Charts where errors and costs are measured and an axis is of the solver's method, dt, iterations or
/// tolerance; maps where an axis is of dt and another one of numbers. `table` is table_of `plan`.
Pictures pictures(const Plan& plan, const Table& table);

}  // namespace clothlab::sweep
