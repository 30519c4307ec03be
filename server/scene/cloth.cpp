#include <algorithm>
#include <cmath>

#include "server/base/text.h"
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

std::string default_name(const char* kind, std::size_t index) {
  std::string name = kind;
  if (index > 0) name.append("-").append(std::to_string(index + 1));
  return name;
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

TriangleMesh read_triangle_mesh(const Reader& mesh) {
  TriangleMesh result;
  const Reader vertices = mesh.member("vertices"), triangles = mesh.member("triangles");
  result.vertices.resize(vertices.array(3, max_vertices));
  for (std::size_t i = 0; i < result.vertices.size(); ++i)
    result.vertices[i] = vertices.element(i).vector(ranges::position);
  result.triangles.resize(triangles.array(1, max_triangles));
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

/// A mesh that `assets` has: a file, or one that was uploaded.
TriangleMesh read_named_mesh(const Reader& mesh, const Assets* assets) {
  TriangleMesh result;
  const Reader obj = mesh.member("obj"), pattern = mesh.member("pattern", json(nullptr));
  const std::string name = obj.string("the name of a mesh: an .obj or .ply file, or one of mesh.upload");
  if (!obj.is_string()) return result;
  const Result<SharedMesh> found =
      assets ? assets->mesh(name)
             : Error{name, "there are no meshes to name here", "a grid, or vertices and triangles"};
  if (!found) {
    obj.fail(found.error().where + ": " + found.error().what, found.error().remedy);
    return result;
  }
  result.vertices = (*found)->vertices;
  result.triangles = (*found)->triangles;
  result.vertex_of = (*found)->vertex_of;
  if (!pattern.is_null()) read_pattern(pattern, name, **found, result);
  return result;
}

Mesh read_mesh(const Reader& mesh, const Assets* assets) {
  mesh.object({"grid", "vertices", "triangles", "obj", "pattern"});
  if (mesh.has("pattern") && !mesh.has("obj")) mesh.fail("\"pattern\" only beside \"obj\"");
  if (mesh.has("triangles")) {
    if (mesh.has("grid") || mesh.has("obj"))
      mesh.fail("either \"grid\", or \"obj\", or \"vertices\" and \"triangles\"");
    return read_triangle_mesh(mesh);
  }
  const std::string kind = mesh.exactly_one({"grid", "vertices", "obj"});
  if (kind == "vertices") return read_triangle_mesh(mesh);
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

Mass read_mass(const Reader& mass) {
  mass.object({"per_vertex", "area_density"});
  const std::string kind = mass.exactly_one({"per_vertex", "area_density"});
  if (kind == "area_density")
    return Mass{Mass::Kind::area_density, mass.member(kind).number(ranges::area_density)};
  return Mass{Mass::Kind::per_vertex, mass.member("per_vertex").number(ranges::mass_per_vertex)};
}

/// A member that may be null, which is its default.
std::optional<double> read_optional(const Reader& object, const std::string& key, const Range& range) {
  const Reader member = object.member(key, json(nullptr));
  return member.is_null() ? std::nullopt : std::optional(member.number(range));
}

Springs read_springs(const Reader& material) {
  material.object({"model", "structural", "shear", "bend", "damping", "strain_limit"}, {"fabric"});
  return Springs{material.member("structural", 20000).number(ranges::stiffness),
                 material.member("shear", 10000).number(ranges::stiffness),
                 material.member("bend", 2000).number(ranges::stiffness),
                 material.member("damping", 2.0).number(ranges::damping),
                 read_optional(material, "strain_limit", ranges::strain_limit)};
}

/// Of a sheet that bends alike in all directions, or one number for each.
Fem::Bending read_bending(const Reader& bending) {
  if (!bending.is_object()) {
    const double alike = bending.number(ranges::bending);
    return {alike, alike, std::nullopt};
  }
  bending.object({"warp", "weft", "twist"});
  return {bending.member("warp").number(ranges::bending), bending.member("weft").number(ranges::bending),
          read_optional(bending, "twist", ranges::bending)};
}

/// One number for both directions, or one for each.
std::optional<StrainLimit> read_strain_limit(const Reader& material) {
  const Reader limit = material.member("strain_limit", json(nullptr));
  if (limit.is_null()) return std::nullopt;
  if (!limit.is_object()) return StrainLimit(limit.number(ranges::strain_limit));
  limit.object({"warp", "weft"});
  return StrainLimit(limit.member("warp").number(ranges::strain_limit),
                     limit.member("weft").number(ranges::strain_limit));
}

Fem read_fem(const Reader& material) {
  material.object(
      {"model", "warp", "weft", "poisson", "shear", "bending", "damping", "grain", "strain_limit"},
      {"fabric"});
  const Fem standard;
  Fem fem;
  fem.warp = material.member("warp", standard.warp).number(ranges::modulus);
  fem.weft = material.member("weft", standard.weft).number(ranges::modulus);
  const Reader poisson = material.member("poisson", standard.poisson);
  fem.poisson = poisson.number(ranges::poisson);
  if (!(fem.poisson * fem.poisson < fem.warp / fem.weft))
    poisson.fail("below " + with_significant_digits(std::sqrt(fem.warp / fem.weft), 3) +
                 ", the square root of warp / weft (or the sheet would gain energy by being stretched)");
  fem.shear = material.member("shear", standard.shear).number(ranges::shear_modulus);
  fem.bending = read_bending(
      material.member("bending", json{{"warp", standard.bending.warp}, {"weft", standard.bending.weft}}));
  fem.damping = material.member("damping", standard.damping).number(ranges::damping_time);
  fem.grain = material.member("grain", standard.grain).number(ranges::angle);
  fem.strain_limit = read_strain_limit(material);
  return fem;
}

Material read_material(const Reader& material) {
  if (!material.is_object()) return read_springs(material);
  const std::string model = material.member("model", "springs").choice({"springs", "fem"});
  if (model == "fem") return read_fem(material);
  return read_springs(material);
}

std::vector<Pin> read_pins(const Reader& pins, const Mesh& mesh) {
  std::vector<Pin> result(pins.array(0, max_pins));
  for (std::size_t i = 0; i < result.size(); ++i) {
    const Reader pin = pins.element(i);
    pin.object({"at", "motion"});
    result[i] = Pin{read_at(pin.member("at"), mesh), read_motion(pin.member("motion", json(nullptr)))};
  }
  return result;
}

std::vector<Weight> read_weights(const Reader& weights, const Mesh& mesh) {
  std::vector<Weight> result(weights.array(0, max_weights));
  for (std::size_t i = 0; i < result.size(); ++i) {
    const Reader weight = weights.element(i);
    weight.object({"at", "mass"});
    result[i] = Weight{read_at(weight.member("at"), mesh), weight.member("mass").number(ranges::weight)};
  }
  return result;
}

Start read_start(const Reader& start) {
  if (start.is_null()) return std::monostate{};
  const Words kinds = {"scatter", "scale"};
  start.object(kinds);
  if (start.exactly_one(kinds) == "scale") return Stretch{start.member("scale").vector(ranges::start_scale)};
  const Reader scatter = start.member("scatter");
  scatter.object({"size", "seed"});
  return Scatter{scatter.member("size").number(ranges::length),
                 static_cast<std::uint32_t>(scatter.member("seed", 1).integer(ranges::seed))};
}

std::string read_color(const Reader& color) {
  const std::string allowed = "a color as #rrggbb in hexadecimal digits";
  const std::string text = color.string(allowed);
  const bool digits = std::all_of(text.begin() + (text.empty() ? 0 : 1), text.end(), [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f') || (c >= 'A' && c <= 'F');
  });
  if (text.size() != 7 || text[0] != '#' || !digits) color.fail(allowed);
  return text;
}

}  // namespace

Cloth read_cloth(const Reader& cloth, std::size_t index, const Assets* assets) {
  cloth.object(
      {"name", "mesh", "transform", "mass", "material", "pins", "weights", "start", "color", "texture"});
  Cloth result;
  result.name = cloth.member("name", default_name("cloth", index)).name();
  result.mesh = read_mesh(cloth.member("mesh"), assets);
  result.transform = read_transform(cloth.member("transform", json::object()));
  result.mass = read_mass(cloth.member("mass", json{{"per_vertex", 0.1}}));
  result.material = read_material(cloth.member("material", json::object()));
  result.pins = read_pins(cloth.member("pins", json::array()), result.mesh);
  result.weights = read_weights(cloth.member("weights", json::array()), result.mesh);
  result.start = read_start(cloth.member("start", json(nullptr)));
  result.color = read_color(cloth.member("color", "#b03a2e"));
  result.texture = cloth.member("texture", "weave").choice({"weave", "checker", "stripes", "plain"});
  return result;
}

}  // namespace clothlab::scene
