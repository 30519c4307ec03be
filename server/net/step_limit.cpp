#include "server/net/step_limit.h"

#include <chrono>
#include <utility>

namespace clothlab::net {

namespace {
constexpr std::chrono::milliseconds worth_waiting{8};  // half a frame
}

void StepLimit::follow(const model::Model& model, const scene::Scene& scene) {
  stop_.request_stop();
  if (search_.valid()) search_.wait();  // an iteration at most
  stop_ = std::stop_source();
  solver_ = scene.solver;
  looked_ = false;
  model::SpringOperator springs(model, scene, model.rest_position);
  dt_limit_ = model::dt_limit_bound(solver_.method, springs);
  search_ = std::async(std::launch::async,
                       [springs = std::move(springs), method = solver_.method, stop = stop_.get_token()] {
                         return model::dt_limit(method, springs, stop);
                       });
  search_.wait_for(worth_waiting);
  poll();
}

void StepLimit::poll() {
  if (search_.valid() && search_.wait_for(std::chrono::seconds(0)) == std::future_status::ready)
    dt_limit_ = search_.get();
}

std::optional<std::string> StepLimit::take_warning() {
  if (looked_ || !sharp()) return std::nullopt;  // the bound may cry wolf
  looked_ = true;
  const double share = dt_limit_ > 0.0 ? solver_.dt / dt_limit_ : model::no_limit;
  const int risk = share > 1.0 ? 2 : share > model::margin_to_warn ? 1 : 0;
  if (risk <= std::exchange(risk_, risk)) return std::nullopt;
  return model::step_warning(solver_, dt_limit_);
}

}  // namespace clothlab::net
