// bench_truth SCENE.json TIME [LARGEST_STEP]: the springs of a scene and where the double-precision reference
// has its vertices at TIME [s], as JSON, for benches that hold other programs against it (peer_accuracy.mjs).
// LARGEST_STEP [s] is that of the coarser of two runs, whose distance tells the error; without it the step is
// far below every limit.
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "server/reference/trajectory.h"
#include "server/scene/document.h"

using namespace clothlab;
using nlohmann::json;

namespace {

json as_json(const std::vector<glm::dvec3>& points) {
  json list = json::array();
  for (const glm::dvec3& point : points) list.push_back({point.x, point.y, point.z});
  return list;
}

json springs_of(const model::Model& model) {
  json list = json::array();
  for (const auto& spring : model.springs())
    list.push_back({{"ends", spring.vertices},
                    {"rest_length_m", spring.law.rest_length},
                    {"stiffness", spring.law.stiffness},
                    {"damping", spring.law.damping}});
  return list;
}

int fail(const Error& error) {
  std::fprintf(stderr, "%s\n", error.text().c_str());
  return 1;
}

}  // namespace

int main(int count, char** words) {
  if (count < 3) return std::fputs("usage: bench_truth SCENE.json TIME [LARGEST_STEP]\n", stderr), 2;
  const Result<scene::Document> document = scene::load(words[1]);
  if (!document) return fail(document.error());
  const Result<reference::World> world = reference::make_world(document->scene, 0.0);
  if (!world) return fail(world.error());
  const auto truth =
      reference::trajectory(*world, {std::atof(words[2])}, count > 3 ? std::atof(words[3]) : 0.0);
  if (!truth) return fail(truth.error());
  json pinned = json::array();
  for (std::size_t i = 0; i < world->model.vertex_count(); ++i)
    if (world->pinned(i)) pinned.push_back(i);
  const json found{{"start", as_json(world->model.start_position)},
                   {"triangles", world->model.triangles},
                   {"mass_kg", world->model.mass},
                   {"springs", springs_of(world->model)},
                   {"pinned", pinned},
                   {"position", as_json(truth->states[0].position)},
                   {"error_m", truth->error[0]},
                   {"dt_s", truth->dt}};
  std::printf("%s\n", found.dump().c_str());
}
