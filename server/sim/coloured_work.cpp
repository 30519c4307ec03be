#include "server/sim/coloured_work.h"

#include <glad/gl.h>

#include <algorithm>
#include <cstdlib>
#include <string_view>

#include "server/gl/context.h"
#include "server/model/spring_gains.h"

namespace clothlab::sim {

namespace {

bool pinned(const model::Model& model, std::uint32_t vertex) {
  return model.pin_motion[vertex] != model::not_pinned;
}

/// The items of `all` for which `wanted(item)` is true. Colours that are left without items are removed.
template <class Wanted>
model::Colouring only(const model::Colouring& all, Wanted wanted) {
  model::Colouring kept;
  kept.offsets.push_back(0);
  for (std::uint32_t colour = 0; colour < all.colours(); ++colour) {
    for (std::uint32_t k = all.offsets[colour]; k < all.offsets[colour + 1]; ++k)
      if (wanted(all.order[k])) kept.order.push_back(all.order[k]);
    if (kept.order.size() > kept.offsets.back())
      kept.offsets.push_back(static_cast<std::uint32_t>(kept.order.size()));
  }
  return kept;
}

}  // namespace

model::Colouring visited_springs(const model::Model& model, const scene::Scene& scene) {
  return only(model::colour_elements(model, scene, model.springs()), [&](std::uint32_t spring) {
    const auto [a, b] = model.springs()[spring].vertices;
    return !pinned(model, a) || !pinned(model, b);
  });
}

model::Colouring visited_vertices(const model::Model& model, const scene::Scene& scene) {
  return only(model::colour_vertices(model, scene),
              [&](std::uint32_t vertex) { return !pinned(model, vertex); });
}

ProjectedSprings projected_springs(const model::Colouring& visited, const model::Model& model,
                                   const scene::Scene& scene) {
  ProjectedSprings list;
  const double mobility = model::mobility(scene);
  const auto inverse_mass = [&](std::uint32_t vertex) {
    return pinned(model, vertex) ? 0.0 : mobility / model.mass[vertex];
  };
  for (const std::uint32_t index : visited.order) {
    const auto& [vertices, law] = model.springs()[index];
    const auto [a, b] = vertices;
    const elements::SpringGains gains =
        model::spring_gains(scene.solver, law.stiffness, law.damping, inverse_mass(a) + inverse_mass(b));
    list.entries.push_back({a, b, static_cast<float>(law.rest_length), static_cast<float>(gains.stretch)});
    list.gains.push_back({static_cast<float>(gains.damping), static_cast<float>(gains.memory)});
  }
  return list;
}

std::uint32_t lanes_of_one_group(std::uint32_t vertex_count, bool self_collision,
                                 const std::function<std::uint64_t(std::uint32_t)>& turns) {
  const char* asked = std::getenv("CLOTHLAB_SWEEPS");
  if (asked && std::string_view(asked) == "dispatches") return 0;
  GLint shared_bytes = 0, most_lanes = 0;
  glGetIntegerv(GL_MAX_COMPUTE_SHARED_MEMORY_SIZE, &shared_bytes);
  glGetIntegerv(GL_MAX_COMPUTE_WORK_GROUP_INVOCATIONS, &most_lanes);
  const std::size_t needed = std::size_t{vertex_count} * 16 * (self_collision ? 2 : 1);
  if (needed > static_cast<std::size_t>(shared_bytes)) return 0;
  if (!gl::software_renderer()) return static_cast<std::uint32_t>(most_lanes);
  for (std::uint32_t lanes = 8; lanes <= 128; lanes *= 2)
    if (turns(lanes) < 50000) return lanes;  // well below 65535: how Mesa counts is not documented
  return 0;
}

}  // namespace clothlab::sim
