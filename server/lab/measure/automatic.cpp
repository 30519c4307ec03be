#include "server/lab/measure/automatic.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "server/model/element_operator.h"
#include "server/model/remedy.h"
#include "server/model/stability.h"

namespace clothlab::lab {

namespace {

constexpr double provisional_share_of_limit = 0.8;

/// Keys of a scene document that do not affect the motion, so that their values may differ.
constexpr std::array keys_without_effect{"name", "color", "texture"};

bool alike(const json& a, const json& b) {
  if (a.is_number() && b.is_number()) {
    const double x = a.get<double>(), y = b.get<double>();
    return std::abs(x - y) <= covered_difference * std::max(std::abs(x), std::abs(y));
  }
  if (a.type() != b.type() || a.size() != b.size()) return false;
  if (a.is_array()) return std::equal(a.begin(), a.end(), b.begin(), alike);
  if (!a.is_object()) return a == b;
  for (const auto& [key, value] : a.items()) {
    if (std::find(keys_without_effect.begin(), keys_without_effect.end(), key) != keys_without_effect.end())
      continue;
    if (!b.contains(key) || !alike(value, b[key])) return false;
  }
  return true;
}

json without_solver(json scene) {
  scene.erase("solver");
  return scene;
}

}  // namespace

Setting provisional(const model::Model& model, const scene::Scene& scene) {
  Setting setting{scene::Method::verlet, scene.solver.dt, 1, 1e-4};
  const double limit = model::dt_limit_bound(setting.method, model, scene);
  if (std::isfinite(limit)) setting.dt = model::rounded_down(provisional_share_of_limit * limit);
  return setting;
}

Result<scene::Document> with_provisional_setting(const scene::Document& document) {
  if (!document.scene.solver.automatic) return document;
  const Result<model::Model> model = model::build(document.scene);
  if (!model) return model.error();
  return scene::apply_patch(document, patch(provisional(*model, document.scene)));
}

bool covers(const json& measured, const json& now) {
  return measured["solver"]["method"] == now["solver"]["method"] &&
         measured["solver"]["tolerance"] == now["solver"]["tolerance"] &&
         alike(without_solver(measured), without_solver(now));
}

}  // namespace clothlab::lab
