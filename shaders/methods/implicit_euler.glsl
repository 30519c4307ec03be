// Implicit Euler: Baraff & Witkin 1998. The unknown is the velocity u at the step's end. From an estimate of u, with x
// = start + dt u, each Newton step solves
//   J change = m (v - u) + dt f(x, u),   J = m (1 + dt drag) + dt C + dt^2 K,
// with C and K the matrices of the elements' damping and stiffness at x, without the indefinite part of K. The first
// estimate is the velocity at the step's start, with contact in the problem u = 0: one Newton step from there is their
// method. From the velocity elements have turned nearly as far as they will, and one Newton step does what takes two
// from u = 0. A motion that a pin or a collider prevents is filtered
// out of every vector of the solver (sections 5.1 to 5.3). A full Newton step can overshoot if elements turn by much in
// one step, so it is shortened until the energy that is minimised falls (a line search: Nocedal & Wright 2006, chapter
// 3). Here `position` and `velocity` are the estimates.
#include "gather.glsl"
#include "blocks.glsl"

// `constraint`: how a collider holds a vertex. xyz: unit normal of the contact, 0 without a contact; w: speed of the
// rebound [m/s], or -1 minus that speed if the vertex sticks to the surface.
bool sticks(vec4 constraint) { return constraint.w < 0.0; }

#ifdef WIND
READ_VEC4(wind_loads, unit_wind);  // implicit_wind.comp
/// Drag of the air on a vertex [1/s].
float drag(int i) { return gravity.w + FETCH(wind_loads, i).w; }
#else
float drag(int i) { return gravity.w; }
#endif

/// v without the part along a contact's normal; 0 for a vertex that is pinned or sticks.
vec3 filtered(vec3 v, float inverse_mass, vec4 constraint) {
  return inverse_mass > 0.0 && !sticks(constraint) ? v - constraint.xyz * dot(constraint.xyz, v) : vec3(0.0);
}

/// Trends of the motion, from which a better first guess is combined: the first, second and third differences of the
/// last steps' velocities, from the first what gravity adds to the guess taken off. So the sum of the first two
/// continues the velocities as a parabola.
#define TRENDS 3

/// The line search makes this number of sums, each a vec4. With FREE, for a cloth on which nothing but its own springs
/// acts, there is one more: the momentum that the linear solver left out.
#ifdef FREE
#define SUMS 3
#else
#define SUMS 2
#endif

/// Shares of the change that the line search tries.
#define SHARES 8
const float shares[SHARES] = float[](1.0, 0.5, 0.25, 0.125, 0.0625, 0.03125, 0.015625, 0.00390625);
