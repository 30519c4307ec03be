#include "server/sim/sweep_form.h"

#include <glad/gl.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "server/gl/device_fact.h"
#include "server/gl/software/software.h"
#include "server/sim/simulation.h"

namespace clothlab::sim {

namespace {

enum class Form { one_group, dispatches };

/// Decides the form of simulations that the thread makes, while they are measured.
thread_local std::optional<Form> form_under_test;

std::optional<Form> asked_form() {
  if (form_under_test) return form_under_test;
  const char* asked = std::getenv("CLOTHLAB_SWEEPS");
  if (!asked) return std::nullopt;
  if (std::string_view(asked) == "dispatches") return Form::dispatches;
  return std::string_view(asked) == "one_group" ? std::optional(Form::one_group) : std::nullopt;
}

constexpr int sweeps = 4;

/// A sheet that hangs from two corners, `side` vertices squared.
std::unique_ptr<Simulation> sheet(int side, bool by_vertex, Form form) {
  scene::Scene scene;
  scene::Cloth cloth;
  cloth.mesh = scene::Grid{side, side, 0.5, 0.5};
  cloth.pins = {{scene::AtCorner{0, 0}, {}}, {scene::AtCorner{side - 1, 0}, {}}};
  scene.cloths = {cloth};
  scene.solver = {by_vertex ? scene::Method::vbd : scene::Method::xpbd, 1e-3, sweeps, 1e-4};
  form_under_test = form;
  Result<std::unique_ptr<Simulation>> made = Simulation::create(scene);
  form_under_test.reset();
  return made ? std::move(*made) : nullptr;
}

/// At two sizes of sheet, by how much longer the form of many dispatches takes for a step [s].
struct Excess {
  double vertices = 0.0, dispatches = 0.0, seconds = 0.0;
};

std::optional<Excess> excess(int side, bool by_vertex) {
  const auto one = sheet(side, by_vertex, Form::one_group), many = sheet(side, by_vertex, Form::dispatches);
  if (!one || !many) return std::nullopt;
  const auto run = [](Simulation& simulation) {
    return [&simulation](int steps) { simulation.step(static_cast<std::uint32_t>(steps)); };
  };
  const gl::TwoTimes times = gl::time_in_turn(run(*one), run(*many));
  const double dispatches =
      static_cast<double>(many->dispatches()) / static_cast<double>(many->step_index()) / sweeps;
  return Excess{double(side) * side, dispatches, times.other - times.one};
}

double measure(bool by_vertex) {
  const std::optional<Excess> small = excess(12, by_vertex), large = excess(32, by_vertex);
  constexpr double any_number = 1e6;
  if (!small || !large) return any_number;
  // The excess is taken to be linear in the vertices.
  const double falls = (small->seconds - large->seconds) / (large->vertices - small->vertices);
  if (falls <= 0.0) return large->seconds > 0.0 ? any_number : 0.0;
  const double even = small->vertices + small->seconds / falls;
  return std::clamp(even / small->dispatches, 0.0, any_number);
}

/// So many vertices have room in a work group's shared memory.
std::uint32_t most_vertices(bool self_collision) {
  GLint bytes = 0;
  glGetIntegerv(GL_MAX_COMPUTE_SHARED_MEMORY_SIZE, &bytes);
  return static_cast<std::uint32_t>(bytes) / (self_collision ? 32 : 16);
}

}  // namespace

double vertices_a_dispatch(bool by_vertex) {
  const std::string method = by_vertex ? "VBD" : "XPBD";
  return gl::device_fact("vertices a dispatch of " + method + ", even with one work group",
                         [&] { return measure(by_vertex); });
}

std::uint32_t vertex_room(std::uint32_t vertices, bool self_collision) {
  return std::min(std::bit_ceil(std::max(vertices, 64U)), most_vertices(self_collision));
}

std::uint32_t lanes_of_one_group(const SweptCloth& cloth) {
  if (cloth.vertices > most_vertices(cloth.self_collision)) return 0;
  GLint most_lanes = 0;
  glGetIntegerv(GL_MAX_COMPUTE_WORK_GROUP_INVOCATIONS, &most_lanes);
  const std::uint32_t lanes =
      gl::software_renderer() ? gl::fewest_lanes(cloth.turns) : static_cast<std::uint32_t>(most_lanes);
  if (lanes == 0) return 0;
  const std::optional<Form> asked = asked_form();
  const bool one_group = asked ? *asked == Form::one_group
                               : cloth.vertices <= vertices_a_dispatch(cloth.by_vertex) * cloth.dispatches;
  return one_group ? lanes : 0;
}

}  // namespace clothlab::sim
