#include "server/stream/collider_text.h"

#include <algorithm>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <utility>
#include <variant>
#include <vector>

#include "server/scene/solid.h"

namespace clothlab::stream {

using nlohmann::json;

json moving_colliders(const sim::Simulation& simulation) {
  // In most scenes no collider moves: this function then allocates nothing.
  if (!scene::any_has_motion(simulation.scene().colliders)) return nullptr;
  return moving_colliders(simulation.colliders_now());
}

json moving_colliders(const std::vector<scene::Collider>& now) {
  json moving = json::array();
  for (std::size_t i = 0; i < now.size(); ++i) {
    if (!scene::has_motion(now[i].motion)) continue;
    json of = scene::shape_to_json(now[i].shape);
    of["index"] = i;
    moving.push_back(std::move(of));
  }
  if (moving.empty()) return nullptr;
  return moving;
}

std::string collider_text(const sim::Simulation& simulation) {
  json moving = moving_colliders(simulation);
  if (moving.is_null()) return {};
  return json{
      {"jsonrpc", "2.0"},
      {"method", "colliders"},
      {"params",
       {{"step", simulation.step_index()}, {"time", simulation.time()}, {"moving", std::move(moving)}}}}
      .dump();
}

}  // namespace clothlab::stream
