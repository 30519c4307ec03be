// What a job of the lab and whoever started it have to do with each other while it runs.
#pragma once

#include <functional>
#include <stop_token>
#include <string>

#include "server/base/result.h"

namespace clothlab::lab {

struct Progress {
  double done = 0, total = 1;  ///< shares of the job; `total` may grow
  std::string doing;           ///< "reference, 0.4 of 1 s", "verlet, dt 0.5 ms"
};

/// `Partial` is the job's own kind of result, as far as it has come. All calls come from the job's thread; a
/// job looks at `stop` at least every 0.2 s and then returns `cancelled`.
template <class Partial>
struct Control {
  std::stop_token stop = {};
  std::function<void(const Progress&)> progress = [](const Progress&) {};
  std::function<void(const Partial&)> arrived = [](const Partial&) {};
};

inline const Error cancelled{"lab", "cancelled", ""};
inline bool was_cancelled(const Error& error) {
  return error.where == "lab" && error.what == "cancelled";
}

}  // namespace clothlab::lab
