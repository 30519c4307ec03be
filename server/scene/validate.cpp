// Reads the top level of the scene document and checks the rules that span several sections.
#include <algorithm>
#include <set>

#include "server/scene/document.h"
#include "server/scene/method.h"
#include "server/scene/sections.h"
#include "server/scene/suited.h"

namespace clothlab::scene {

namespace {

void require_unique_name(const Reader& named, const std::string& name, std::set<std::string>& taken) {
  if (!taken.insert(name).second) named.member("name").fail("a name that no earlier one has");
}

std::vector<Cloth> read_cloths(const Reader& cloths, const Assets* assets) {
  std::vector<Cloth> result(cloths.array(1, max_cloths));
  std::set<std::string> names;
  std::size_t vertices = 0, triangles = 0;
  for (std::size_t i = 0; i < result.size(); ++i) {
    const Reader cloth = cloths.element(i);
    result[i] = read_cloth(cloth, i, assets);
    require_unique_name(cloth, result[i].name, names);
    vertices += vertex_count(result[i].mesh);
    triangles += triangle_count(result[i].mesh);
    if (vertices > max_vertices || triangles > max_triangles)
      cloth.member("mesh").fail(
          std::to_string(vertices) + " vertices so far",
          "at most " + std::to_string(max_vertices) + " vertices in all cloths together");
  }
  return result;
}

std::vector<Collider> read_colliders(const Reader& colliders, const Assets* assets) {
  std::vector<Collider> result(colliders.array(0, max_colliders));
  std::set<std::string> names;
  std::size_t vertices = 0, triangles = 0;
  for (std::size_t i = 0; i < result.size(); ++i) {
    const Reader collider = colliders.element(i);
    result[i] = read_collider(collider, i, assets);
    require_unique_name(collider, result[i].name, names);
    const auto* body = std::get_if<Body>(&result[i].shape);
    if (!body) continue;
    vertices += body->mesh->vertices.size();
    triangles += body->mesh->triangles.size();
    if (vertices > max_body_vertices || triangles > max_body_triangles)
      collider.member("mesh").fail(
          std::to_string(vertices) + " vertices and " + std::to_string(triangles) + " triangles so far",
          "at most " + std::to_string(max_body_triangles) +
              " of each in all colliders together: a coarser mesh");
  }
  return result;
}

std::optional<SelfCollision> read_self_collision(const Reader& self_collision) {
  if (self_collision.is_null()) return std::nullopt;
  self_collision.object({"thickness", "friction", "kind"});
  const bool surface = self_collision.member("kind", "points").choice({"points", "surface"}) == "surface";
  return SelfCollision{self_collision.member("thickness", 0.01).number(ranges::thickness),
                       self_collision.member("friction", 0.2).number(ranges::friction),
                       surface ? ContactKind::surface : ContactKind::points};
}

std::optional<Wind> read_wind(const Reader& wind) {
  if (wind.is_null()) return std::nullopt;
  wind.object({"velocity", "gust", "gust_frequency", "drag", "lift"});
  return Wind{wind.member("velocity").vector(ranges::wind_speed),
              wind.member("gust", Wind{}.gust).number(ranges::gust),
              wind.member("gust_frequency", Wind{}.gust_frequency).number(ranges::frequency),
              wind.member("drag", Wind{}.drag).number(ranges::air_coefficient),
              wind.member("lift", Wind{}.lift).number(ranges::air_coefficient)};
}

Solver read_solver(const Reader& solver) {
  solver.object({"method", "dt", "iterations", "tolerance"});
  Words names;
  for (const Method each : methods) names.push_back(name(each));
  names.push_back(automatic_method);
  const std::string method = solver.member("method", name(Solver{}.method)).choice(names);
  return Solver{method_of(method).value_or(Method::verlet), solver.member("dt", 0.001).number(ranges::dt),
                solver.member("iterations", 10).integer(ranges::iterations),
                solver.member("tolerance", 1e-4).number(ranges::tolerance), method == automatic_method};
}

Scene read_scene(const Reader& top, const Assets* assets) {
  top.object({"version", "name", "gravity", "cloths", "colliders", "self_collision", "wind", "air_drag",
              "solver", "keys"});
  top.member("version").integer({1, 1});
  Scene scene;
  scene.name = top.member("name", "scene").name();
  scene.gravity = top.member("gravity", json{0, -9.8, 0}).vector(ranges::gravity);
  scene.cloths = read_cloths(top.member("cloths"), assets);
  scene.colliders = read_colliders(top.member("colliders", json::array()), assets);
  scene.self_collision = read_self_collision(top.member("self_collision", json(nullptr)));
  scene.wind = read_wind(top.member("wind", json(nullptr)));
  scene.air_drag = top.member("air_drag", 0.0).number(ranges::air_drag);
  scene.solver = read_solver(top.member("solver", json::object()));
  if (const char* reason = unsuited(scene.solver.method, scene))
    top.member("solver").member("method").fail(reason);
  read_keys(top.member("keys", json::array()), scene);
  return scene;
}

}  // namespace

Result<Document> validate(json value, std::shared_ptr<const Assets> assets) {
  std::optional<Error> error;
  Document document{std::move(value), {}, std::move(assets)};
  document.scene = read_scene(Reader(&document.value, "", error), document.assets.get());
  if (error) return *error;
  return document;
}

}  // namespace clothlab::scene
