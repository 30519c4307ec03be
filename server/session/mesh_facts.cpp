#include "server/session/mesh_facts.h"

#include <algorithm>
#include <glm/common.hpp>

#include "server/mesh/shape.h"

namespace clothlab::session {

namespace {

using scene::json;

constexpr std::size_t most_borders = 8, most_numbers = 64;  // of a part: about 10 kB of an answer
constexpr std::size_t most_read = 48 * 1024 * 1024;         // bytes read again for parts: about two seconds

json point_list(const glm::dvec3& point) {
  return json::array({point.x, point.y, point.z});
}

/// [vertices of the mesh] the number of the first vertex of the file that each was made of.
std::vector<std::uint32_t> file_numbers(const mesh::Mesh& mesh) {
  std::vector<std::uint32_t> numbers(mesh.vertices.size(), 0);
  for (std::size_t i = mesh.vertex_of.size(); i-- > 0;)
    if (mesh.vertex_of[i] != mesh::no_vertex) numbers[mesh.vertex_of[i]] = static_cast<std::uint32_t>(i);
  return numbers;
}

json shape_facts(const mesh::Mesh& mesh) {
  glm::dvec3 low = mesh.vertices[0], high = low;
  for (const glm::dvec3& vertex : mesh.vertices) {
    low = glm::min(low, vertex);
    high = glm::max(high, vertex);
  }
  const mesh::Shape shape = mesh::shape_of(mesh);
  const std::vector<std::uint32_t> numbers = file_numbers(mesh);
  const auto numbered = [&](const std::vector<std::uint32_t>& vertices) {
    json list = json::array();
    for (const std::uint32_t vertex : mesh::thinned(vertices, most_numbers)) list.push_back(numbers[vertex]);
    return list;
  };
  json borders = json::array(), ends = json::array();
  for (const std::vector<std::uint32_t>& border : shape.borders) {
    if (borders.size() == most_borders) break;
    glm::dvec3 middle(0.0);
    for (const std::uint32_t vertex : border)
      middle += mesh.vertices[vertex] / static_cast<double>(border.size());
    borders.push_back({{"vertices", numbered(border)}, {"middle", point_list(middle)}});
  }
  for (const std::vector<std::uint32_t>& end : shape.ends) ends.push_back(numbered(end));
  return {{"vertices", mesh.vertices.size()},
          {"triangles", mesh.triangles.size()},
          {"parts", mesh.parts},
          {"pattern", !mesh.texture.empty()},
          {"box", json::array({point_list(low), point_list(high)})},
          {"area", shape.area},
          {"pattern_area", shape.pattern_area},
          {"mean_edge", shape.mean_edge},
          {"no_cloth", mesh.no_cloth ? json(mesh.no_cloth->where + ": " + mesh.no_cloth->what) : json()},
          {"borders", std::move(borders)},
          {"ends", std::move(ends)}};
}

}  // namespace

json mesh_facts(const std::string& name, const mesh::Mesh& mesh, const scene::Assets& assets,
                std::size_t bytes) {
  json facts = shape_facts(mesh);
  facts.update({{"name", name},
                {"merged", mesh.merged},
                {"unused", mesh.unused},
                {"flipped", mesh.flipped},
                {"notes", mesh.notes}});
  json nodes = json::array();
  if (mesh.part_names.size() > 1 && mesh.part_names.size() * bytes <= most_read)
    for (const std::string& node : mesh.part_names) {
      mesh::Reading reading;
      reading.node = node;
      const Result<scene::SharedMesh> part = assets.mesh(name, reading);
      if (!part) continue;  // a node without triangles
      json of = shape_facts(**part);
      if (of["triangles"] == facts["triangles"]) continue;  // all of the file
      const auto same = [&](const json& other) {            // a node and its mesh have names of their own
        return other["triangles"] == of["triangles"] && other["box"] == of["box"];
      };
      if (std::any_of(nodes.begin(), nodes.end(), same)) continue;
      of["node"] = node;
      nodes.push_back(std::move(of));
    }
  facts["nodes"] = std::move(nodes);
  return facts;
}

}  // namespace clothlab::session
