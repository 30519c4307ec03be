#include "server/model/size.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <type_traits>
#include <variant>

#include "server/scene/sections.h"

namespace clothlab::model {

namespace {

/// The number of pairs of a grid's vertices whose second is `columns_on` columns and `rows_on` rows further.
std::size_t pairs(const scene::Grid& grid, int columns_on, int rows_on) {
  const int columns = grid.columns - columns_on, rows = grid.rows - rows_on;
  return columns > 0 && rows > 0 ? static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows) : 0;
}

template <class Law>
using Of = std::type_identity<Law>;

/// Of laws that a material has no elements of.
template <class Law, class Mesh, class Material>
std::size_t count(Of<Law>, const Mesh&, const Material&) {
  return 0;
}

std::size_t count(Of<elements::Spring>, const scene::Grid& grid, const scene::Springs& material) {
  std::size_t springs = 0;
  if (material.structural != 0.0) springs += pairs(grid, 1, 0) + pairs(grid, 0, 1);
  if (material.shear != 0.0) springs += 2 * pairs(grid, 1, 1);
  if (material.bend != 0.0) springs += pairs(grid, 2, 0) + pairs(grid, 0, 2);
  return springs;
}

/// The most springs that a mesh can have: along three edges a triangle if none is shared, across if all are.
std::size_t count(Of<elements::Spring>, const scene::TriangleMesh& mesh, const scene::Springs& material) {
  const bool any = material.structural != 0.0 || material.shear != 0.0 || material.bend != 0.0;
  return any ? 3 * mesh.triangles.size() + 3 * mesh.triangles.size() / 2 : 0;
}

std::size_t triangles(const scene::Grid& grid) {
  return 2 * pairs(grid, 1, 1);
}
std::size_t triangles(const scene::TriangleMesh& mesh) {
  return mesh.triangles.size();
}

template <class Mesh>
std::size_t count(Of<elements::Membrane>, const Mesh& mesh, const scene::Fem&) {
  return triangles(mesh);
}

/// On a grid a vertex is paired with at most 18 others. On other meshes it is rarely more than 40.
template <class Mesh>
std::size_t count(Of<elements::Bending>, const Mesh& mesh, const scene::Fem& material) {
  const auto& [warp, weft, twist] = material.bending;
  if (!(warp > 0.0 || weft > 0.0 || twist.value_or(0.0) > 0.0)) return 0;
  constexpr bool grid = std::is_same_v<Mesh, scene::Grid>;
  return (grid ? 9 : 20) * scene::vertex_count(mesh);
}

/// Whether all triangles of a mesh lie in parallel planes: its rest shape is certainly not curved.
bool in_parallel_planes(const scene::TriangleMesh& mesh) {
  constexpr double most_angle = 1e-3;
  const auto normal = [&](const auto& triangle) {
    const auto& [a, b, c] = triangle;
    return glm::normalize(
        glm::cross(mesh.vertices[b] - mesh.vertices[a], mesh.vertices[c] - mesh.vertices[a]));
  };
  if (mesh.triangles.empty()) return true;
  const glm::dvec3 first = normal(mesh.triangles[0]);
  // Turned over is another plane: of two such triangles at an edge, one may lie on the other.
  return std::all_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const auto& triangle) {
    return glm::distance(normal(triangle), first) <= most_angle;
  });
}

/// At most 9 vertices around a triangle have a height over it that counts.
std::size_t count(Of<elements::Shell>, const scene::TriangleMesh& mesh, const scene::Fem& material) {
  const bool bends = count(Of<elements::Bending>(), mesh, material) > 0;
  return bends && mesh.pattern.empty() && !in_parallel_planes(mesh) ? 9 * mesh.triangles.size() : 0;
}

Error too_large(const char* what, std::size_t found, std::size_t most, const char* flag) {
  return {"/cloths", std::to_string(found) + " " + what + " in all cloths together",
          "at most " + std::to_string(most) + " (" + flag + "); use a coarser mesh or fewer cloths"};
}

}  // namespace

Size size_of(const scene::Scene& scene) {
  Size size;
  for (const scene::Cloth& cloth : scene.cloths) {
    size.vertices += scene::vertex_count(cloth.mesh);
    size.triangles += scene::triangle_count(cloth.mesh);
    elements::each_law([&]<class Law>(std::type_identity<Law> law) {
      size.elements[elements::law_number<Law>] +=
          std::visit([&](const auto& mesh, const auto& material) { return count(law, mesh, material); },
                     cloth.mesh, cloth.material);
    });
  }
  return size;
}

std::size_t Size::list_texels() const {
  std::size_t sum = 0;
  elements::each_law([&]<class Law>(std::type_identity<Law>) {
    sum += elements::corners<Law> * elements::entry_texels<Law> * elements[elements::law_number<Law>];
  });
  return sum;
}

Status check_size(const Size& size, std::size_t most_vertices, std::size_t most_springs) {
  if (size.vertices > most_vertices)
    return too_large("vertices", size.vertices, most_vertices, "--max-vertices");
  const std::size_t springs = size.elements[elements::law_number<elements::Spring>];
  if (size.all_elements() > most_springs)
    return too_large(springs == size.all_elements() ? "springs" : "springs and other elements",
                     size.all_elements(), most_springs, "--max-springs");
  return ok();
}

}  // namespace clothlab::model
