#include "tests/bench/peers/peer.h"

#include <cmath>
#include <fstream>
#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>
#include <numbers>

namespace clothlab::peers {

namespace {

using nlohmann::json;

dvec3 vector_of(const json& from) {
  return {from.at(0).get<double>(), from.at(1).get<double>(), from.at(2).get<double>()};
}

Collider collider_of(const json& from) {
  Collider made;
  made.friction = from.at("friction").get<double>();
  if (from.contains("sphere")) {
    made.radius = from.at("sphere").at("radius").get<double>();
    made.place = vector_of(from.at("sphere").at("center"));
  } else {
    made.place = vector_of(from.at("plane").at("point"));
    made.normal = glm::normalize(vector_of(from.at("plane").at("normal")));
  }
  return made;
}

}  // namespace

Scene load(const std::string& path) {
  const json file = json::parse(std::ifstream(path));
  const json &document = file.at("document"), &material = document.at("cloths").at(0).at("material");
  Scene made;
  for (const json& vertex : file.at("vertices")) made.vertices.push_back(vector_of(vertex));
  made.triangles = file.at("triangles").get<std::vector<std::array<int, 3>>>();
  for (const json& spring : file.at("springs"))
    made.springs.push_back({spring.at(0).get<int>(), spring.at(1).get<int>(), spring.at(2).get<bool>()});
  made.held = file.at("held").get<std::vector<int>>();
  made.turned = file.at("turned").get<std::vector<int>>();
  if (!made.turned.empty()) {
    const json& spin = document.at("cloths").at(0).at("pins").at(1).at("motion").at("spin");
    made.axis = glm::normalize(vector_of(spin.at("axis")));
    made.center = vector_of(spin.at("center"));
    made.turn = spin.at("degrees_per_second").get<double>() * std::numbers::pi / 180.0;
  }
  const double mass = document.at("cloths").at(0).at("mass").at("per_vertex").get<double>();
  made.stiffness = material.at("structural").get<double>() / mass;
  made.bend = material.at("bend").get<double>() / mass;
  made.damping = material.at("damping").get<double>() / mass;
  if (document.contains("self_collision")) {
    made.thickness = document.at("self_collision").at("thickness").get<double>();
    made.friction = document.at("self_collision").at("friction").get<double>();
  }
  for (const json& collider : document.value("colliders", json::array()))
    made.colliders.push_back(collider_of(collider));
  made.gravity = vector_of(document.at("gravity"));
  made.air_drag = document.value("air_drag", 0.0);
  made.dt = document.at("solver").at("dt").get<double>();
  made.steps = file.at("steps").get<int>();
  made.steps_a_sample = file.at("steps_a_sample").get<int>();
  made.sweeps = file.value("sweeps", made.sweeps);
  made.implicit = file.value("implicit", made.implicit);
  return made;
}

dvec3 turned_at(const Scene& scene, int i, double time) {
  const dvec3 from = scene.vertices[static_cast<std::size_t>(i)] - scene.center;
  const dvec3 along = glm::dot(from, scene.axis) * scene.axis, across = from - along;
  const double angle = scene.turn * time;
  return scene.center + along + std::cos(angle) * across + std::sin(angle) * glm::cross(scene.axis, across);
}

}  // namespace clothlab::peers
