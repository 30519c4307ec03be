#include "server/model/clean_start.h"

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>

#include "server/base/text.h"

namespace clothlab::model {

namespace {

using nlohmann::json;

/// A start of more crossings is a tangle, and the number says no more than this one.
constexpr CrossingLimits at_start{64, 10000};
constexpr std::size_t most_in_words = 3;

/// The number that the document gives a vertex of the cloth: of those of a file that became one, the first.
std::size_t number_in_document(const scene::Mesh& mesh, std::uint32_t vertex) {
  const auto* triangles = std::get_if<scene::TriangleMesh>(&mesh);
  if (!triangles || triangles->vertex_of.empty()) return vertex;
  const std::vector<std::uint32_t>& of = triangles->vertex_of;
  return static_cast<std::size_t>(std::find(of.begin(), of.end(), vertex) - of.begin());
}

/// E.g. `edge 3-4 of /cloths/0 ("left")`.
template <std::size_t count>
std::string corners(const std::string& what, const std::array<std::uint32_t, count>& vertices,
                    const Model& model, const scene::Scene& scene) {
  if (vertices[0] >= model.vertex_count()) return what + " of a body";
  const std::uint32_t index = model.vertex_cloth[vertices[0]];
  const scene::Cloth& cloth = scene.cloths[index];
  std::string text = what;
  for (std::size_t i = 0; i < count; ++i)
    text += (i == 0 ? " " : "-") +
            std::to_string(number_in_document(cloth.mesh, vertices[i] - model.cloths[index].first_vertex));
  return text + " of /cloths/" + std::to_string(index) + " (\"" + cloth.name + "\")";
}

std::string number(double x) {
  return with_significant_digits(x == 0.0 ? 0.0 : x, 4);  // no "-0"
}

/// The shortest number that is this float: JSON would write a float as a double, with digits of no meaning.
json short_number(float x) {
  std::array<char, 32> text{};
  const char* end = std::to_chars(text.data(), text.data() + text.size(), x).ptr;
  double value = 0.0;
  std::from_chars(text.data(), end, value);
  return value;
}

json point(const glm::vec3& x) {
  return {short_number(x.x), short_number(x.y), short_number(x.z)};
}

/// An edge or a triangle of a cloth: its vertices as the document numbers them, and where they are.
template <std::size_t count>
json part(const std::array<std::uint32_t, count>& vertices, const Model& model, const scene::Scene& scene,
          const std::vector<glm::vec3>& position) {
  const std::uint32_t index = model.vertex_cloth[vertices[0]];
  const scene::Cloth& cloth = scene.cloths[index];
  json numbers = json::array(), places = json::array();
  for (const std::uint32_t vertex : vertices) {
    numbers.push_back(number_in_document(cloth.mesh, vertex - model.cloths[index].first_vertex));
    places.push_back(point(position[vertex]));
  }
  return {{"cloth", index}, {"name", cloth.name}, {"vertices", numbers}, {"at", places}};
}

/// Crossings of cloths as data for programs; see the schema `crossings` of server/net/asyncapi.yaml.
std::string facts_of(const Crossings& found, const Model& model, const scene::Scene& scene, bool at_present,
                     const std::vector<glm::vec3>& position) {
  json pairs = json::array();
  for (const Crossing& each : found.first)
    pairs.push_back({{"edge", part(each.edge, model, scene, position)},
                     {"triangle", part(each.triangle, model, scene, position)},
                     {"place", point(each.place)}});
  const json facts = {{"when", at_present ? "present" : "start"},
                      {"count", found.count},
                      {"complete", found.complete},
                      {"pairs", pairs}};
  return json{{"crossings", facts}}.dump(-1, ' ', false, json::error_handler_t::replace);
}

Status check(const Model& model, const scene::Scene& scene, bool at_present,
             const std::vector<glm::vec3>& position, const std::string& remedy) {
  const std::vector<dvec3> x(position.begin(), position.end());
  const Crossings found = find_crossings(surfaces_of(model), x, at_start);
  if (found.count == 0) return ok();
  std::string what = std::string("\"surface\", but ") + (at_present ? "the cloth at present" : "the start") +
                     " has " + std::to_string(found.count) + (found.complete ? "" : " or more") +
                     (found.count == 1 ? " crossing: " : " crossings: ");
  const std::size_t told = std::min(found.first.size(), most_in_words);
  for (std::size_t i = 0; i < told; ++i)
    what += (i == 0 ? "" : ", ") + in_words(found.first[i], model, scene);
  if (found.count > told) what += ", ...";
  return Error{"/self_collision/kind", what, "\"points\", which may have crossings, or " + remedy,
               facts_of(found, model, scene, at_present, position)};
}

}  // namespace

std::string in_words(const Crossing& crossing, const Model& model, const scene::Scene& scene) {
  const dvec3& at = crossing.place;
  return corners("edge", crossing.edge, model, scene) + " meets " +
         corners("triangle", crossing.triangle, model, scene) + " at (" + number(at.x) + ", " + number(at.y) +
         ", " + number(at.z) + ")";
}

Status check_start(const Model& model, const scene::Scene& scene) {
  if (!scene.collides(scene::ContactKind::surface)) return ok();
  return check(model, scene, false, {model.start_position.begin(), model.start_position.end()},
               "cloths moved apart (transform, mesh, start) until none touches another one or itself");
}

Status check_present(const Model& model, const scene::Scene& scene, const std::vector<glm::vec3>& position) {
  if (!scene.collides(scene::ContactKind::surface)) return ok();
  return check(model, scene, true, position, "a reset first, if the start has none");
}

}  // namespace clothlab::model
