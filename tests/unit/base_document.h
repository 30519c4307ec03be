// A document that has something at nearly every place.
#pragma once

#include "server/scene/document.h"

namespace clothlab::test {

using scene::json;

/// The seed, a floor, wind, an explicit triangle and every motion: a value to change at each place of the
/// document.
inline json base_document() {
  json value = scene::load_preset("seed")->value;
  json triangle = json::parse(
      R"({"name": "triangle", "mesh": {"vertices": [[0,0,0],[0,0,1],[1,0,0]], "triangles": [[0,1,2]]},
    "mass": {"area_density": 0.2},
    "pins": [{"at": "vertex:2", "motion": {"linear": {"velocity": [1,0,0]}}},
             {"at": {"box": [[-1,-1,-1],[0.1,1,0.1]]},
              "motion": {"spin": {"axis": [1,0,0], "center": [0,0,0], "degrees_per_second": 72}}}],
    "weights": [{"at": "vertex:1", "mass": 0.5}], "start": {"scatter": {"size": 0.5}}})");
  value["cloths"].push_back(triangle);
  value["colliders"].push_back(
      json::parse(R"({"name": "floor", "plane": {"point": [0,0,0], "normal": [0,2,0]}})"));
  value["wind"] = {{"velocity", {2, 0, 0}}};
  value["colliders"].push_back(json::parse(R"({"capsule": {"a": [0,0,0], "b": [0,1,0], "radius": 0.1}})"));
  value["colliders"].push_back(json::parse(R"({"box": {"center": [0,0,0], "half": [1,1,1]}})"));
  return scene::validate(value)->value;
}

}  // namespace clothlab::test
