#include "server/session/hands.h"

#include <algorithm>
#include <string>

namespace clothlab::session {

namespace {

Refusal too_many() {
  return {Refusal::Reason::over_limit,
          {"", std::to_string(Hands::most) + " hands hold the cloth already", "wait until one lets go"}};
}

}  // namespace

std::optional<Refusal> Hands::start(std::uint64_t by, const GrabStart& start, sim::Simulation& simulation) {
  const model::Model& model = simulation.model();
  if (start.cloth >= model.cloths.size())
    return no_such("/cloth", start.cloth, "a cloth of the scene: cloth", model.cloths.size());
  const model::ClothRange& cloth = model.cloths[start.cloth];
  if (start.vertex >= cloth.vertex_count)
    return no_such("/vertex", start.vertex, "a vertex of this cloth: vertex", cloth.vertex_count);
  const std::uint32_t vertex = cloth.first_vertex + start.vertex;
  if (model.pin_motion[vertex] != model::not_pinned)
    return invalid_value({"/vertex", std::to_string(start.vertex) + ", which a pin holds",
                          "a free vertex; take the pin off first"});
  const std::pair key{by, start.hand};
  if (hands_.size() >= most && !hands_.contains(key)) return too_many();
  hands_[key] = {{by, start.hand, start.cloth, start.vertex, start.target},
                 std::make_shared<const model::Hold>(
                     model::hold_on(model, simulation.scene(), vertex, simulation.read_state().position))};
  return std::nullopt;
}

bool Hands::move(std::uint64_t by, const GrabMove& move) {
  const auto found = hands_.find({by, move.hand});
  if (found == hands_.end()) return false;
  found->second.at.target = move.target;
  return true;
}

bool Hands::end_all(std::uint64_t by) {
  return std::erase_if(hands_, [&](const auto& hand) { return hand.first.first == by; }) > 0;
}

std::vector<sim::Hand> Hands::for_simulation() const {
  std::vector<sim::Hand> list;
  for (const auto& [key, held] : hands_) list.push_back({held.hold, held.at.target});
  return list;
}

std::vector<HandAt> Hands::told() const {
  std::vector<HandAt> list;
  for (const auto& [key, held] : hands_) list.push_back(held.at);
  return list;
}

double Hands::force() const {
  double sum = 0;
  for (const auto& [key, held] : hands_) sum += held.hold->force;
  return sum;
}

double Hands::reach() const {
  double most_reach = 0;
  for (const auto& [key, held] : hands_) most_reach = std::max(most_reach, held.hold->reach);
  return most_reach;
}

}  // namespace clothlab::session
