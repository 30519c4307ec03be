// The parts of a Gauss-Seidel step (gauss_seidel.h): what it carries from sweep to sweep, and the sweeps.
#pragma once

#include "server/reference/reference.h"

namespace clothlab::reference {

/// A step under way. All displacements are from the step's start.
struct SweepState {
  const World& world;
  double t, dt;                      ///< [s], of the step's start and its length
  std::vector<dvec3> x, v;           ///< [vertex_count] at the step's start [m], [m/s]
  std::vector<dvec3> displacement;   ///< [vertex_count] so far [m]; of pinned vertices the whole step's
  std::vector<dvec3> free;           ///< [vertex_count] what inertia, gravity and air drag alone would do [m]
  std::vector<dvec3> pushed;         ///< [vertex_count] VBD: by self-collision so far [m]
  std::vector<double> mobility;      ///< [vertex_count] 1 / ((1 + dt air drag) mass) [1/kg], 0 if pinned
  std::vector<dvec3> spring_pushed;  ///< [spring_count] XPBD: by each spring so far, on its first end [kg m]
  std::vector<int> met;              ///< [vertex_count] VBD: colliders met at the last visit
  std::vector<int> contacts;         ///< [vertex_count] counted in the last pass; 0 if pinned

  dvec3 now(std::size_t vertex) const { return x[vertex] + displacement[vertex]; }
};

/// PBD and XPBD: visits every spring once, colour by colour.
void sweep_springs(SweepState& step);

/// VBD: moves every free vertex to where its own forces balance, by one Newton step each, colour by colour;
/// colliders are met on the way.
void sweep_vertices(SweepState& step);

/// Self-collision and colliders, all vertices from the displacements before the pass. VBD's target moves by
/// what self-collision pushes, so that the next sweep does not take it back.
void contact_pass(SweepState& step);

/// VBD, where nothing but its own springs and self-collision acts on a cloth: they only pass momentum on, so
/// what its vertices lack of it in all after the sweeps is given to them alike.
void balance_momentum(SweepState& step);

}  // namespace clothlab::reference
