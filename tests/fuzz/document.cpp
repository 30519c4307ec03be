#include "tests/fuzz/document.h"

#include <cmath>
#include <glm/common.hpp>
#include <set>
#include <tuple>

#include "server/model/colouring.h"
#include "server/model/stability.h"
#include "server/scene/sections.h"

namespace clothlab::fuzz {

namespace {

constexpr std::size_t most_vertices = 256;  // of a model that is built for every input
constexpr std::size_t most_searched = 64;   // of a model whose step limit is searched

bool carried(double x) {
  return std::isfinite(static_cast<float>(x));
}
bool carried(const glm::dvec3& p) {
  return carried(p.x) && carried(p.y) && carried(p.z);
}

void require_adjacency(const model::Adjacency& adjacency, std::size_t vertices, std::size_t items,
                       std::size_t ends) {
  require(adjacency.offsets.size() == vertices + 1 && adjacency.offsets.front() == 0, "a row a vertex");
  for (std::size_t i = 0; i < vertices; ++i)
    require(adjacency.offsets[i] <= adjacency.offsets[i + 1], "rows follow one another");
  require(adjacency.items.size() == adjacency.offsets.back() && adjacency.items.size() == items * ends,
          "every item is in the row of each of its vertices");
  for (const std::uint32_t item : adjacency.items) require(item < items, "rows name items there are");
}

void require_springs(const model::Model& model) {
  std::set<std::array<std::uint32_t, 2>> seen;
  for (const model::Spring& spring : model.springs()) {
    const auto [a, b] = spring.vertices;
    require(a < b && b < model.vertex_count(), "a spring joins two vertices");
    require(model.vertex_cloth[a] == model.vertex_cloth[b], "a spring stays in its cloth");
    require(spring.law.rest_length >= 0.0 && carried(spring.law.rest_length), "a rest length is a number");
    require(spring.law.stiffness > 0.0, "a spring has a stiffness");
    require(seen.insert(spring.vertices).second, "each spring is there once");
  }
}

void require_vertices(const model::Model& model) {
  for (std::size_t i = 0; i < model.vertex_count(); ++i) {
    require(carried(model.rest_position[i]) && carried(model.start_position[i]),
            "positions are finite float32");
    const auto mass = static_cast<float>(model.mass[i]);
    require(mass > 0.0f && std::isfinite(mass) && std::isfinite(1.0f / mass),
            "a mass and its inverse are finite", std::to_string(model.mass[i]));
    require(std::isfinite(model.texture_coordinates[i].x) && std::isfinite(model.texture_coordinates[i].y),
            "texture coordinates are finite");
    const std::int32_t pin = model.pin_motion[i];
    require(pin == model::not_pinned || (pin >= 0 && static_cast<std::size_t>(pin) < model.motions.size()),
            "a pin has a motion");
  }
}

/// Requires that every item is there once, and that no two items of a colour `conflict`.
template <class Conflict>
void require_colouring(const model::Colouring& colouring, std::size_t items, Conflict conflict) {
  require(colouring.order.size() == items && colouring.offsets.back() == items, "every item has one colour");
  require(std::set<std::uint32_t>(colouring.order.begin(), colouring.order.end()).size() == items,
          "no item has two colours");
  for (std::uint32_t colour = 0; colour < colouring.colours(); ++colour)
    require(!conflict(&colouring.order[0] + colouring.offsets[colour],
                      &colouring.order[0] + colouring.offsets[colour + 1]),
            "what has one colour can be done at once");
}

void require_colourings(const model::Model& model, const scene::Scene& scene) {
  if (model.springs().empty()) return;
  require_colouring(model::colour_elements(model, scene)[0], model.springs().size(),
                    [&](const auto* begin, const auto* end) {
                      std::set<std::uint32_t> taken;
                      for (; begin != end; ++begin)
                        for (const std::uint32_t vertex : model.springs()[*begin].vertices)
                          if (!taken.insert(vertex).second) return true;
                      return false;
                    });
  require_colouring(model::colour_vertices(model, scene), model.vertex_count(),
                    [&](const auto* begin, const auto* end) {
                      const std::set<std::uint32_t> alike(begin, end);
                      bool found = false;
                      for (; begin != end; ++begin)
                        model.springs().at(*begin, [&](const model::Spring& spring, std::size_t corner) {
                          found = found || alike.count(spring.vertices[1 - corner]) > 0;
                        });
                      return found;
                    });
}

}  // namespace

std::size_t vertex_count(const scene::Scene& scene) {
  std::size_t count = 0;
  for (const scene::Cloth& cloth : scene.cloths) count += scene::vertex_count(cloth.mesh);
  return count;
}

void require_sound(const model::Model& model, const scene::Scene& scene) {
  std::size_t triangles = 0, first = 0;
  require(model.cloths.size() == scene.cloths.size(), "a range a cloth");
  for (std::size_t i = 0; i < model.cloths.size(); ++i) {
    const model::ClothRange& range = model.cloths[i];
    require(range.first_vertex == first && range.vertex_count == scene::vertex_count(scene.cloths[i].mesh) &&
                range.first_triangle == triangles &&
                range.triangle_count == scene::triangle_count(scene.cloths[i].mesh),
            "cloths lie end to end and are as large as the document says");
    for (std::size_t vertex = first; vertex < first + range.vertex_count; ++vertex)
      require(model.vertex_cloth[vertex] == i, "a vertex knows its cloth");
    first += range.vertex_count;
    triangles += range.triangle_count;
  }
  require(first == model.vertex_count() && triangles == model.triangle_count(),
          "nothing is beyond the cloths");
  require(model.start_position.size() == first && model.mass.size() == first &&
              model.pin_motion.size() == first && model.texture_coordinates.size() == first &&
              model.vertex_cloth.size() == first,
          "an entry a vertex");
  for (const auto& triangle : model.triangles)
    for (const std::uint32_t corner : triangle) require(corner < first, "a triangle has vertices there are");
  require_vertices(model);
  require_springs(model);
  require_adjacency(model.springs().at_vertex, first, 2 * model.springs().size(), 1);
  require_adjacency(model.vertex_triangles, first, triangles, 3);
  require(model::vertex_fans(model).size() == 6 * triangles,
          "two other corners for each corner of a triangle");
}

void require_model(const scene::Scene& scene) {
  if (vertex_count(scene) > most_vertices) return;
  const Result<model::Model> model = model::build(scene);
  if (!model) {
    require_pointer(model.error());
    return require(!model.error().where.empty(), "a model that cannot be built says why",
                   model.error().text());
  }
  require_sound(*model, scene);
  require_colourings(*model, scene);
  const double bound = model::dt_limit_bound(*model, scene);
  require(bound >= 0.0, "a step limit is 0 or more", std::to_string(bound));
  if (model->vertex_count() > most_searched) return;
  const double limit = model::dt_limit(*model, scene);
  require(limit >= 0.0, "a sharp step limit is 0 or more", std::to_string(limit));
}

}  // namespace clothlab::fuzz
