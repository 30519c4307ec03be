#include "server/scene/named_fabric.h"

#include <algorithm>

#include "server/scene/pointer.h"

namespace clothlab::scene {

namespace {

json numbers(const Springs& springs) {
  return {{"structural", springs.structural},
          {"shear", springs.shear},
          {"bend", springs.bend},
          {"damping", springs.damping}};
}

json numbers(const Fem& sheet) {
  const auto& [warp, weft, twist] = sheet.bending;
  return {{"warp", sheet.warp},
          {"weft", sheet.weft},
          {"poisson", sheet.poisson},
          {"shear", sheet.shear},
          {"damping", sheet.damping},
          {"bending", {{"warp", warp}, {"weft", weft}, {"twist", twist ? json(*twist) : json()}}}};
}

const json* material_of(const json& cloth) {
  return cloth.is_object() && cloth.contains("material") && cloth["material"].is_object() ? &cloth["material"]
                                                                                          : nullptr;
}

/// A list member of an object, or null.
template <class Json>
Json* list(Json& value, const char* key) {
  if (!value.is_object() || !value.contains(key) || !value[key].is_array()) return nullptr;
  return &value[key];
}

/// Takes the members out of `after` that are as they were in `before` and as in `standard`.
void take_out(const json& before, json& after, const json& standard) {
  for (const auto& [key, value] : standard.items())
    if (after.contains(key) && before.contains(key) && after[key] == value && before[key] == value)
      after.erase(key);
}

}  // namespace

json left_to_fabrics(const Document& document) {
  json all = json::array();
  for (std::size_t i = 0; i < document.scene.cloths.size(); ++i) {
    const Cloth& cloth = document.scene.cloths[i];
    const json& value = document.value["cloths"][i];
    const json& material = value["material"];
    if (!material.contains("fabric")) {
      all.push_back(nullptr);
      continue;
    }
    json left = {{"material", json::object()}};
    const json whole = std::visit([](const auto& of) { return numbers(of); }, cloth.material);
    for (const auto& [key, number] : whole.items())
      if (!material.contains(key)) left["material"][key] = number;
    if (!value.contains("mass")) left["mass"] = {{"area_density", cloth.mass.value}};
    all.push_back(std::move(left));
  }
  return all;
}

json spelled_out(const Document& document) {
  json value = document.value;
  const json left = left_to_fabrics(document);
  for (std::size_t i = 0; i < left.size(); ++i)
    if (!left[i].is_null()) value["cloths"][i].merge_patch(left[i]);
  return value;
}

void give_way_to_fabrics(const json& before, json& after) {
  const json* had = list(before, "cloths");
  json* has = list(after, "cloths");
  if (!had || !has) return;
  for (std::size_t i = 0; i < std::min(had->size(), has->size()); ++i) {
    const json& old = (*had)[i];
    json& cloth = (*has)[i];
    const json *from = material_of(old), *to = material_of(cloth);
    if (!from || !to || from->contains("fabric") || !to->contains("fabric")) continue;
    take_out(*from, cloth["material"], numbers(Springs{}));
    take_out(*from, cloth["material"], numbers(Fem{}));
    take_out(old, cloth, {{"mass", {{"per_vertex", Mass{}.value}}}});
  }
}

}  // namespace clothlab::scene
