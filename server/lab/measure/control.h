// What a job of the lab and its caller exchange while the job runs: progress, partial results, a stop token.
#pragma once

#include <functional>
#include <stop_token>
#include <string>

#include "server/base/result.h"
#include "server/lab/measure/origin.h"

namespace clothlab::lab {

struct Progress {
  double done = 0, total = 1;  ///< work done out of the total, in any unit; `total` may grow
  std::string doing;           ///< the present work: "verlet, dt 0.5 ms"
};

/// `Partial` is the type of the job's result; `arrived` gets the result as far as it has come. All calls come
/// from the job's thread. A job checks `stop` at least every 0.2 s; if set, the job returns `cancelled`.
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
