#include "server/reference/methods.h"
#include "server/reference/vectors.h"

namespace clothlab::reference {

State explicit_euler(const StepStart& start) {
  const State& state = start.state;
  const Vectors a = accelerations(start.world, state.position, state.velocity, start.t);
  State next = state;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const dvec3 v = state.velocity[i] + start.impulse[i];
    next.position[i] = state.position[i] + start.push[i] + start.dt * v;
    next.velocity[i] = v + start.dt * a[i];
  }
  return next;
}

State symplectic_euler(const StepStart& start) {
  const State& state = start.state;
  const Vectors a = accelerations(start.world, state.position, state.velocity, start.t);
  State next = state;
  for (std::size_t i = 0; i < a.size(); ++i) {
    next.velocity[i] = state.velocity[i] + start.dt * a[i] + start.impulse[i];
    next.position[i] = state.position[i] + start.push[i] + start.dt * next.velocity[i];
  }
  return next;
}

State verlet(const StepStart& start) {
  const State& state = start.state;
  const Vectors a = accelerations(start.world, state.position, state.velocity, start.t);
  State next = state;
  next.half_velocity.resize(a.size());
  next.half_dt.assign(a.size(), start.dt);
  for (std::size_t i = 0; i < a.size(); ++i) {
    const bool fresh = state.half_dt.empty() || state.half_dt[i] == 0.0;
    dvec3 v = fresh ? state.velocity[i] : state.half_velocity[i] + 0.5 * state.half_dt[i] * a[i];
    v += start.impulse[i];
    next.half_velocity[i] = v + 0.5 * start.dt * a[i];
    next.position[i] = state.position[i] + start.push[i] + start.dt * next.half_velocity[i];
    next.velocity[i] = v + start.dt * a[i];  // predicted, for the next step's damping and drag
  }
  return next;
}

State rk4(const StepStart& start) {
  const World& world = start.world;
  const double t = start.t, dt = start.dt;
  Vectors x = start.state.position, v = start.state.velocity;
  place_pins(world, t, x, v);
  const Vectors a1 = accelerations(world, x, v, t);

  Vectors x2 = plus(x, dt / 2, v), v2 = plus(v, dt / 2, a1);
  place_pins(world, t + dt / 2, x2, v2);
  const Vectors a2 = accelerations(world, x2, v2, t + dt / 2);

  Vectors x3 = plus(x, dt / 2, v2), v3 = plus(v, dt / 2, a2);
  place_pins(world, t + dt / 2, x3, v3);
  const Vectors a3 = accelerations(world, x3, v3, t + dt / 2);

  Vectors x4 = plus(x, dt, v3), v4 = plus(v, dt, a3);
  place_pins(world, t + dt, x4, v4);
  const Vectors a4 = accelerations(world, x4, v4, t + dt);

  State next = start.state;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const dvec3 met = start.push[i] + dt * start.impulse[i];
    next.position[i] = x[i] + met + dt / 6 * (v[i] + 2.0 * v2[i] + 2.0 * v3[i] + v4[i]);
    next.velocity[i] = v[i] + start.impulse[i] + dt / 6 * (a1[i] + 2.0 * a2[i] + 2.0 * a3[i] + a4[i]);
  }
  return next;
}

StepMethod step_method(scene::Method method) {
  switch (method) {
    case scene::Method::explicit_euler:
      return explicit_euler;
    case scene::Method::symplectic_euler:
      return symplectic_euler;
    case scene::Method::verlet:
      return verlet;
    case scene::Method::rk4:
      return rk4;
    case scene::Method::implicit_euler:
      return backward_euler;
    case scene::Method::bdf2:
      return bdf2;
    case scene::Method::pbd:
    case scene::Method::xpbd:
    case scene::Method::vbd:
      break;  // not reached: gauss_seidel_step does these
  }
  return symplectic_euler;
}

}  // namespace clothlab::reference
