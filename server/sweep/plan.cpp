#include "server/sweep/plan.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <set>

#include "server/base/files.h"
#include "server/base/hash.h"
#include "server/base/text.h"
#include "server/lab/scene_hash.h"
#include "server/scene/pointer.h"
#include "server/scene/reader.h"

namespace clothlab::sweep {

namespace fs = std::filesystem;
using scene::Reader;

namespace {

constexpr scene::Range any_time{1e-6, 1e6, "s"}, any_number{-1e12, 1e12};
constexpr std::size_t most_axes = 16, most_places = 64;

/// Numbers from "from" to "to", both included, evenly spaced or in equal ratios.
std::vector<Value> spaced(const Reader& axis) {
  const double from = axis.member("from").number(any_number), to = axis.member("to").number(any_number);
  const auto count =
      static_cast<std::size_t>(axis.member("count").integer({2, static_cast<double>(most_values)}));
  const std::string spacing = axis.member("spacing", "linear").choice({"linear", "log"});
  const std::string round = axis.member("round", "none").choice({"none", "whole"});
  if (spacing == "log" && !(from > 0 && to > 0)) axis.member("from").fail("above 0, as \"to\", for \"log\"");
  std::vector<Value> values;
  for (std::size_t i = 0; i < count && !axis.failed(); ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(count - 1);
    double number = spacing == "log" ? from * std::pow(to / from, share) : from + share * (to - from);
    // Six digits: a table then shows the number that was used.
    number = std::strtod(with_significant_digits(number, 6).c_str(), nullptr);
    const json label = round == "whole" ? json(std::llround(number)) : json(number);
    if (values.empty() || values.back().label != label) values.push_back({label, nullptr});
  }
  return values;
}

std::vector<Value> listed(const Reader& list, json& file) {
  std::vector<Value> values;
  const std::size_t count = list.array(1, most_values);
  for (std::size_t i = 0; i < count; ++i) values.push_back({file[i], nullptr});
  return values;
}

std::vector<Value> patches(const Reader& list, json& file) {
  std::vector<Value> values;
  const std::size_t count = list.array(1, most_values);
  for (std::size_t i = 0; i < count && !list.failed(); ++i) {
    const Reader each = list.element(i);
    each.object({"name", "patch"});
    const std::string name = each.member("name").name();
    if (!each.member("patch").is_object()) each.member("patch").fail("a merge patch: an object");
    if (!list.failed()) values.push_back({name, file[i]["patch"]});
  }
  return values;
}

std::vector<std::string> places_of(const Reader& at, json& file) {
  const auto pointer = [](const Reader& one) {
    const std::string text = one.string("a JSON Pointer, e.g. /solver/dt");
    if (!one.failed() && !(scene::split_pointer(text) && !text.empty()))
      one.fail("a JSON Pointer, e.g. /solver/dt");
    return text;
  };
  if (!file.is_array()) return {pointer(at)};
  std::vector<std::string> places;
  const std::size_t count = at.array(1, most_places);
  for (std::size_t i = 0; i < count; ++i) places.push_back(pointer(at.element(i)));
  return places;
}

/// The last token of a pointer, which mostly says what it is.
std::string last_token(const std::string& pointer) {
  return pointer.substr(pointer.rfind('/') + 1);
}

Axis read_axis(const Reader& axis, json& file) {
  axis.object({"name", "at", "values", "patches", "from", "to", "count", "spacing", "round"});
  Axis read;
  if (axis.failed()) return read;
  const std::string kind = axis.exactly_one({"values", "patches", "from"});
  if (axis.failed()) return read;
  if (kind == "patches") {
    if (axis.has("at")) axis.member("at").fail("absent, as patches say what they change");
    read.values = patches(axis.member("patches"), file["patches"]);
  } else {
    const Reader at = axis.member("at");
    if (axis.has("at"))
      read.at = places_of(at, file["at"]);
    else
      at.fail("a JSON Pointer, or a list of them");
    if (!axis.failed())
      read.values = kind == "from" ? spaced(axis) : listed(axis.member("values"), file["values"]);
  }
  if (axis.failed()) return read;
  read.name = axis.member("name", read.at.empty() ? json("setting") : json(last_token(read.at[0]))).name();
  return read;
}

Quantities read_quantities(const Reader& list) {
  Quantities wanted;
  const std::size_t count = list.array(0, 8);
  for (std::size_t i = 0; i < count; ++i) {
    const std::string name = list.element(i).choice({"error", "cost", "crossings", "shape"});
    wanted.error |= name == "error";
    wanted.cost |= name == "cost";
    wanted.crossings |= name == "crossings";
    wanted.shape |= name == "shape";
  }
  return wanted;
}

/// The scene that the file names (a preset, or a file beside it) or contains.
Result<scene::Document> read_scene(const json& value, const fs::path& folder,
                                   const std::shared_ptr<const scene::Assets>& meshes) {
  if (value.is_object()) {
    Result<scene::Document> document = scene::validate(value, meshes);
    if (document) return document;
    Error error = document.error();
    error.where = "/scene" + error.where;
    return error;
  }
  if (!value.is_string()) return Error{"/scene", scene::compact(value), "a preset, a file, or a scene"};
  const auto name = value.get<std::string>();
  if (scene::is_preset(name)) return scene::load_preset(name, meshes);
  return scene::load(fs::path(name).is_absolute() ? name : (folder / name).string(), meshes);
}

/// Writes `value` at `pointer`, whether or not there is a value. False: its parent is missing.
bool write(json& document, const std::string& pointer, const json& value) {
  const std::vector<std::string> tokens = *scene::split_pointer(pointer);
  json* at = &document;
  for (std::size_t i = 0; at && i + 1 < tokens.size(); ++i) at = scene::child(*at, tokens[i]);
  json* place = at ? scene::child(*at, tokens.back()) : nullptr;
  if (!place && at && at->is_object()) place = &(*at)[tokens.back()];
  if (!place) return false;
  *place = value;
  return true;
}

/// Refuses a place that the scene does not have, which would otherwise fail at every point.
Status check_places(const Plan& plan) {
  for (std::size_t a = 0; a < plan.axes.size(); ++a)
    for (std::size_t i = 0; i < plan.axes[a].at.size(); ++i)
      if (json scratch = plan.base.value; !write(scratch, plan.axes[a].at[i], nullptr)) {
        const std::string where = "/axes/" + std::to_string(a) + "/at";
        return Error{plan.axes[a].at.size() > 1 ? where + "/" + std::to_string(i) : where,
                     "\"" + plan.axes[a].at[i] + "\"",
                     "a place that the scene has; `clothlab validate --full S` shows all"};
      }
  return ok();
}

Status check_size(const Plan& plan) {
  double points = 1;
  std::set<std::string> names;
  for (std::size_t a = 0; a < plan.axes.size(); ++a) {
    points *= static_cast<double>(plan.axes[a].values.size());
    if (!names.insert(plan.axes[a].name).second)
      return Error{"/axes/" + std::to_string(a) + "/name", "\"" + plan.axes[a].name + "\"",
                   "another name than the other axes have"};
  }
  if (points > static_cast<double>(most_points))
    return Error{"/axes", with_significant_digits(points, 6) + " points",
                 "at most " + std::to_string(most_points) + "; take fewer values, or several sweeps"};
  return ok();
}

}  // namespace

std::size_t Plan::size() const {
  std::size_t size = 1;
  for (const Axis& axis : axes) size *= axis.values.size();
  return size;
}

std::vector<std::size_t> Plan::places(std::size_t point) const {
  std::vector<std::size_t> places(axes.size());
  for (std::size_t a = axes.size(); a-- > 0;) {
    places[a] = point % axes[a].values.size();
    point /= axes[a].values.size();
  }
  return places;
}

json Plan::labels(std::size_t point) const {
  const std::vector<std::size_t> at = places(point);
  json labels = json::object();
  for (std::size_t a = 0; a < axes.size(); ++a) labels[axes[a].name] = axes[a].values[at[a]].label;
  return labels;
}

Result<scene::Document> Plan::scene(std::size_t point) const {
  const std::vector<std::size_t> at = places(point);
  json value = base.value;
  for (std::size_t a = 0; a < axes.size(); ++a) {
    const Value& chosen = axes[a].values[at[a]];
    if (axes[a].at.empty()) value.merge_patch(chosen.patch);
    for (const std::string& place : axes[a].at)
      if (!write(value, place, chosen.label))
        return Error{place, "no such place in the scene", "values of the other axes that leave it there"};
  }
  // All changes in one patch, as each alone may make no valid scene.
  return scene::apply_patch(base, json::diff(base.value, value));
}

std::string Plan::id(std::size_t point) const {
  const std::vector<std::size_t> at = places(point);
  Hash hash;
  hash.add(common);
  for (std::size_t a = 0; a < axes.size(); ++a) {
    const Value& chosen = axes[a].values[at[a]];
    hash.add(axes[a].at.empty() ? chosen.patch.dump()
                                : json{{"at", axes[a].at}, {"is", chosen.label}}.dump());
  }
  return hash.text();
}

namespace {

std::string common_to_all(const Plan& plan) {
  Hash hash;
  hash.add("points of a sweep, 1");
  lab::add_scene(hash, plan.base);
  hash.add(json{{"error", plan.quantities.error},
                {"cost", plan.quantities.cost},
                {"crossings", plan.quantities.crossings},
                {"shape", plan.quantities.shape},
                {"time", plan.time},
                {"every", plan.every},
                {"budget", plan.budget}}
               .dump());
  return hash.text();
}

/// The axis that writes at `place` or above it, as a pointer into the file.
std::string axis_of(const Plan& plan, const std::string& place) {
  for (std::size_t a = 0; a < plan.axes.size(); ++a)
    for (const std::string& at : plan.axes[a].at)
      if ((place + "/").starts_with(at + "/")) return "/axes/" + std::to_string(a) + "/at";
  return "/axes";
}

/// Refuses a sweep whose points all fail for one reason, such as a misspelt place. Looks at the first point
/// and at those that differ from it along one axis: a key that only some scenes have is in one of them.
Status check_points(const Plan& plan) {
  constexpr std::size_t most_tried = 64;  // values of an axis
  std::optional<Error> common;
  std::size_t stride = plan.size();
  for (const Axis& axis : plan.axes) {
    stride /= axis.values.size();
    for (std::size_t i = 0; i < std::min(axis.values.size(), most_tried); ++i) {
      const Result<scene::Document> scene = plan.scene(i * stride);
      if (scene || (common && common->text() != scene.error().text())) return ok();
      common = scene.error();
    }
  }
  return Error{axis_of(plan, common->where), "no point makes a valid scene: " + common->text(), ""};
}

}  // namespace

Result<Plan> read_plan(const std::string& path, const std::shared_ptr<const scene::Assets>& meshes) {
  const Result<std::string> text = read_file(path);
  if (!text) return text.error();
  Result<json> file = scene::parse_json(*text, path, true, {scene::max_file_bytes, scene::max_json_depth});
  if (!file) return file.error();
  Plan plan;
  plan.file = *file;
  std::optional<Error> error;
  const Reader root(&*file, "", error);
  root.object({"name", "scene", "axes", "measure", "time", "every", "budget"});
  if (error) return *error;
  plan.name = root.member("name", fs::path(path).stem().string()).name();
  plan.time = root.member("time", 1.0).number(any_time);
  plan.every = root.member("every", std::min(0.05, plan.time)).number(any_time);
  plan.budget = root.member("budget", 60.0).number({1, 1e6, "s"});
  plan.quantities = read_quantities(root.member("measure", json::array({"error", "cost"})));
  const std::size_t axes = root.member("axes").array(1, most_axes);
  for (std::size_t a = 0; a < axes && !error; ++a)
    plan.axes.push_back(read_axis(root.member("axes").element(a), (*file)["axes"][a]));
  if (!root.has("scene")) root.member("scene").fail("a preset, a file, or a scene");
  if (error) return *error;
  Result<scene::Document> base = read_scene((*file)["scene"], fs::path(path).parent_path(), meshes);
  if (!base) return base.error();
  plan.base = std::move(*base);
  // The folder of the results may be far from here: it keeps the name, and a scene that is in another file.
  plan.file["name"] = plan.name;
  if (const auto* name = plan.file["scene"].get_ptr<const std::string*>(); name && !scene::is_preset(*name))
    plan.file["scene"] = plan.base.value;
  for (const Status& checked : {check_size(plan), check_places(plan), check_points(plan)})
    if (!checked) return checked.error();
  plan.common = common_to_all(plan);
  return plan;
}

}  // namespace clothlab::sweep
