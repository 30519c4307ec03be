#include "server/lab/measure/parts.h"

#include <algorithm>

#include "server/lab/measure/coarsen.h"
#include "server/model/model.h"

namespace clothlab::lab {

namespace {

using scene::Document;
using scene::json;

Error not_there(const char* what) {
  return {"", std::string("the scene has no ") + what, ""};
}

std::size_t elements(const model::Model& model) {
  std::size_t count = 0;
  model.elements.each([&](const auto& batch) { count += batch.size(); });
  return count;
}

/// `key`: of springs; `key_of_sheet`: of finite elements, or null.
Result<Document> without_elements(const Document& document, const char* key, const char* key_of_sheet) {
  json value = document.value;
  for (json& cloth : value["cloths"]) {
    const bool springs = cloth["material"]["model"] == "springs";
    if (const char* removed = springs ? key : key_of_sheet) cloth["material"][removed] = 0.0;
  }
  Result<Document> without = scene::validate(std::move(value), document.assets);
  if (!without) return without;
  // The cloth may have no such springs in spite of its stiffness: a triangle mesh has no shear springs, and
  // bend springs only across edges. So the elements are counted.
  const Result<model::Model> model = model::build(document.scene), fewer = model::build(without->scene);
  if (!model || !fewer) return model ? fewer.error() : model.error();
  if (elements(*model) == elements(*fewer)) return not_there((std::string(key) + " springs").c_str());
  return without;
}

Result<Document> without_bend(const Document& document) {
  return without_elements(document, "bend", "bending");
}
Result<Document> without_shear(const Document& document) {
  return without_elements(document, "shear", nullptr);
}

Result<Document> without_self_collision(const Document& document) {
  if (!document.scene.self_collision) return not_there("self-collision");
  json value = document.value;
  value["self_collision"] = nullptr;
  return scene::validate(std::move(value), document.assets);
}

Result<Document> without_wind(const Document& document) {
  if (!document.scene.wind) return not_there("wind");
  json value = document.value;
  value["wind"] = nullptr;
  return scene::validate(std::move(value), document.assets);
}

Result<Document> undamped(const Document& document) {
  if (std::none_of(document.scene.cloths.begin(), document.scene.cloths.end(),
                   [](const scene::Cloth& cloth) { return cloth.damping() > 0.0; }))
    return not_there("damping");
  json value = document.value;
  for (json& cloth : value["cloths"]) cloth["material"]["damping"] = 0.0;
  return scene::validate(std::move(value), document.assets);
}

Result<Document> half_resolution(const Document& document) {
  return coarsen(document, 2);
}
Result<Document> quarter_resolution(const Document& document) {
  return coarsen(document, 4);
}

}  // namespace

const std::vector<Part>& parts() {
  static const std::vector<Part> all{{"without bend springs", 1, without_bend},
                                     {"without shear springs", 1, without_shear},
                                     {"without self-collision", 1, without_self_collision},
                                     {"without wind", 1, without_wind},
                                     {without_damping, 1, undamped},
                                     {"half the mesh resolution", 2, half_resolution},
                                     {"a quarter of the mesh resolution", 4, quarter_resolution}};
  return all;
}

json merge_patch(const json& from, const json& to) {
  json patch = json::object();
  for (const auto& [key, value] : to.items()) {
    if (!from.contains(key))
      patch[key] = value;
    else if (from[key] != value)
      patch[key] = from[key].is_object() && value.is_object() ? merge_patch(from[key], value) : value;
  }
  for (const auto& [key, value] : from.items())
    if (!to.contains(key)) patch[key] = nullptr;
  return patch;
}

}  // namespace clothlab::lab
