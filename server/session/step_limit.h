// How near a session's step is to the longest stable one: a safe bound at once, the sharp value as soon as a
// thread beside the session's has it. See server/model/stability.h.
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

  /// The scene has changed. For a small cloth the sharp value is there when this returns; it waits no longer
  /// than a few milliseconds.
  void follow(const model::Model& model, const scene::Scene& scene);
  /// Takes in the sharp value; true if it has come just now.
  bool poll();

  double dt_limit() const { return dt_limit_; }  ///< [s]; model::no_limit, 0: none is stable
  bool sharp() const { return !search_.valid(); }
  std::optional<double> margin() const { return model::margin(scene_.solver.dt, dt_limit_); }
  /// A warning to pass on: when a change of scene has brought the step near its limit, or beyond it.
  std::optional<std::string> take_warning();

 private:
  void give_up_search();

  scene::Scene scene_;  ///< the one that was followed last
  double dt_limit_ = model::no_limit;
  bool looked_ = false;  ///< at the present value
  int risk_ = 0;         ///< when last looked at: 0 none, 1 near the limit, 2 beyond it
  std::stop_source stop_;
  std::future<double> given_up_;  ///< a search that nobody needs any more, and that is about to end
  std::future<double> search_;    ///< both end before this object
};

}  // namespace clothlab::session
