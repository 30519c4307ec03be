#include "server/model/clean_start.h"

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>

#include "server/base/disjoint_sets.h"
#include "server/base/text.h"
#include "server/model/bodies.h"

namespace clothlab::model {

namespace {

using nlohmann::json;

/// A start of more crossings is a tangle, and the number says no more than this one.
constexpr CrossingLimits at_start{64, 10000};
constexpr std::size_t most_in_words = 3;

/// The number that the document gives a vertex of the mesh: of those of a file that became one, the first.
std::size_t number_in_document(const scene::TriangleMesh& mesh, std::uint32_t vertex) {
  const std::vector<std::uint32_t>& of = mesh.vertex_of;
  if (of.empty()) return vertex;
  return static_cast<std::size_t>(std::find(of.begin(), of.end(), vertex) - of.begin());
}
std::size_t number_in_document(const scene::Mesh& mesh, std::uint32_t vertex) {
  const auto* triangles = std::get_if<scene::TriangleMesh>(&mesh);
  return triangles ? number_in_document(*triangles, vertex) : vertex;
}

/// A cloth or a body, and the number that the document gives one of its vertices.
struct Place {
  bool body;
  std::uint32_t index;      ///< in the list of cloths, or of colliders
  const std::string& name;  ///< the document's
  std::size_t number;
};

Place place_of(std::uint32_t vertex, const Model& model, const scene::Scene& scene) {
  if (vertex < model.vertex_count()) {
    const std::uint32_t index = model.vertex_cloth[vertex];
    const scene::Cloth& cloth = scene.cloths[index];
    return {false, index, cloth.name,
            number_in_document(cloth.mesh, vertex - model.cloths[index].first_vertex)};
  }
  const std::uint32_t of_body = vertex - model.vertex_count();
  const BodyRange& body = model.bodies[model.vertex_body[of_body]];
  const scene::Collider& collider = scene.colliders[body.collider];
  const std::uint32_t number = of_body - body.first_vertex;
  const auto* of_mesh = std::get_if<scene::Body>(&collider.shape);  // else a corner of a box
  return {true, body.collider, collider.name, of_mesh ? number_in_document(*of_mesh->mesh, number) : number};
}

/// E.g. `/cloths/0 ("left")`.
std::string in_words(const Place& place) {
  return (place.body ? "/colliders/" : "/cloths/") + std::to_string(place.index) + " (\"" + place.name +
         "\")";
}

/// E.g. `edge 3-4 of /cloths/0 ("left")`.
template <std::size_t count>
std::string corners(const std::string& what, const std::array<std::uint32_t, count>& vertices,
                    const Model& model, const scene::Scene& scene) {
  std::string text = what;
  for (std::size_t i = 0; i < count; ++i)
    text += (i == 0 ? " " : "-") + std::to_string(place_of(vertices[i], model, scene).number);
  return text + " of " + in_words(place_of(vertices[0], model, scene));
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

/// An edge or a triangle of a cloth or a body: its vertices as the document numbers them, and where they are.
template <std::size_t count>
json part(const std::array<std::uint32_t, count>& vertices, const Model& model, const scene::Scene& scene,
          const std::vector<dvec3>& position) {
  const Place first = place_of(vertices[0], model, scene);
  json numbers = json::array(), places = json::array();
  for (const std::uint32_t vertex : vertices) {
    numbers.push_back(place_of(vertex, model, scene).number);
    places.push_back(point(position[vertex]));
  }
  return {{first.body ? "collider" : "cloth", first.index},
          {"name", first.name},
          {"vertices", numbers},
          {"at", places}};
}

/// Crossings as data for programs; see the schema `crossings` of server/net/asyncapi.yaml.
std::string facts_of(const Crossings& found, const Model& model, const scene::Scene& scene, bool at_present,
                     const std::vector<dvec3>& position) {
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

/// E.g. `2 crossings: edge ... meets triangle ..., edge ... meets triangle ...`.
std::string list_of(const Crossings& found, const Model& model, const scene::Scene& scene) {
  std::string text = std::to_string(found.count) + (found.complete ? "" : " or more") +
                     (found.count == 1 ? " crossing: " : " crossings: ");
  const std::size_t told = std::min(found.first.size(), most_in_words);
  for (std::size_t i = 0; i < told; ++i)
    text += (i == 0 ? "" : ", ") + in_words(found.first[i], model, scene);
  return found.count > told ? text + ", ..." : text;
}

/// What was tried, or can be.
std::string led_out_in_words(const Model& model) {
  return model.dressed ? formatted(", after %.3g s of leading out", model.dressed->seconds) : "";
}
std::string lead_out(const Model& model) {
  return model.dressed ? "; or more seconds of \"dress\", if fewer crossings were left than there had been"
                       : "; or `\"start\": {\"dress\": 1}` of the cloth, which leads it out before time 0";
}

Status check_cloths(const Model& model, const scene::Scene& scene, bool at_present,
                    const std::vector<dvec3>& x, const std::string& remedy) {
  const Crossings found = find_crossings(surfaces_of(model, Bodies::none), x, at_start);
  if (found.count == 0) return ok();
  return Error{"/self_collision/kind",
               std::string("\"surface\", but ") + (at_present ? "the cloth at present" : "the start") +
                   (at_present ? "" : led_out_in_words(model)) + " has " + list_of(found, model, scene),
               "\"points\", which may have crossings, or " + remedy,
               facts_of(found, model, scene, at_present, x)};
}

/// Error: cloth at the start goes through a body. `x`: of all cloths and bodies.
Status check_bodies(const Model& model, const scene::Scene& scene, const std::vector<dvec3>& x) {
  Surfaces surfaces = surfaces_of(model, Bodies::meshes);
  surfaces.among_cloths = false;
  const Crossings found = find_crossings(surfaces, x, at_start);
  if (found.count == 0) return ok();
  const Crossing& first = found.first[0];
  const Place body = place_of(std::max(first.edge[0], first.triangle[0]), model, scene);
  return Error{"/colliders/" + std::to_string(body.index),
               "\"" + body.name + "\", and cloth that goes through triangles at the start" +
                   led_out_in_words(model) + ", with " + list_of(found, model, scene),
               "body and cloth moved apart (transform, start) until none touches the other" + lead_out(model),
               facts_of(found, model, scene, false, x)};
}

/// One vertex of each piece of cloth that hangs together.
std::vector<std::uint32_t> one_of_each_piece(const Model& model) {
  DisjointSets pieces(model.vertex_count());
  for (const auto& [a, b, c] : model.triangles) {
    pieces.join(a, b);
    pieces.join(a, c);
  }
  std::vector<std::uint32_t> first;
  for (std::uint32_t i = 0; i < model.vertex_count(); ++i)
    if (pieces.find(i) == i) first.push_back(i);
  return first;
}

/// Error: cloth starts inside a body. It crosses none of its triangles: a piece is inside as a whole, or not.
Status check_inside(const Model& model, const scene::Scene& scene, const std::vector<dvec3>& x) {
  const std::vector<std::uint32_t> pieces = one_of_each_piece(model);
  const std::vector<dvec3> of_bodies(x.begin() + model.vertex_count(), x.end());
  for (std::uint32_t body = 0; body < model.bodies.size(); ++body) {
    if (model.bodies[body].box) continue;
    const BodyInside inside(model, body, of_bodies);
    for (const std::uint32_t vertex : pieces) {
      if (!inside.contains(x[vertex])) continue;
      const Place of = place_of(vertex, model, scene);
      const std::string pointer = "/colliders/" + std::to_string(model.bodies[body].collider);
      return Error{pointer,
                   "\"" + scene.colliders[model.bodies[body].collider].name + "\", and inside it vertex " +
                       std::to_string(of.number) + " of " + in_words(of) +
                       ", with all cloth that hangs on it, at the start" + led_out_in_words(model),
                   "cloth that starts outside (transform, start" +
                       std::string(model.dressed ? "" : "; `{\"dress\": 1}` leads it out") +
                       "), or a mesh that is open: it has no inside, "
                       "and cloth stays on its side of each triangle"};
    }
  }
  return ok();
}

}  // namespace

std::string place_in_words(std::uint32_t vertex, const Model& model, const scene::Scene& scene) {
  return corners("vertex", std::array{vertex}, model, scene);
}

std::string in_words(const Crossing& crossing, const Model& model, const scene::Scene& scene) {
  const dvec3& at = crossing.place;
  return corners("edge", crossing.edge, model, scene) + " meets " +
         corners("triangle", crossing.triangle, model, scene) + " at (" + number(at.x) + ", " + number(at.y) +
         ", " + number(at.z) + ")";
}

Status check_start(const Model& model, const scene::Scene& scene) {
  const bool surfaces = scene.collides(scene::ContactKind::surface);
  // Boxes push cloth out that starts in them.
  const bool has_meshes =
      std::any_of(model.bodies.begin(), model.bodies.end(), [](const BodyRange& body) { return !body.box; });
  if (!surfaces && !has_meshes) return ok();
  std::vector<dvec3> x = as_floats(model.start_position);
  if (surfaces)
    if (Status apart = check_cloths(
            model, scene, false, x,
            "cloths moved apart (transform, mesh, start) until none touches another one or itself" +
                lead_out(model));
        !apart)
      return apart;
  if (!has_meshes) return ok();
  const std::vector<dvec3> bodies = as_floats(body_positions(model, 0.0));
  x.insert(x.end(), bodies.begin(), bodies.end());
  if (Status apart = check_bodies(model, scene, x); !apart) return apart;
  return check_inside(model, scene, x);
}

Status check_present(const Model& model, const scene::Scene& scene, const std::vector<glm::vec3>& position) {
  if (!scene.collides(scene::ContactKind::surface)) return ok();
  return check_cloths(model, scene, true, {position.begin(), position.end()},
                      "a reset first, if the start has none");
}

}  // namespace clothlab::model
