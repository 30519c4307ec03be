// Patches of all three kinds, one per line, each applied to the result of those before: an object is a merge
// patch (RFC 7396), an array a list of operations (RFC 6902), a line that starts with a slash an assignment
// like --set. A line that names a preset starts again from that preset.
#include <algorithm>

#include "tests/fuzz/document.h"

using namespace clothlab;

namespace {

/// A small scene with everything that a document can have.
const char* const rich =
    R"({"version": 1, "name": "rich", "air_drag": 0.5, "self_collision": {"thickness": 0.01},
  "cloths": [
    {"name": "grid", "mesh": {"grid": {"columns": 3, "rows": 4}}, "start": {"scale": [1, 1, 0]},
     "material": {"strain_limit": 0.1}, "weights": [{"at": "edge:row:3", "mass": 0.5}],
     "pins": [{"at": "corner:0,0", "motion": {"oscillate": {"axis": [0, 0, 1], "amplitude": 0.2, "frequency": 1}}}]},
    {"name": "mesh", "mesh": {"vertices": [[0,0,0],[0,0,1],[1,0,0],[1,0,1]], "triangles": [[0,1,2],[1,3,2]]},
     "mass": {"area_density": 0.2}, "start": {"scatter": {"size": 0.5}},
     "pins": [{"at": "vertex:2", "motion": {"linear": {"velocity": [1, 0, 0]}}},
              {"at": {"box": [[-1,-1,-1],[0.1,1,0.1]]},
               "motion": {"spin": {"axis": [1,0,0], "center": [0,0,0], "degrees_per_second": 72}}}]}],
  "colliders": [{"name": "ball", "sphere": {"center": [0, 0.6, 0], "radius": 0.25}, "friction": 0.3},
                {"plane": {"point": [0,0,0], "normal": [0,2,0]}, "motion": {"linear": {"velocity": [0,1,0]}}}]})";

const scene::Document& start() {
  static const scene::Document document = *scene::validate(*scene::parse_json(rich, "rich"));
  return document;
}

Result<scene::Document> patched(const scene::Document& document, const std::string& line) {
  if (!line.empty() && line[0] == '/') return scene::set_value(document, line);
  Result<scene::json> patch = scene::parse_json(line, "patch");
  if (!patch) return patch.error();
  return scene::apply_patch(document, *patch);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text = fuzz::text_of(data, size);
  std::string_view rest = text;
  scene::Document document = start();
  for (int lines = 0; !rest.empty() && lines < 16; ++lines) {
    const std::string line = fuzz::next_line(rest);
    const std::vector<std::string> presets = scene::preset_names();
    if (std::find(presets.begin(), presets.end(), line) != presets.end()) {
      document = *scene::load_preset(line);
      continue;
    }
    const scene::json before = document.value;
    const Result<scene::Document> after = patched(document, line);
    fuzz::require(document.value == before, "a patch does not touch the document it is applied to");
    if (after)
      document = *after;
    else
      fuzz::require_complete(after.error());
  }
  fuzz::require_settled(document);
  fuzz::require_model(document.scene);
  return 0;
}
