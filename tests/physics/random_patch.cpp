#include "tests/physics/random_patch.h"

#include <algorithm>
#include <cmath>

#include "server/scene/method.h"
#include "server/scene/pointer.h"

namespace clothlab::test {

namespace ranges = scene::ranges;
using scene::json;

double RandomPatch::spread(double least, double most) {
  return std::clamp(std::exp(uniform(std::log(least), std::log(most))), least, most);
}

double RandomPatch::usual(double least, double most, const scene::Range& range) {
  if (chance(0.03)) return chance(0.5) ? range.minimum : range.maximum;
  if (chance(0.07)) return spread(std::max(range.minimum, 1e-12), range.maximum);
  return spread(least, most);
}

double RandomPatch::signed_usual(double least, double most, const scene::Range& range) {
  if (chance(0.2)) return 0.0;
  const double size = std::abs(usual(least, most, range));
  return chance(0.5) ? size : std::max(-size, range.minimum);
}

std::string RandomPatch::fresh_name() {
  return std::string("n").append(std::to_string(++names_));
}

json RandomPatch::vector(double least, double most, const scene::Range& range) {
  return json::array(
      {signed_usual(least, most, range), signed_usual(least, most, range), signed_usual(least, most, range)});
}

json RandomPatch::direction() {
  json axis = vector(0.1, 1.0, ranges::direction);
  axis[static_cast<std::size_t>(whole(0, 2))] = 1.0;
  return axis;
}

json RandomPatch::grid() {
  return {{"grid",
           {{"columns", whole(2, 9)},
            {"rows", whole(2, 9)},
            {"width", usual(0.1, 3.0, ranges::length)},
            {"height", usual(0.1, 3.0, ranges::length)}}}};
}

/// Corners on a coarse lattice, so that vertices coincide, triangles have no area and edges belong to many
/// triangles.
json RandomPatch::triangle_mesh() {
  const int count = whole(3, 12);
  json vertices = json::array(), triangles = json::array();
  const double size = usual(0.1, 1.0, {1e-6, 1e5});
  for (int i = 0; i < count; ++i)
    vertices.push_back(json::array({size * whole(-3, 3), size * whole(-1, 1), size * whole(-3, 3)}));
  for (int i = whole(1, 2 * count); i > 0; --i) {
    std::vector<int> corners(static_cast<std::size_t>(count));
    for (int corner = 0; corner < count; ++corner) corners[static_cast<std::size_t>(corner)] = corner;
    std::shuffle(corners.begin(), corners.end(), random_);
    triangles.push_back(json::array({corners[0], corners[1], corners[2]}));
  }
  return {{"vertices", vertices}, {"triangles", triangles}};
}

json RandomPatch::at(const json& mesh) {
  const auto text = [](const char* form, int a) { return json(std::string(form).append(std::to_string(a))); };
  if (chance(0.1))
    return {{"box", json::array({json::array({-1e6, -1e6, -1e6}), json::array({1e6, 1e6, 1e6})})}};
  if (!mesh.contains("grid")) return text("vertex:", whole(0, static_cast<int>(mesh["vertices"].size()) - 1));
  const int columns = mesh["grid"]["columns"], rows = mesh["grid"]["rows"];
  switch (whole(0, 3)) {
    case 0:
      return text("vertex:", whole(0, columns * rows - 1));
    case 1:
      return text("edge:row:", whole(0, rows - 1));
    case 2:
      return text("edge:column:", whole(0, columns - 1));
    default: {
      const std::string column = "corner:" + std::to_string(whole(0, columns - 1));
      return text((column + ",").c_str(), whole(0, rows - 1));
    }
  }
}

json RandomPatch::motion() {
  switch (whole(0, 4)) {
    case 0:
      return {{"oscillate",
               {{"axis", direction()},
                {"amplitude", signed_usual(0.01, 0.5, ranges::amplitude)},
                {"frequency", usual(0.1, 5.0, ranges::frequency)}}}};
    case 1:
      return {{"linear", {{"velocity", vector(0.1, 5.0, ranges::velocity)}}}};
    case 2:
      return {{"spin",
               {{"axis", direction()},
                {"center", vector(0.1, 2.0, ranges::position)},
                {"degrees_per_second", signed_usual(1.0, 360.0, ranges::angular_speed)}}}};
    default:
      return nullptr;
  }
}

json RandomPatch::pins(const json& mesh) {
  json list = json::array();
  for (int i = whole(0, 3); i > 0; --i) {
    list.push_back({{"at", at(mesh)}, {"motion", motion()}});
    const json& held = list.back()["at"];
    const bool one = held.is_string() && held.get<std::string>().rfind("edge", 0) != 0;
    if (one && chance(0.3))
      list.back()["place"] = json::array({uniform(-1.0, 1.0), uniform(-1.0, 1.0), uniform(-1.0, 1.0)});
  }
  return list;
}

json RandomPatch::weights(const json& mesh) {
  json list = json::array();
  for (int i = whole(0, 2); i > 0; --i)
    list.push_back({{"at", at(mesh)}, {"mass", usual(1e-3, 10.0, ranges::weight)}});
  return list;
}

json RandomPatch::material() {
  const auto stiffness = [this] { return chance(0.15) ? 0.0 : usual(1.0, 1e5, ranges::stiffness); };
  return {{"structural", stiffness()},
          {"shear", stiffness()},
          {"bend", stiffness()},
          {"damping", chance(0.2) ? 0.0 : usual(1e-3, 10.0, ranges::damping)},
          {"strain_limit", chance(0.3) ? json(usual(0.01, 0.5, ranges::strain_limit)) : json(nullptr)}};
}

json RandomPatch::mass() {
  if (chance(0.3)) return {{"area_density", usual(0.05, 1.0, ranges::area_density)}, {"per_vertex", nullptr}};
  return {{"per_vertex", usual(1e-4, 1.0, ranges::mass_per_vertex)}, {"area_density", nullptr}};
}

json RandomPatch::transform() {
  return {{"translate", vector(0.1, 3.0, ranges::position)},
          {"rotate", vector(1.0, 180.0, ranges::angle)},
          {"scale", usual(0.5, 2.0, ranges::scale)}};
}

json RandomPatch::start() {
  switch (whole(0, 3)) {
    case 0:
      return {{"scatter", {{"size", usual(0.1, 2.0, ranges::length)}, {"seed", whole(0, 1000)}}},
              {"scale", nullptr}};
    case 1:
      return {{"scale", vector(0.1, 2.0, ranges::start_scale)}, {"scatter", nullptr}};
    default:
      return nullptr;
  }
}

json RandomPatch::cloth(const std::string& name) {
  const json mesh = chance(0.7) ? grid() : triangle_mesh();
  const json patch = {
      {"name", name},           {"mesh", mesh},       {"transform", transform()}, {"mass", mass()},
      {"material", material()}, {"pins", pins(mesh)}, {"weights", weights(mesh)}, {"start", start()}};
  json whole = json::object();
  whole.merge_patch(patch);  // a missing key gets its default
  return whole;
}

json RandomPatch::collider(const std::string& name) {
  json made = {{"name", name},
               {"friction", usual(0.1, 1.0, ranges::friction)},
               {"restitution", uniform(0.0, 1.0)},
               {"motion", motion()}};
  const auto place = [this] { return vector(0.1, 2.0, ranges::position); };
  const auto length = [this] { return usual(0.05, 1.0, ranges::length); };
  switch (whole(0, 4)) {
    case 0:
      made["plane"] = {{"point", place()}, {"normal", direction()}};
      break;
    case 1:
      made["sphere"] = {{"center", place()}, {"radius", length()}};
      break;
    case 2:
      made["capsule"] = {{"a", place()}, {"b", place()}, {"radius", length()}};
      break;
    case 3:
      made["mesh"] = {{"vertices", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}},
                      {"triangles", {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}}};
      made["transform"] = transform();
      break;
    default:
      made["box"] = {{"center", place()},
                     {"half", json::array({length(), length(), length()})},
                     {"rotate", vector(1.0, 180.0, ranges::angle)}};
  }
  return made;
}

json RandomPatch::change_cloth(const json& cloth) {
  switch (whole(0, 7)) {
    case 0: {  // what refers to a place of the old mesh is removed with it
      json mesh = chance(0.7) ? grid() : triangle_mesh();
      json changed = {{"pins", pins(mesh)}, {"weights", weights(mesh)}};
      for (const auto& old : cloth["mesh"].items())
        if (!mesh.contains(old.key())) mesh[old.key()] = nullptr;
      changed["mesh"] = mesh;
      return changed;
    }
    case 1:
      return {{"material", material()}};
    case 2:
      return {{"mass", mass()}};
    case 3:
      return {{"pins", pins(cloth["mesh"])}};
    case 4:
      return {{"weights", weights(cloth["mesh"])}};
    case 5:
      return {{"transform", transform()}};
    case 6:
      return {{"start", start()}};
    default:
      return {{"color", "#00ff7f"}, {"texture", chance(0.5) ? "plain" : "checker"}, {"name", fresh_name()}};
  }
}

/// A merge patch replaces whole arrays.
json RandomPatch::change_cloths(const json& document) {
  json cloths = document["cloths"];
  if (cloths.size() < 3 && chance(0.1)) {
    cloths.push_back(cloth(fresh_name()));
  } else if (cloths.size() > 1 && chance(0.2)) {
    cloths.erase(static_cast<std::size_t>(whole(0, static_cast<int>(cloths.size()) - 1)));
  } else {
    json& chosen = cloths[static_cast<std::size_t>(whole(0, static_cast<int>(cloths.size()) - 1))];
    chosen.merge_patch(change_cloth(chosen));
  }
  return {{"cloths", cloths}};
}

json RandomPatch::change_colliders(const json& document) {
  json colliders = document["colliders"];
  if (!colliders.empty() && chance(0.4))
    colliders.erase(static_cast<std::size_t>(whole(0, static_cast<int>(colliders.size()) - 1)));
  if (colliders.size() < 4 && chance(0.7)) colliders.push_back(collider(fresh_name()));
  if (!colliders.empty() && chance(0.3)) colliders[0]["motion"] = motion();
  return {{"colliders", colliders}};
}

json RandomPatch::change_solver() {
  json solver = json::object();
  if (chance(0.6)) {
    const int method = whole(0, static_cast<int>(scene::methods.size()));
    solver["method"] = method == static_cast<int>(scene::methods.size())
                           ? scene::automatic_method
                           : scene::name(scene::methods[static_cast<std::size_t>(method)]);
  }
  if (chance(0.6)) solver["dt"] = usual(1e-4, 0.03, ranges::dt);
  if (chance(0.4)) solver["iterations"] = whole(1, 20);
  if (chance(0.3)) solver["tolerance"] = usual(1e-6, 1e-2, ranges::tolerance);
  return {{"solver", solver}};
}

json RandomPatch::change_self_collision() {
  if (chance(0.4)) return {{"self_collision", nullptr}};
  return {{"self_collision",
           {{"thickness", usual(0.005, 0.1, ranges::thickness)},
            {"friction", usual(0.1, 1.0, ranges::friction)}}}};
}

json RandomPatch::change_wind() {
  if (chance(0.4)) return {{"wind", nullptr}};
  return {{"wind",
           {{"velocity", vector(0.1, 20.0, ranges::wind_speed)},
            {"gust", usual(0.01, 1.0, ranges::gust)},
            {"gust_frequency", usual(0.01, 5.0, ranges::frequency)},
            {"drag", usual(0.1, 2.0, ranges::air_coefficient)},
            {"lift", usual(0.1, 2.0, ranges::air_coefficient)}}}};
}

/// One operation of RFC 6902 for each key of a merge patch, which holds whole values.
json RandomPatch::as_operations(const json& document, const json& patch) {
  json merged = document, operations = json::array();
  merged.merge_patch(patch);
  for (const auto& item : patch.items()) {
    const std::string path = std::string("/").append(scene::escape_token(item.key()));
    if (merged.contains(item.key()))
      operations.push_back(
          {{"op", chance(0.5) ? "add" : "replace"}, {"path", path}, {"value", merged[item.key()]}});
    else
      operations.push_back({{"op", "remove"}, {"path", path}});
  }
  return operations;
}

json RandomPatch::first_scene() {
  return {{"version", 1}, {"cloths", json::array({cloth("first")})}, {"solver", change_solver()["solver"]}};
}

json RandomPatch::next(const scene::Document& document) {
  json patch;
  switch (whole(0, 10)) {
    case 0:
      patch = {{"gravity", vector(0.1, 20.0, ranges::gravity)}};
      break;
    case 1:
      patch = {{"air_drag", usual(0.01, 5.0, ranges::air_drag)}};
      break;
    case 2:
      patch = change_self_collision();
      break;
    case 3:
      patch = change_colliders(document.value);
      break;
    case 4:
      patch = change_wind();
      break;
    case 5:
    case 6:
      patch = change_solver();
      break;
    default:
      patch = change_cloths(document.value);
  }
  return chance(0.5) ? patch : as_operations(document.value, patch);
}

}  // namespace clothlab::test
