#include "server/lab/measure/setting.h"

#include <nlohmann/json.hpp>

#include "server/base/text.h"
#include "server/scene/method.h"

namespace clothlab::lab {

Setting setting_of(const scene::Scene& scene) {
  const scene::Solver& solver = scene.solver;
  Setting setting{solver.method, solver.dt, 1, 1e-4};
  if (iterates(solver.method)) setting.iterations = solver.iterations;
  if (scene::solves(solver.method)) setting.tolerance = solver.tolerance;
  return setting;
}

scene::Scene with(scene::Scene scene, const Setting& setting) {
  scene.solver.method = setting.method;
  scene.solver.dt = setting.dt;
  scene.solver.iterations = setting.iterations;
  scene.solver.tolerance = setting.tolerance;
  return scene;
}

json patch(const Setting& setting) {
  json solver{{"method", scene::name(setting.method)}, {"dt", setting.dt}};
  if (iterates(setting.method)) solver["iterations"] = setting.iterations;
  if (scene::solves(setting.method)) solver["tolerance"] = setting.tolerance;
  return {{"solver", solver}};
}

json to_json(const Setting& setting) {
  const bool iterating = iterates(setting.method), solving = scene::solves(setting.method);
  return {{"method", scene::name(setting.method)},
          {"dt_s", setting.dt},
          {"iterations", iterating ? json(setting.iterations) : json()},
          {"tolerance", solving ? json(setting.tolerance) : json()}};
}

std::string text(const Setting& setting) {
  std::string text = formatted("%s, dt %.3g ms", scene::name(setting.method), 1000.0 * setting.dt);
  if (iterates(setting.method))
    text +=
        ", " + std::to_string(setting.iterations) + (setting.iterations == 1 ? " iteration" : " iterations");
  return text;
}

}  // namespace clothlab::lab
