#include "server/sim/hands.h"

#include <algorithm>
#include <glm/vec4.hpp>
#include <map>

#include "server/sim/integrator.h"

namespace clothlab::sim {

namespace {

constexpr GLuint lanes = 64;

/// `Held` of shaders/hands/hands.glsl.
struct Entry {
  glm::vec4 pull;
  glm::vec3 numbers;
  std::uint32_t vertex;
};

/// The springs of all hands on one vertex.
struct Springs {
  double stiffness = 0, damping = 0, reach = 0;
  glm::dvec3 pull{0.0};  ///< stiffness times target
};

std::map<std::uint32_t, Springs> springs_of(const std::vector<Hand>& hands,
                                            const std::vector<std::uint32_t>& places) {
  std::map<std::uint32_t, Springs> springs;
  for (const Hand& hand : hands)
    for (const model::Hold::Vertex& held : hand.hold->vertices) {
      Springs& at = springs[places.empty() ? held.vertex : places[held.vertex]];
      at.stiffness += held.stiffness;
      at.damping += held.damping;
      at.reach = std::max(at.reach, hand.hold->reach);
      at.pull += held.stiffness * (hand.target + held.offset);
    }
  return springs;
}

}  // namespace

bool Hands::same_holds(const std::vector<Hand>& hands) const {
  return std::equal(hands.begin(), hands.end(), hands_.begin(), hands_.end(),
                    [](const Hand& a, const Hand& b) { return a.hold == b.hold; });
}

Status Hands::set(std::vector<Hand> hands, const model::Model& model,
                  const std::vector<std::uint32_t>& places) {
  if (!hands.empty() && !hold_.id())
    for (auto [program, path] : {std::pair{&hold_, "hands/hold.comp"}, {&release_, "hands/release.comp"}}) {
      Result<gl::Program> loaded = gl::Program::load({path}, {{"GROUP_SIZE", std::to_string(lanes)}});
      if (!loaded) return loaded.error();
      *program = std::move(*loaded);
    }
  std::vector<Entry> entries;
  for (const auto& [vertex, springs] : springs_of(hands, places)) {
    if (model.pin_motion[vertex] != model::not_pinned) continue;
    const double mass = model.mass[vertex];
    entries.push_back(
        {glm::vec4(glm::vec3(springs.pull / springs.stiffness), static_cast<float>(springs.stiffness / mass)),
         glm::vec3(springs.damping / mass, springs.reach, 1.0 / mass), vertex});
  }
  hands_ = std::move(hands);
  count_ = static_cast<std::uint32_t>(entries.size());
  const std::size_t bytes = entries.size() * sizeof(Entry);
  if (held_.bytes() < bytes) held_ = gl::Buffer(bytes);
  if (bytes > 0) held_.upload(entries.data(), bytes);
  return ok();
}

void Hands::run(const gl::Program& program, const StateBuffers& state) const {
  program.use();
  program.set("held_count", static_cast<GLint>(count_));
  held_.bind_storage(slot_held);
  state.position().buffer.bind_storage(slot_held_position);
  state.velocity().buffer.bind_storage(slot_held_velocity);
  glDispatchCompute((count_ + lanes - 1) / lanes, 1, 1);
  wait_for_writes();
}

void Hands::hold(StateBuffers& state, const scene::Scene& scene) const {
  if (count_ == 0) return;
  state.put_aside();
  hold_.set("dt", static_cast<float>(scene.solver.dt));
  glProgramUniform3f(hold_.id(), hold_.location("gravity"), static_cast<float>(scene.gravity.x),
                     static_cast<float>(scene.gravity.y), static_cast<float>(scene.gravity.z));
  run(hold_, state);
}

void Hands::release(const StateBuffers& state) const {
  if (count_ > 0) run(release_, state);
}

}  // namespace clothlab::sim
