#include "server/sim/crossing_check.h"

#include "server/base/text.h"
#include "server/model/bodies.h"
#include "server/model/clean_start.h"

namespace clothlab::sim {

CrossingCheck::CrossingCheck(const Simulation& simulation)
    : simulation_(simulation), surfaces_(model::surfaces_of(simulation.model())) {}

void CrossingCheck::add(const State& state, double time) {
  if (samples_ > 0 && time == last_.time) return;
  std::vector<glm::dvec3> x(state.position.begin(), state.position.end());
  for (const glm::dvec3& of_body : model::body_positions(simulation_.model(), time))
    x.emplace_back(glm::vec3(of_body));
  const model::Crossings found = model::find_crossings(surfaces_, x);
  last_ = {time, found.count};
  ++samples_;
  if (samples_ == 1 || found.count > worst_.count) worst_ = last_;
  if (found.count == 0) return;
  ++crossed_;
  if (first_) return;
  first_ = last_;
  for (const model::Crossing& crossing : found.first)
    pairs_.push_back(model::in_words(crossing, simulation_.model(), simulation_.scene()));
}

void CrossingCheck::report(nlohmann::ordered_json& report) const {
  report["crossings"] = worst_.count;
  nlohmann::ordered_json& check = report["crossing_check"];
  check["samples"] = samples_;
  check["samples_with_crossings"] = crossed_;
  check["first_at"] = first_ ? nlohmann::ordered_json(first_->time) : nlohmann::ordered_json(nullptr);
  check["first_pairs"] = pairs_;
  check["worst_at"] = first_ ? nlohmann::ordered_json(worst_.time) : nlohmann::ordered_json(nullptr);
  check["at_end"] = last_.count;
}

std::string CrossingCheck::in_words() const {
  const std::string of = " of " + std::to_string(samples_) + " samples";
  if (!first_) return "crossings: none in any" + of;
  return "crossings: at most " + std::to_string(worst_.count) + ", at " +
         with_significant_digits(worst_.time, 9) + " s; in " + std::to_string(crossed_) + of + ", first at " +
         with_significant_digits(first_->time, 9) + " s: " + pairs_.front();
}

}  // namespace clothlab::sim
