// How near a session's time step is to the longest stable one. A lower bound of the limit is known at once;
// another thread computes the limit itself. See server/model/stability.h.
#pragma once

#include <future>
#include <optional>
#include <stop_token>
#include <string>

#include "server/model/stability.h"

namespace clothlab::session {

class StepLimit {
 public:
  StepLimit() = default;
  ~StepLimit() { stop_.request_stop(); }
  StepLimit(const StepLimit&) = delete;
  StepLimit& operator=(const StepLimit&) = delete;

  /// Begins to compute the limit of a changed scene. Waits for the result for a few milliseconds at most,
  /// which is enough for a small cloth.
  void set_scene(const model::Model& model, const scene::Scene& scene);
  /// Takes in the computed limit; true if this call received it.
  bool poll();

  /// The limit, or its lower bound until it is `sharp` [s]; model::no_limit: any step is stable, 0: none is.
  double dt_limit() const { return dt_limit_; }
  /// True once the limit itself is known.
  bool sharp() const { return !search_.valid(); }
  std::optional<double> margin() const { return model::margin(scene_.solver.dt, dt_limit_); }
  /// A warning for the user, returned once, after a change of scene has brought the step near its limit or
  /// beyond it.
  std::optional<std::string> take_warning();

 private:
  void give_up_search();

  scene::Scene scene_;  ///< the scene given to the last `set_scene`
  double dt_limit_ = model::no_limit;
  bool warning_checked_ = false;  ///< the present scene has been checked for a warning
  int risk_ = 0;                  ///< at the last check: 0 none, 1 near the limit, 2 beyond it
  std::stop_source stop_;
  std::future<double> given_up_;  ///< the search of an earlier scene, which has been asked to end
  std::future<double> search_;    ///< the present search; the destructor waits for both
};

}  // namespace clothlab::session
