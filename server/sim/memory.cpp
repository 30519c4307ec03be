#include "server/sim/memory.h"

#include <algorithm>
#include <type_traits>

#include "server/model/size.h"
#include "server/scene/memory.h"

namespace clothlab::sim {

namespace {

// In bytes, with software OpenGL, which keeps all buffers in the process's memory. Measured by
// tests/bench/memory.mjs as the most that the server ever had, less what it has with a scene of 9 vertices.
constexpr double engine = 16e6;          ///< of any simulation: two contexts, compiled kernels
constexpr double vertex = 990;           ///< with its triangles, states, numbering and frames as q16
constexpr double other_frames = 130;     ///< of a vertex: the latest frame of every other form
constexpr double spring = 140;           ///< its lists, on both sides, and what building them takes
constexpr double membrane = 600;         ///< of a triangle
constexpr double building = 240;         ///< of one, while it is built; later methods may have it
constexpr double bending = 100;          ///< of a pair
constexpr double shell = 200;            ///< of an entry
constexpr double limited_element = 130;  ///< with a strain limit
constexpr double windy_vertex = 60;
constexpr double visited_element = 160;  ///< of pbd and xpbd, of finite elements
constexpr double points_vertex = 1150;   ///< with contact of vertices: cells and lists of neighbours
constexpr double surface_vertex = 4700;  ///< with contact of surfaces: pairs, boxes and the filter
constexpr double scene_copies = 12;      ///< of the document, as JSON or as plain data

constexpr double least_kept = 60;  ///< of a vertex, by any method besides the state
constexpr double implicit = 700;   ///< the same by implicit_euler
constexpr double history = 130;    ///< what bdf2 has beside that: two steps, and contact's friction twice

const std::string facts_begin = "{\"memory\": {\"needed\": ";

/// What a method keeps besides the state, of a vertex.
double kept_by(scene::Method method) {
  switch (method) {
    case scene::Method::rk4:
      return 490;
    case scene::Method::implicit_euler:
      return implicit;
    case scene::Method::bdf2:
      return implicit + history;
    case scene::Method::pbd:
    case scene::Method::xpbd:
    case scene::Method::vbd:
      return least_kept + implicit;  // which measures how far sweeps are from solved
    default:
      return least_kept;
  }
}

double of_law(std::type_identity<elements::Spring>) {
  return spring;
}
double of_law(std::type_identity<elements::Membrane>) {
  return membrane;
}
double of_law(std::type_identity<elements::Bending>) {
  return bending;
}
template <class Law>
double of_law(std::type_identity<Law>) {
  return shell;
}

std::size_t body_vertices(const scene::Scene& scene) {
  std::size_t sum = 0;
  for (const scene::Collider& collider : scene.colliders)
    if (const auto* body = std::get_if<scene::Body>(&collider.shape)) sum += body->mesh->vertices.size();
  return sum;
}

bool limits_strain(const scene::Scene& scene) {
  for (const scene::Cloth& cloth : scene.cloths)
    if (cloth.strain_limit()) return true;
  return false;
}

}  // namespace

std::uint64_t expected_memory(const scene::Scene& scene) {
  const model::Size size = model::size_of(scene);
  const auto vertices = static_cast<double>(size.vertices),
             bodies = static_cast<double>(body_vertices(scene)),
             all = static_cast<double>(size.all_elements());
  const scene::Method method = scene.solver.method;
  const auto membranes = static_cast<double>(size.elements[elements::law_number<elements::Membrane>]);
  double bytes = engine + (vertex + other_frames) * vertices +
                 std::max(kept_by(method) * vertices, least_kept * vertices + building * membranes);
  double springs = 0;
  elements::each_law([&]<class Law>(std::type_identity<Law> law) {
    const auto count = static_cast<double>(size.elements[elements::law_number<Law>]);
    bytes += of_law(law) * count;
    if (std::is_same_v<Law, elements::Spring>) springs = count;
  });
  if (limits_strain(scene)) bytes += limited_element * all;
  if (method == scene::Method::pbd || method == scene::Method::xpbd)
    bytes += visited_element * (all - springs);
  if (scene.wind) bytes += windy_vertex * vertices;
  if (scene.collides(scene::ContactKind::points)) bytes += points_vertex * vertices;
  if (scene.collides(scene::ContactKind::surface) || bodies > 0)
    bytes += surface_vertex * (vertices + bodies);
  bytes += scene_copies * static_cast<double>(scene::memory_of(scene));
  return static_cast<std::uint64_t>(bytes);
}

Result<MemoryBudget::Reservation> reserve_memory(const std::shared_ptr<MemoryBudget>& budget,
                                                 const scene::Scene& scene) {
  constexpr MemoryBudget::Use use = MemoryBudget::Use::simulations;
  const std::uint64_t needed = budget ? expected_memory(scene) : 0;
  Result<MemoryBudget::Reservation> place = MemoryBudget::reserve(budget, use, needed);
  if (place) return place;
  const std::uint64_t left = budget->left(use);
  return Error{
      "/cloths",
      std::to_string(model::size_of(scene).vertices) + " vertices, which take " + memory_text(needed) +
          " of memory",
      "at most " + memory_text(left) + ", which are left of " + memory_text(budget->share(use)) +
          " for all scenes of this server: a smaller scene, fewer sessions, or a larger --max-memory",
      facts_begin + std::to_string(needed) + ", \"left\": " + std::to_string(left) + "}}"};
}

bool is_lack_of_memory(const Error& error) {
  return error.facts.starts_with(facts_begin);
}

}  // namespace clothlab::sim
