#include "server/lab/measure/parts.h"

#include <algorithm>
#include <cmath>

#include "server/lab/measure/coarsen.h"
#include "server/model/model.h"
#include "server/scene/fitted_springs.h"
#include "server/scene/keys.h"
#include "server/scene/sections.h"

namespace clothlab::lab {

namespace {

using scene::Document;
using scene::json;

Error not_there(const char* what) {
  return {"", std::string("the scene has no ") + what, ""};
}

/// Takes the keys out whose pointer begins with `prefix`.
void drop_keys(json& document, const std::string& prefix) {
  json kept = json::array();
  for (json& key : document["keys"])
    if (!key["of"].get<std::string>().starts_with(prefix)) kept.push_back(std::move(key));
  document["keys"] = std::move(kept);
}

std::string material_of(std::size_t cloth) {
  return "/cloths/" + std::to_string(cloth) + "/material/";
}

/// True if keys change numbers of a cloth's material.
bool has_keyed_material(const scene::Scene& scene) {
  return std::any_of(scene.keys.begin(), scene.keys.end(),
                     [](const scene::Key& key) { return key.of.find("/material/") != std::string::npos; });
}

std::size_t elements(const model::Model& model) {
  std::size_t count = 0;
  model.elements.each([&](const auto& batch) { count += batch.size(); });
  return count;
}

bool is_sheet(const scene::Cloth& cloth) {
  return std::holds_alternative<scene::Fem>(cloth.material);
}
bool any_sheet(const scene::Scene& scene) {
  return std::any_of(scene.cloths.begin(), scene.cloths.end(), is_sheet);
}
bool all_sheets(const scene::Scene& scene) {
  return std::all_of(scene.cloths.begin(), scene.cloths.end(), is_sheet);
}

/// `key`: of springs; `key_of_sheet`: of finite elements, or null; `what`: both, in words.
Result<Document> without_elements(const Document& document, const char* key, const char* key_of_sheet,
                                  const char* what) {
  json value = document.value;
  for (std::size_t i = 0; i < value["cloths"].size(); ++i) {
    json& material = value["cloths"][i]["material"];
    const char* const removed = material["model"] == "springs" ? key : key_of_sheet;
    if (!removed) continue;
    material[removed] = 0.0;
    drop_keys(value, material_of(i) + removed);
  }
  Result<Document> without = scene::validate(std::move(value), document.assets);
  if (!without) return without;
  // The cloth may have no such springs in spite of its stiffness: a triangle mesh has no shear springs, and
  // bend springs only across edges. So the elements are counted.
  const Result<model::Model> model = model::build(document.scene), fewer = model::build(without->scene);
  if (!model || !fewer) return model ? fewer.error() : model.error();
  if (elements(*model) == elements(*fewer)) return not_there(what);
  return without;
}

Result<Document> without_bend(const Document& document) {
  return without_elements(document, "bend", "bending",
                          any_sheet(document.scene) ? "bending stiffness" : "bend springs");
}
Result<Document> without_shear(const Document& document) {
  return without_elements(document, "shear", nullptr, "shear springs");
}

Result<Document> without_self_collision(const Document& document) {
  if (!document.scene.self_collision) return not_there("self-collision");
  json value = document.value;
  value["self_collision"] = nullptr;
  drop_keys(value, "/self_collision/");
  return scene::validate(std::move(value), document.assets);
}

/// Vertices that keep apart instead of triangles and edges, at the same distance.
Result<Document> points_instead(const Document& document) {
  if (!document.scene.collides(scene::ContactKind::surface)) return not_there("contact between surfaces");
  json value = document.value;
  value["self_collision"]["kind"] = "points";
  return scene::validate(std::move(value), document.assets);
}

Result<Document> without_wind(const Document& document) {
  if (!document.scene.wind) return not_there("wind");
  json value = document.value;
  value["wind"] = nullptr;
  drop_keys(value, "/wind/");
  return scene::validate(std::move(value), document.assets);
}

Result<Document> undamped(const Document& document) {
  const scene::Scene most = scene::at_largest(document.scene);
  if (std::none_of(most.cloths.begin(), most.cloths.end(),
                   [](const scene::Cloth& cloth) { return cloth.damping() > 0.0; }))
    return not_there("damping");
  json value = document.value;
  for (std::size_t i = 0; i < value["cloths"].size(); ++i) {
    value["cloths"][i]["material"]["damping"] = 0.0;
    drop_keys(value, material_of(i) + "damping");
  }
  return scene::validate(std::move(value), document.assets);
}

/// The mass of a square metre of the sheet [kg/m^2]; weights not counted.
double area_density(const scene::Cloth& cloth) {
  if (cloth.mass.kind == scene::Mass::Kind::area_density) return cloth.mass.value;
  const double scale = cloth.transform.scale;
  return cloth.mass.value * static_cast<double>(scene::vertex_count(cloth.mesh)) /
         (scene::area(cloth.mesh) * scale * scale);
}

json fitted_springs(const scene::Cloth& cloth) {
  const double spacing = cloth.transform.scale * scene::grid_spacing(cloth.mesh);
  const scene::Springs springs =
      scene::springs_like(std::get<scene::Fem>(cloth.material), spacing, area_density(cloth));
  json material{{"model", "springs"},
                {"structural", springs.structural},
                {"shear", springs.shear},
                {"bend", springs.bend},
                {"damping", springs.damping}};
  if (springs.strain_limit) material["strain_limit"] = *springs.strain_limit;
  return material;
}

/// Every cloth of finite elements as springs that are fitted to it (scene/fitted_springs.h).
Result<Document> springs_instead(const Document& document) {
  if (!any_sheet(document.scene)) return not_there("finite elements");
  if (has_keyed_material(document.scene)) return not_there("material that stays the same: keys change it");
  json value = document.value;
  for (std::size_t i = 0; i < document.scene.cloths.size(); ++i) {
    const scene::Cloth& cloth = document.scene.cloths[i];
    if (!is_sheet(cloth)) continue;
    value["cloths"][i]["material"] = fitted_springs(cloth);
    // Springs have no fabric that a document could leave the mass to.
    const bool by_area = cloth.mass.kind == scene::Mass::Kind::area_density;
    value["cloths"][i]["mass"] = {{by_area ? "area_density" : "per_vertex", cloth.mass.value}};
  }
  return scene::validate(std::move(value), document.assets);
}

/// Every sheet with one modulus and one bending stiffness for warp and weft, the (geometric) means, and with
/// the Poisson's ratio that keeps the coupling of both. What the sheet resists when its threads slant stays:
/// that of woven cloth is some twentieth of what an isotropic sheet has, and nobody would call it a detail.
Result<Document> alike_along_both(const Document& document) {
  if (has_keyed_material(document.scene)) return not_there("material that stays the same: keys change it");
  json value = document.value;
  bool differs = false;
  for (std::size_t i = 0; i < document.scene.cloths.size(); ++i) {
    const auto* sheet = std::get_if<scene::Fem>(&document.scene.cloths[i].material);
    if (!sheet) continue;
    const scene::Fem::Bending& bending = sheet->bending;
    differs = differs || sheet->warp != sheet->weft || bending.warp != bending.weft;
    json& material = value["cloths"][i]["material"];
    material["warp"] = material["weft"] = std::sqrt(sheet->warp * sheet->weft);
    material["poisson"] = sheet->poisson * std::sqrt(sheet->weft / sheet->warp);
    const double mean = std::sqrt(bending.warp * bending.weft);
    material["bending"] = {{"warp", mean}, {"weft", mean}};
    if (bending.twist) material["bending"]["twist"] = *bending.twist;
  }
  if (!differs) return not_there("cloth of finite elements whose warp and weft differ");
  return scene::validate(std::move(value), document.assets);
}

Result<Document> half_resolution(const Document& document) {
  return coarsen(document, 2);
}
Result<Document> quarter_resolution(const Document& document) {
  return coarsen(document, 4);
}

}  // namespace

std::vector<Part> parts(const Document& document) {
  const auto left_out = [](const char* name, auto* without, bool own_step = false) {
    return Part{name, PartOf::nothing, 1, "", "", own_step, without};
  };
  const bool sheets = any_sheet(document.scene);
  std::vector<Part> all{left_out(sheets ? "without bending" : "without bend springs", without_bend)};
  if (!all_sheets(document.scene)) all.push_back(left_out("without shear springs", without_shear));
  if (sheets) {
    all.push_back({"with warp and weft alike", PartOf::model, 1, "Isotropic suffices",
                   "Isotropic does not suffice", true, alike_along_both});
    all.push_back({"with springs instead of finite elements", PartOf::model, 1, "Springs suffice",
                   "Springs do not suffice", true, springs_instead});
  }
  const bool surfaces = document.scene.collides(scene::ContactKind::surface);
  if (surfaces)
    all.push_back({"with points that keep apart instead of surfaces", PartOf::contact, 1, "Points suffice",
                   "Points do not suffice", false, points_instead});
  all.push_back(
      {"without self-collision", PartOf::contact, 1, surfaces ? "Doing without self-collision suffices" : "",
       surfaces ? "Doing without self-collision does not suffice" : "", false, without_self_collision});
  all.push_back(left_out("without wind", without_wind));
  // A sheet's damping grows with its stiffness, and shortens the steps of explicit methods several times.
  all.push_back(left_out(without_damping, undamped, sheets));
  all.push_back({"half the mesh resolution", PartOf::mesh, 2, "", "", true, half_resolution});
  all.push_back({"a quarter of the mesh resolution", PartOf::mesh, 4, "", "", true, quarter_resolution});
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
