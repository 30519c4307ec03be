// Reads the meshes of cloths and bodies.
#include <memory>

#include "server/scene/sections.h"

namespace clothlab::scene {

std::size_t vertex_count(const Mesh& mesh) {
  if (const Grid* grid = std::get_if<Grid>(&mesh))
    return static_cast<std::size_t>(grid->columns) * static_cast<std::size_t>(grid->rows);
  return std::get<TriangleMesh>(mesh).vertices.size();
}

std::size_t triangle_count(const Mesh& mesh) {
  if (const Grid* grid = std::get_if<Grid>(&mesh))
    return 2 * static_cast<std::size_t>(grid->columns - 1) * static_cast<std::size_t>(grid->rows - 1);
  return std::get<TriangleMesh>(mesh).triangles.size();
}

namespace {

Grid read_grid(const Reader& grid) {
  grid.object({"columns", "rows", "width", "height"});
  return Grid{grid.member("columns", 25).integer(ranges::grid_count),
              grid.member("rows", 25).integer(ranges::grid_count),
              grid.member("width", 1.0).number(ranges::length),
              grid.member("height", 1.0).number(ranges::length)};
}

std::array<std::uint32_t, 3> read_triangle(const Reader& triangle, std::size_t vertex_count) {
  std::array<std::uint32_t, 3> corners{};
  if (triangle.array(3, 3) != 3) return corners;
  const Range index{0, static_cast<double>(vertex_count) - 1, "vertex"};
  for (std::size_t i = 0; i < 3; ++i)
    corners[i] = static_cast<std::uint32_t>(triangle.element(i).integer(index));
  if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0])
    triangle.fail("three different vertices");
  return corners;
}

TriangleMesh read_triangle_mesh(const Reader& mesh, std::size_t most_vertices, std::size_t most_triangles) {
  TriangleMesh result;
  const Reader vertices = mesh.member("vertices"), triangles = mesh.member("triangles");
  result.vertices.resize(vertices.array(3, most_vertices));
  for (std::size_t i = 0; i < result.vertices.size(); ++i)
    result.vertices[i] = vertices.element(i).vector(ranges::position);
  result.triangles.resize(triangles.array(1, most_triangles));
  for (std::size_t i = 0; i < result.triangles.size(); ++i)
    result.triangles[i] = read_triangle(triangles.element(i), result.vertices.size());
  return result;
}

/// The texture coordinates of a file as a pattern. An error if a triangle has no place in it.
void read_pattern(const Reader& pattern, const std::string& name, const mesh::Mesh& file,
                  TriangleMesh& result) {
  pattern.choice({"uv"});
  if (file.texture.empty())
    return pattern.fail("\"uv\", and " + name + " has faces without texture coordinates",
                        "null, or a mesh with texture coordinates at every corner of every face");
  for (std::size_t i = 0; i < file.texture.size(); ++i) {
    const auto& [a, b, c] = file.texture[i];
    if (mesh::has_no_area({a, 0.0}, {b, 0.0}, {c, 0.0}))
      return pattern.fail(
          "\"uv\", and the texture coordinates of " + name + ", " + file.place_of(i) + ", have no area",
          "null, or a flat pattern in which every triangle has an area");
  }
  result.pattern = file.texture;
}

/// The mesh of this name that `assets` has: a file, or one that was uploaded. Null after an error.
SharedMesh find_mesh(const Reader& obj, const Assets* assets, const char* instead) {
  const std::string name = obj.string("the name of a mesh: an .obj or .ply file, or one of mesh.upload");
  if (!obj.is_string()) return nullptr;
  Result<SharedMesh> found = preset_mesh(name);
  if (!found) found = assets ? assets->mesh(name) : Error{name, "there are no meshes to name here", instead};
  if (found) return *found;
  obj.fail(found.error().where + ": " + found.error().what, found.error().remedy);
  return nullptr;
}

TriangleMesh of_file(const mesh::Mesh& file) {
  return {file.vertices, file.triangles, {}, file.vertex_of, file.notes};
}

TriangleMesh read_named_mesh(const Reader& mesh, const Assets* assets) {
  const Reader obj = mesh.member("obj"), pattern = mesh.member("pattern", json(nullptr));
  const SharedMesh file = find_mesh(obj, assets, "a grid, or vertices and triangles");
  if (!file) return {};
  TriangleMesh result = of_file(*file);
  for (std::string& note : result.notes) note = obj.string("") + ": " + note;
  if (!pattern.is_null()) read_pattern(pattern, obj.string(""), *file, result);
  return result;
}

/// The mesh of a cloth in the document, which stays as it is: its vertices are named by number.
TriangleMesh read_own_mesh(const Reader& mesh) {
  TriangleMesh result = read_triangle_mesh(mesh, max_vertices, max_triangles);
  if (!mesh.failed()) result.notes = mesh::notes_of_triangles(result.vertices, result.triangles);
  return result;
}

/// The mesh of a body in the document, cleaned and checked as a file's.
TriangleMesh read_body_mesh(const Reader& mesh) {
  const TriangleMesh given = read_triangle_mesh(mesh, max_body_vertices, max_body_triangles);
  if (mesh.failed()) return {};
  const Result<mesh::Mesh> clean = mesh::assemble_triangles(given.vertices, given.triangles);
  if (clean) return of_file(*clean);
  mesh.fail(clean.error().where + ": " + clean.error().what, clean.error().remedy);
  return {};
}

}  // namespace

std::vector<std::string> mesh_notes(const Scene& scene) {
  std::vector<std::string> notes;
  const auto add = [&](const char* list, std::size_t i, const TriangleMesh& mesh) {
    for (const std::string& note : mesh.notes) notes.push_back(list + std::to_string(i) + "/mesh: " + note);
  };
  for (std::size_t i = 0; i < scene.cloths.size(); ++i)
    if (const auto* mesh = std::get_if<TriangleMesh>(&scene.cloths[i].mesh)) add("/cloths/", i, *mesh);
  for (std::size_t i = 0; i < scene.colliders.size(); ++i)
    if (const auto* body = std::get_if<Body>(&scene.colliders[i].shape)) add("/colliders/", i, *body->mesh);
  return notes;
}

Mesh read_mesh(const Reader& mesh, const Assets* assets) {
  mesh.object({"grid", "vertices", "triangles", "obj", "pattern"});
  if (mesh.has("pattern") && !mesh.has("obj")) mesh.fail("\"pattern\" only beside \"obj\"");
  if (mesh.has("triangles")) {
    if (mesh.has("grid") || mesh.has("obj"))
      mesh.fail("either \"grid\", or \"obj\", or \"vertices\" and \"triangles\"");
    return read_own_mesh(mesh);
  }
  const std::string kind = mesh.exactly_one({"grid", "vertices", "obj"});
  if (kind == "vertices") return read_own_mesh(mesh);
  if (kind == "obj") return read_named_mesh(mesh, assets);
  return read_grid(mesh.member("grid"));
}

Transform read_transform(const Reader& transform) {
  transform.object({"translate", "rotate", "scale"});
  const json zero = {0, 0, 0};
  return Transform{transform.member("translate", zero).vector(ranges::position),
                   transform.member("rotate", zero).vector(ranges::angle),
                   transform.member("scale", 1.0).number(ranges::scale)};
}

Body read_body(const Reader& collider, const Assets* assets) {
  const Reader mesh = collider.member("mesh");
  mesh.object({"vertices", "triangles", "obj"});
  Body body;
  if (mesh.has("triangles") || mesh.has("vertices")) {
    if (mesh.has("obj")) mesh.fail("either \"obj\", or \"vertices\" and \"triangles\"");
    body.mesh = std::make_shared<const TriangleMesh>(read_body_mesh(mesh));
  } else if (const SharedMesh file = find_mesh(mesh.member("obj"), assets, "vertices and triangles")) {
    body.mesh = std::make_shared<const TriangleMesh>(of_file(*file));
  }
  body.transform = read_transform(collider.member("transform", json::object()));
  return body;
}

}  // namespace clothlab::scene
