// Reads the meshes of cloths and bodies.
#include <algorithm>
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

/// The texture coordinates of a file times `scale` as a pattern. An error if a triangle has no place in it.
void read_pattern(const Reader& pattern, double scale, const std::string& name, const mesh::Mesh& file,
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
  for (auto& corners : result.pattern)
    for (glm::dvec2& corner : corners) corner *= scale;
}

/// The names of the key that names a file; the second is the older one.
const Words file_keys{"file", "obj"};

bool names_file(const Reader& mesh) {
  return std::any_of(file_keys.begin(), file_keys.end(),
                     [&](const std::string& key) { return mesh.has(key); });
}

/// How the document wants the file read, which `mesh` has the keys of.
mesh::Reading read_reading(const Reader& mesh) {
  mesh::Reading reading;
  reading.mend = mesh.member("mend", true).boolean(true);
  const Reader node = mesh.member("node", json(nullptr));
  if (!node.is_null())
    reading.node = node.string("null, or the name of an object, group or node of the file");
  if (node.is_string() && reading.node.empty()) node.fail("null, or a name");
  return reading;
}

/// The mesh of this name that `assets` has: a file, or one that was uploaded. Null after an error.
SharedMesh find_mesh(const Reader& file, const mesh::Reading& reading, const Assets* assets,
                     const char* instead) {
  const std::string name =
      file.string("the name of a mesh: an .obj, .ply, .glb or .gltf file, or one of mesh.upload");
  if (!file.is_string()) return nullptr;
  Result<SharedMesh> found = preset_mesh(name, reading);
  if (!found)
    found = assets ? assets->mesh(name, reading) : Error{name, "there are no meshes to name here", instead};
  if (found) return *found;
  file.fail(found.error().where + ": " + found.error().what, found.error().remedy);
  return nullptr;
}

/// `name`: of the file, for its notes; empty: there is none.
TriangleMesh of_file(const mesh::Mesh& file, const std::string& name) {
  TriangleMesh result{file.vertices, file.triangles, {}, file.vertex_of, file.notes};
  if (!name.empty())
    for (std::string& note : result.notes) note = name + ": " + note;
  return result;
}

TriangleMesh read_named_mesh(const Reader& mesh, const Assets* assets) {
  const Reader named = mesh.member(mesh.exactly_one(file_keys));
  const Reader pattern = mesh.member("pattern", json(nullptr));
  const double scale = mesh.member("pattern_scale", 1.0).number(ranges::scale);
  const SharedMesh file = find_mesh(named, read_reading(mesh), assets, "a grid, or vertices and triangles");
  if (!file) return {};
  if (file->no_cloth) {
    named.fail(file->no_cloth->where + ": " + file->no_cloth->what, file->no_cloth->remedy);
    return {};
  }
  TriangleMesh result = of_file(*file, named.string(""));
  if (!pattern.is_null()) read_pattern(pattern, scale, named.string(""), *file, result);
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
  const bool mend = mesh.member("mend", true).boolean(true);
  const Result<mesh::Mesh> clean = mesh::assemble_triangles(given.vertices, given.triangles, mend);
  if (clean) return of_file(*clean, "");
  const std::string where = clean.error().where.empty() ? "" : clean.error().where + ": ";
  mesh.fail(where + clean.error().what, clean.error().remedy);
  return {};
}

}  // namespace

Mesh read_mesh(const Reader& mesh, const Assets* assets) {
  mesh.object(
      {"grid", "panel", "vertices", "triangles", "file", "obj", "node", "mend", "pattern", "pattern_scale"});
  const bool file = names_file(mesh);
  for (const char* key : {"pattern", "pattern_scale", "node", "mend"})
    if (mesh.has(key) && !file) mesh.fail("\"" + std::string(key) + "\" only beside \"file\"");
  if (mesh.has("triangles")) {
    if (mesh.has("grid") || mesh.has("panel") || file)
      mesh.fail("either \"grid\", or \"panel\", or \"file\", or \"vertices\" and \"triangles\"");
    return read_own_mesh(mesh);
  }
  const std::string kind = mesh.exactly_one({"grid", "panel", "vertices", "file", "obj"});
  if (kind == "vertices") return read_own_mesh(mesh);
  if (kind == "panel") return read_panel(mesh.member("panel"));
  return kind == "grid" ? read_grid(mesh.member("grid")) : Mesh(read_named_mesh(mesh, assets));
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
  mesh.object({"vertices", "triangles", "file", "obj", "node", "mend"});
  Body body;
  if (mesh.has("triangles") || mesh.has("vertices")) {
    if (names_file(mesh)) mesh.fail("either \"file\", or \"vertices\" and \"triangles\"");
    if (mesh.has("node")) mesh.fail("\"node\" only beside \"file\"");
    body.mesh = std::make_shared<const TriangleMesh>(read_body_mesh(mesh));
  } else {
    const Reader named = mesh.member(mesh.exactly_one(file_keys));
    if (const SharedMesh file = find_mesh(named, read_reading(mesh), assets, "vertices and triangles"))
      body.mesh = std::make_shared<const TriangleMesh>(of_file(*file, named.string("")));
  }
  body.transform = read_transform(collider.member("transform", json::object()));
  return body;
}

}  // namespace clothlab::scene
