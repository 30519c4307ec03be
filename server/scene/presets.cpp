// Loads presets (the scenes that come with the program) and scene files.
#include <filesystem>

#include "server/base/data_files.h"
#include "server/base/files.h"
#include "server/scene/document.h"
#include "server/scene/reader.h"

namespace clothlab::scene {

const std::vector<Preset>& presets() {
  static const std::vector<Preset> list = {
      {"seed", "a cloth on two swinging corners falls against a sphere"},
      {"flag", "held by a pole at one edge, in wind that comes in gusts"},
      {"curtain", "hung from rings along its top edge; a sphere swings against it"},
      {"tablecloth", "its middle lies on a table, its border falls over the edges"},
      {"drape", "a free cloth falls over a sphere and onto the floor"},
      {"twist", "opposite edges turned against each other at 72 degrees/s"},
      {"hanging-strip", "a narrow strip under its own weight: elongation has a closed form"},
      {"cantilever", "a stiff strip held level at one end bends under its weight"},
      {"trampoline", "held along its four edges, with a sphere driven into it from above"},
      {"fabrics", "cotton, silk, denim and a knit over equal balls"},
      {"skirt", "two panels sewn together, on a waistband that turns"},
      {"poncho", "a square with a hole for the neck hangs from a collar on shoulders that sway"},
      {"mannequin", "a poncho and a skirt settle on a figure that stands still"},
      {"knot", "a ribbon with an overhand knot is pulled tight and let loose"},
      {"funnel", "three layers fall through a funnel of rods"},
      {"stack", "five sheets dropped on a box, one on the other"},
      {"tablecloth-pull", "a cloth is pulled off its table, and back"},
      {"blowup", "a time step beyond the stability limit, on purpose"},
  };
  return list;
}

std::vector<std::string> preset_names() {
  std::vector<std::string> names;
  for (const Preset& preset : presets()) names.push_back(preset.name);
  return names;
}

namespace {

Result<Document> load_file(const std::filesystem::path& path, std::shared_ptr<const Assets> assets) {
  std::error_code failure;
  if (!std::filesystem::is_regular_file(path, failure))
    return Error{path.string(), "no such file",
                 "a scene file, or one of the presets " + quoted(preset_names())};
  const Result<std::string> text = read_file(path);
  if (!text) return text.error();
  Result<json> value = parse_json(*text, path.string(), true, {max_file_bytes});
  if (!value) return value.error();
  Result<Document> document = validate(std::move(*value), std::move(assets));
  if (document) return document;
  const Error& error = document.error();
  return Error{path.string() + (error.where.empty() ? "" : ": ") + error.where, "found " + error.what,
               "allowed: " + error.remedy};
}

}  // namespace

bool is_preset(const std::string& name) {
  for (const Preset& preset : presets())
    if (preset.name == name) return true;
  return false;
}

Result<Document> load_preset(const std::string& name, std::shared_ptr<const Assets> assets) {
  if (!is_preset(name))
    return Error{"preset", json(name).dump(-1, ' ', false, json::error_handler_t::replace),
                 "one of " + quoted(preset_names())};
  const Result<std::filesystem::path> path = data_path("server/scene/presets/" + name + ".json");
  if (!path) return path.error();
  return load_file(*path, std::move(assets));
}

Result<Document> load(const std::string& preset_or_path, std::shared_ptr<const Assets> assets) {
  return is_preset(preset_or_path) ? load_preset(preset_or_path, std::move(assets))
                                   : load_file(preset_or_path, std::move(assets));
}

}  // namespace clothlab::scene
