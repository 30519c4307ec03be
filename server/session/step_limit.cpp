#include "server/session/step_limit.h"

#include <algorithm>
#include <chrono>
#include <utility>
#include <vector>

#include "server/base/priority.h"

namespace clothlab::session {

namespace {
constexpr std::chrono::milliseconds worth_waiting{8};  // half a frame at 60 Hz
}

void StepLimit::set_scene(const model::Model& model, const scene::Scene& scene) {
  warning_checked_ = false;
  const bool same_limit = scene_.cloths == scene.cloths && scene_.air_drag == scene.air_drag &&
                          scene_.solver.method == scene.solver.method && scene_.keys == scene.keys;
  scene_ = scene;
  if (same_limit) return;
  give_up_search();
  std::vector<model::ElementOperator> cloths = model::extreme_operators(model, scene);
  dt_limit_ = model::no_limit;
  for (const model::ElementOperator& elements : cloths)
    dt_limit_ = std::min(dt_limit_, model::dt_limit_bound(scene.solver.method, elements));
  search_ = std::async(std::launch::async,
                       [cloths = std::move(cloths), method = scene.solver.method, stop = stop_.get_token()] {
                         lower_priority(10);  // the search on a large mesh takes many seconds
                         double least = model::no_limit;
                         for (const model::ElementOperator& elements : cloths)
                           least = std::min(least, model::dt_limit(method, elements, stop));
                         return least;
                       });
  search_.wait_for(worth_waiting);
  poll();
}

/// Asks the search to end without waiting for it, as an iteration on a large mesh takes long. At most one
/// given-up search may still run, as each holds the whole mesh.
void StepLimit::give_up_search() {
  stop_.request_stop();
  stop_ = std::stop_source();
  if (search_.valid()) given_up_ = std::move(search_);  // waits for the search given up before
}

bool StepLimit::poll() {
  if (!search_.valid() || search_.wait_for(std::chrono::seconds(0)) != std::future_status::ready)
    return false;
  dt_limit_ = search_.get();
  return true;
}

std::optional<std::string> StepLimit::take_warning() {
  if (warning_checked_) return std::nullopt;
  const double share = dt_limit_ > 0.0 ? scene_.solver.dt / dt_limit_ : model::no_limit;
  const int risk = share > 1.0 ? 2 : share > model::margin_to_warn ? 1 : 0;
  if (risk > 0 && !sharp()) return std::nullopt;  // the bound may be too low
  warning_checked_ = true;
  if (risk <= std::exchange(risk_, risk)) return std::nullopt;
  return model::step_warning(scene_.solver, dt_limit_);
}

}  // namespace clothlab::session
