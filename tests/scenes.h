// Scenes as plain data for the tests, and the OpenGL context they run in.
#pragma once

#include <cstdlib>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <string>

#include "server/gl/context.h"
#include "server/scene/document.h"
#include "server/sim/simulation.h"
#include "tests/catch.h"

namespace clothlab::test {

/// An OpenGL context, current on this thread for the rest of the test. Fails the test, with the reason, if
/// there is none.
inline std::unique_ptr<gl::Context> context() {
  Result<std::unique_ptr<gl::Context>> made = gl::Context::create();
  INFO((made ? "" : made.error().text()));
  REQUIRE(made);
  return std::move(*made);
}

/// Such a context whose work groups four threads compute, in an order that differs from run to run, if it is
/// Mesa's software OpenGL. (Other tests compute on one thread.)
inline std::unique_ptr<gl::Context> threaded_context() {
  // Mesa reads the variable when it opens a display. The one of all other tests is opened before.
  context();
  const char* others = std::getenv("LP_NUM_THREADS");
  const std::string before = others ? others : "";
  setenv("LP_NUM_THREADS", "4", 1);
  Result<std::unique_ptr<gl::Context>> made = gl::Context::create(std::nullopt, gl::HelperThreads::sessions);
  if (others)
    setenv("LP_NUM_THREADS", before.c_str(), 1);
  else
    unsetenv("LP_NUM_THREADS");
  INFO((made ? "" : made.error().text()));
  REQUIRE(made);
  REQUIRE_FALSE(gl::computes_on_calling_thread());
  return std::move(*made);
}

inline std::unique_ptr<sim::Simulation> simulation(const scene::Scene& scene) {
  Result<std::unique_ptr<sim::Simulation>> made = sim::Simulation::create(scene);
  INFO((made ? "" : made.error().text()));
  REQUIRE(made);
  return std::move(*made);
}

/// Parses a scene. Fails the test, with the reason, if the text is no scene.
inline scene::Document document_of(const std::string& text) {
  Result<scene::json> value = scene::parse_json(text, "test", true);
  Result<scene::Document> document = value ? scene::validate(*value) : value.error();
  if (!document) FAIL(document.error().text());
  return *document;
}

/// A free 1 m x 1 m grid at y = 1 m with the seed's material; no colliders.
inline scene::Scene sheet(int columns, int rows) {
  scene::Scene scene;
  scene::Cloth cloth;
  cloth.mesh = scene::Grid{columns, rows, 1.0, 1.0};
  cloth.transform.translate = {0.0, 1.0, 0.0};
  scene.cloths = {cloth};
  return scene;
}

/// The seed scene.
inline scene::Scene seed() {
  scene::Scene scene = sheet(25, 25);
  const scene::Oscillate swing{{0.0, 0.0, 1.0}, 0.2, 0.5};
  scene.cloths[0].pins = {{scene::AtCorner{0, 0}, swing}, {scene::AtCorner{24, 0}, swing}};
  scene.colliders = {{"ball", scene::Sphere{{0.0, 0.6, 0.0}, 0.25}, 0.3, 0.0, {}}};
  scene.self_collision = scene::SelfCollision{0.01, 0.2};
  return scene;
}

}  // namespace clothlab::test
