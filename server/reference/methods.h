// One step of each method from t to t + dt, as textbooks write it, in double precision. The caller treats
// pins and colliders: it overwrites what a method returns for a pinned vertex.
#pragma once

#include <functional>

#include "server/reference/reference.h"

namespace clothlab::reference {

/// The input of a step.
struct StepStart {
  const World& world;
  const State& state;          ///< at time t
  std::vector<dvec3> push;     ///< [vertex_count] self-collision adds it to the position [m]
  std::vector<dvec3> impulse;  ///< [vertex_count] self-collision adds it to the velocity at the start [m/s]
  double t, dt;                ///< [s]
};

using StepMethod = std::function<State(const StepStart&)>;

/// x += v dt; v += a(x, v) dt, both from the state at t.
State explicit_euler(const StepStart& start);
/// v += a(x, v) dt; x += v dt with the new v.
State symplectic_euler(const StepStart& start);
/// Velocity Verlet with one evaluation of forces per step. Damping uses a velocity predicted from the last
/// acceleration, which keeps the second order (Groot & Warren 1997, with their lambda = 1).
State verlet(const StepStart& start);
/// The classical Runge-Kutta method of fourth order; each stage has the pins where they are at its time.
State rk4(const StepStart& start);
/// Backward Euler: u = v + dt a(x + dt u, u), x += dt u, solved by Newton's method to rounding.
State backward_euler(const StepStart& start);
/// BDF2 (Choi & Ko 2002): backward Euler from x_0 and v_0 of shaders/methods/bdf2.glsl with 2/3 of dt, solved
/// likewise; without a way and gain of the last step, backward Euler.
State bdf2(const StepStart& start);
/// To be called when a step of `bdf2` has ended at `next`, with contacts: notes its way and gain there.
/// Returns false if the motion is not smooth, as contact began or the wind took a vertex along: then nothing
/// is noted.
bool note_step(const StepStart& start, State& next);
/// Backward Euler or BDF2 with exactly `solver.iterations` Newton steps from the velocity at the step's start
/// (Baraff & Witkin 1998 take one, from u = 0).
State limited_newton(const StepStart& start);

/// A whole step by `method` with contacts, pins and strain limit, from time t to t_next = t + solver.dt.
void advance(const StepMethod& method, const World& world, State& state, double t, double t_next);

/// The function above for `method`. PBD, XPBD and VBD have none: see gauss_seidel.h.
StepMethod step_method(scene::Method method);

}  // namespace clothlab::reference
