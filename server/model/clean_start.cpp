#include "server/model/clean_start.h"

#include <algorithm>

#include "server/base/text.h"

namespace clothlab::model {

namespace {

/// A start of more is a tangle, and the number says no more than this one.
constexpr CrossingLimits at_start{3, 10000};

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

Status check(const Model& model, const scene::Scene& scene, const std::string& which,
             const std::vector<glm::vec3>& position, const std::string& remedy) {
  const std::vector<dvec3> x(position.begin(), position.end());
  const Crossings found = find_crossings(surfaces_of(model), x, at_start);
  if (found.count == 0) return ok();
  std::string what = "\"surface\", but " + which + " has " + std::to_string(found.count) +
                     (found.complete ? "" : " or more") + (found.count == 1 ? " crossing: " : " crossings: ");
  for (std::size_t i = 0; i < found.first.size(); ++i)
    what += (i == 0 ? "" : ", ") + in_words(found.first[i], model, scene);
  if (found.count > found.first.size()) what += ", ...";
  return Error{"/self_collision/kind", what, "\"points\", which may have crossings, or " + remedy};
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
  return check(model, scene, "the start", {model.start_position.begin(), model.start_position.end()},
               "cloths moved apart (transform, mesh, start) until none touches another one or itself");
}

Status check_present(const Model& model, const scene::Scene& scene, const std::vector<glm::vec3>& position) {
  if (!scene.collides(scene::ContactKind::surface)) return ok();
  return check(model, scene, "the cloth at present", position, "a reset first, if the start has none");
}

}  // namespace clothlab::model
