// Implicit Euler: Baraff & Witkin 1998. The unknown is the velocity u at the step's end; from an estimate of it, with x
// = start + dt u, each Newton step solves
//   J change = m (v - u) + dt f(x, u),   J = m (1 + dt air_drag) + dt C + dt^2 K,
// with C and K the matrices of the elements' damping and stiffness at x, without the part of K that is indefinite. The
// first estimate is u = 0: one Newton step from there is theirs. What a vertex cannot do, because a pin holds it or a
// collider is in the way, is filtered out of every vector of the solver (sections 5.1 to 5.3). A full Newton step can
// overshoot where elements turn by much in one step, so it is shortened until the energy whose minimum is sought falls
// (a line search: Nocedal & Wright 2006, chapter 3). Here `position` and `velocity` are the estimates.
#include "gather.glsl"
#include "blocks.glsl"

// What a collider leaves a vertex, `constraint`: xyz the unit normal of the contact, or 0 where there is none; w the
// speed of the rebound [m/s], or -1 less that where the vertex sticks to the surface.
bool sticks(vec4 constraint) { return constraint.w < 0.0; }

/// Without the part along the normal of a contact; nothing is left of a vertex that is pinned or sticks.
vec3 filtered(vec3 v, float inverse_mass, vec4 constraint) {
  return inverse_mass > 0.0 && !sticks(constraint) ? v - constraint.xyz * dot(constraint.xyz, v) : vec3(0.0);
}

/// Sums that the line search makes, each a vec4. With FREE, where nothing but its own springs acts on the cloth, one
/// more: the momentum that the linear solver left out.
#ifdef FREE
#define SUMS 3
#else
#define SUMS 2
#endif

/// Shares of the change that the line search tries.
#define SHARES 8
const float shares[SHARES] = float[](1.0, 0.5, 0.25, 0.125, 0.0625, 0.03125, 0.015625, 0.00390625);
