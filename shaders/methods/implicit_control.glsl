// How a solve goes on: written by implicit_step.comp, read by indirect dispatches and by
// server/sim/conjugate_gradients.cpp.
layout(std430, binding = slot_solver_control) buffer Control {
  uint groups, groups_y, groups_z;  // of the next dispatches with a thread per vertex: 0 once this solve has ended
  uint single, single_y, single_z;  // of the next dispatches of one work group: 0, too
  uint iterations;                  // of this solve
  uint converged;
  float along;  // length of the present iteration's step
  float kept;   // share of the last direction in the present one
  float last;   // residual times preconditioned residual, in the last iteration
  float enough;  // of that product: the solve may end when no more is left
};
