#include "server/lab/measure/map_field.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "server/base/text.h"
#include "server/scene/named_fabric.h"
#include "server/scene/pointer.h"

namespace clothlab::lab {

namespace {

using scene::json;

const char* const stiffness = "stiffness";

/// The value that a JSON Pointer names; null: there is none.
json* find_value(json& document, const std::string& pointer) {
  const auto tokens = scene::split_pointer(pointer);
  if (!tokens || tokens->empty()) return nullptr;
  json* at = &document;
  for (const std::string& token : *tokens)
    if (!(at = scene::child(*at, token))) return nullptr;
  return at;
}

/// Multiplies all numbers of a value, and of an object's members, by `factor`.
void scale(json& value, double factor) {
  if (value.is_number()) value = factor * value.get<double>();
  if (value.is_object())
    for (json& member : value) scale(member, factor);
}

/// Multiplies all stiffnesses of every cloth by `factor`: of springs, or of a sheet.
void scale_stiffness(json& document, double factor) {
  for (json& cloth : document["cloths"])
    for (const char* kind : {"structural", "shear", "bend", "warp", "weft", "bending"})
      if (json* stiffness = scene::child(cloth["material"], kind)) scale(*stiffness, factor);
}

bool any_spring(const scene::Scene& scene) {
  return std::any_of(scene.cloths.begin(), scene.cloths.end(), [](const scene::Cloth& cloth) {
    const auto* springs = std::get_if<scene::Springs>(&cloth.material);
    return !springs || springs->structural > 0 || springs->shear > 0 || springs->bend > 0;
  });
}

/// True if a pointer, /cloths/0/material/..., names something of a cloth of finite elements.
bool is_of_sheet(const scene::Scene& scene, const std::vector<std::string>& tokens) {
  const auto index = tokens.size() > 1 ? scene::array_index(tokens[1], scene.cloths.size()) : std::nullopt;
  return index && std::holds_alternative<scene::Fem>(scene.cloths[*index].material);
}

}  // namespace

Result<MapField> MapField::find(const scene::Document& document, const std::string& field) {
  MapField found(document, field);
  // Only then: what stays left to a fabric follows the field, such as springs the distance of the vertices.
  if (field == stiffness || !find_value(found.document_.value, field))
    found.document_.value = scene::spelled_out(document);
  if (field == stiffness) {
    if (!any_spring(document.scene))
      return Error{"field", "\"stiffness\", but no cloth has a spring", "the JSON Pointer of another number"};
    for (const scene::Key& key : document.scene.keys)
      if (key.of.find("/material/") != std::string::npos && !key.of.ends_with("damping"))
        return Error{"field", "\"stiffness\", which the key of " + key.of + " changes over time",
                     "another number, or the scene without that key"};
    return found;
  }
  for (const scene::Key& key : document.scene.keys)
    if (field == key.of || field.starts_with(key.of + "/"))
      return Error{"field", scene::compact(field) + ", which a key changes over time",
                   "another number, or the scene without that key"};
  const json* value = find_value(found.document_.value, field);
  if (!value)
    return Error{"field", scene::compact(field),
                 "\"stiffness\", or the JSON Pointer of a number of this scene, such as "
                 "\"/cloths/0/mass/per_vertex\""};
  if (!value->is_number())
    return Error{"field", scene::compact(*value) + " at " + field, "the JSON Pointer of a number"};
  if (field == "/solver/dt")
    return Error{"field", "\"/solver/dt\"", "another number: dt is the map's other axis"};
  if (field == "/version")
    return Error{"field", "\"/version\"", "a number that means something to the cloth"};
  found.present_ = value->get<double>();
  // Only whole numbers are allowed if the present value is whole, the scene refuses the values 0.5 above and
  // below and allows one of the values 1 above and below.
  found.whole_ = found.present_ == std::round(found.present_) && !found.allowed(found.present_ + 0.5) &&
                 !found.allowed(found.present_ - 0.5) &&
                 (found.allowed(found.present_ + 1) || found.allowed(found.present_ - 1));
  return found;
}

Result<scene::Document> MapField::with(double& value) const {
  json changed = document_.value;
  if (whole_) value = std::round(value);
  if (field_ == stiffness)
    scale_stiffness(changed, value);
  else
    *find_value(changed, field_) = whole_ ? json(static_cast<std::int64_t>(value)) : json(value);
  return scene::validate(std::move(changed), document_.assets);
}

bool MapField::allowed(double value) const {
  return static_cast<bool>(with(value));
}

double MapField::nearest_allowed(double end) const {
  if (allowed(end)) return end;
  double good = present_, bad = end;
  const bool log = present_ > 0 && end > 0;
  for (int halving = 0; halving < 30; ++halving) {
    const double middle = log ? std::sqrt(good * bad) : 0.5 * (good + bad);
    (allowed(middle) ? good : bad) = middle;
    if (log ? std::abs(std::log(bad / good)) < 1e-3 : std::abs(bad - good) < 1e-3 * std::abs(end - present_))
      break;
  }
  return whole_ ? std::round(good) : good;
}

Result<std::vector<double>> MapField::values(std::optional<double> from, std::optional<double> to,
                                             int columns) const {
  if (columns < 2 || columns > 41) return Error{"columns", std::to_string(columns), "2 to 41"};
  for (const auto& [name, end] : {std::pair("from", from), std::pair("to", to)})
    if (end && !std::isfinite(*end)) return Error{name, "not a finite number", "a number"};
  if (present_ == 0.0 && (!from || !to))
    return Error{from ? "to" : "from", "not given", "a number: the present value is 0 and gives no scale"};
  const double reach = whole_ ? 4.0 : 100.0;
  const double low =
      from ? *from
           : nearest_allowed(present_ > 0 ? std::min(present_, to.value_or(present_)) / reach : 2 * present_);
  const double high = to ? *to : nearest_allowed(present_ > 0 ? std::max(present_, low) * reach : 0.0);
  if (!(low < high))
    return Error{
        to ? "to" : "from", with_significant_digits(to ? high : low, 6),
        to ? "above " + with_significant_digits(low, 6) : "below " + with_significant_digits(high, 6)};
  std::vector<double> values;
  for (int i = 0; i < columns; ++i) {
    const double share = static_cast<double>(i) / (columns - 1);
    double value = low > 0 ? low * std::pow(high / low, share) : low + share * (high - low);
    if (i == columns - 1) value = high;
    const Result<scene::Document> scene = with(value);
    if (!scene) return scene.error();
    if (values.empty() || value > values.back()) values.push_back(value);
  }
  if (values.size() < 2)
    return Error{"to", with_significant_digits(high, 6), "at least one more than from, in whole numbers"};
  return values;
}

std::string MapField::unit() const {
  static const std::map<std::string, std::string> units{
      {"structural", "N/m"},   {"shear", "N/m"},      {"bend", "N/m"},
      {"damping", "N s/m"},    {"per_vertex", "kg"},  {"area_density", "kg/m^2"},
      {"mass", "kg"},          {"width", "m"},        {"height", "m"},
      {"gravity", "m/s^2"},    {"air_drag", "1/s"},   {"thickness", "m"},
      {"radius", "m"},         {"amplitude", "m"},    {"frequency", "Hz"},
      {"velocity", "m/s"},     {"center", "m"},       {"point", "m"},
      {"translate", "m"},      {"rotate", "degrees"}, {"size", "m"},
      {"vertices", "m"},       {"box", "m"},          {"degrees_per_second", "degrees/s"},
      {"gust_frequency", "Hz"}};
  /// Of a sheet's material, where springs have other units or nothing of that name.
  static const std::map<std::string, std::string> of_sheets{
      {"warp", "N/m"}, {"weft", "N/m"}, {"shear", "N/m"}, {"damping", "s"}, {"grain", "degrees"}};
  if (field_ == stiffness) return "times the present";
  const auto tokens = scene::split_pointer(field_);
  const auto has = [&](const char* key) {
    return std::find(tokens->begin(), tokens->end(), key) != tokens->end();
  };
  if (has("bending")) return "N m";
  if (has("material") && is_of_sheet(document_.scene, *tokens)) {
    const auto found = of_sheets.find(tokens->back());
    return found == of_sheets.end() ? "" : found->second;
  }
  // The unit follows from the last key of the pointer that is not an array index.
  for (auto token = tokens->rbegin(); token != tokens->rend(); ++token) {
    if (scene::array_index(*token, 1u << 30)) continue;
    const auto found = units.find(*token);
    return found == units.end() ? "" : found->second;
  }
  return "";
}

}  // namespace clothlab::lab
