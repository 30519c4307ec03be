#include "server/sim/integrator.h"

#include "server/scene/method.h"
#include "server/sim/colliders.h"

namespace clothlab::sim {

namespace {

Result<std::unique_ptr<Integrator>> make(const Surroundings& around, const Plan& plan) {
  switch (around.scene.solver.method) {
    case scene::Method::explicit_euler:
    case scene::Method::symplectic_euler:
    case scene::Method::verlet:
      return make_whole_step(around.scene.solver.method, around.model.vertex_count(), plan);
    case scene::Method::rk4:
      return make_rk4(around.model.vertex_count(), plan);
    case scene::Method::implicit_euler:
    case scene::Method::bdf2:
      return make_implicit_euler(around.model, plan);
    case scene::Method::pbd:
    case scene::Method::xpbd:
    case scene::Method::vbd:
      return make_gauss_seidel(around, plan);
  }
  return Error{"/solver/method", "a method without kernels", "use another one"};
}

}  // namespace

Result<std::unique_ptr<Integrator>> make_integrator(const Surroundings& around, const Plan& plan) {
  Result<std::unique_ptr<Integrator>> integrator = make(around, plan);
  if (integrator) (*integrator)->set_parameters(around);
  return integrator;
}

void set_step_uniforms(const gl::Program& program, const Surroundings& around) {
  const scene::Scene& scene = around.scene;
  program.set("vertex_count", static_cast<GLint>(around.model.vertex_count()));
  program.set("dt", static_cast<float>(scene.solver.dt));
  glProgramUniform4f(program.id(), program.location("gravity"), static_cast<float>(scene.gravity.x),
                     static_cast<float>(scene.gravity.y), static_cast<float>(scene.gravity.z),
                     static_cast<float>(scene.air_drag));
  set_colliders(program, scene, around.model, around.motions);
  if (scene.wind)
    glProgramUniform2f(program.id(), program.location("wind_coefficients"),
                       static_cast<float>(scene.wind->drag), static_cast<float>(scene.wind->lift));
  if (!around.self_collision) return;
  program.set("self_friction", static_cast<float>(scene.self_collision->friction));
  program.set("skin", around.self_collision->skin());
}

}  // namespace clothlab::sim
