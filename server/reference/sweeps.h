// The parts of a Gauss-Seidel step (gauss_seidel.h): the state kept from sweep to sweep, and the sweeps.
#pragma once

#include "server/reference/reference.h"

namespace clothlab::reference {

/// What the first corner of each element has pushed off from the others.
template <class Law>
using Pushes = std::vector<elements::Edges<Law>>;

/// The state within a step. All displacements are from the step's start.
struct SweepState {
  const World& world;
  double t, dt;                          ///< time at the step's start, length of the step [s]
  std::vector<dvec3> x, v;               ///< [vertex_count] at the step's start [m], [m/s]
  std::vector<dvec3> displacement;       ///< [vertex_count] so far [m]; of the whole step for pinned vertices
  std::vector<dvec3> free_displacement;  ///< [vertex_count] by inertia, gravity and drag alone [m]
  /// [vertex_count] What the wind adds to the displacement that inertia, gravity and drag give [m].
  std::vector<dvec3> blown;
  /// [vertex_count] VBD: what the wind, whose force is linear in the velocity at the step's end, adds to the
  /// inertia of a vertex [kg].
  std::vector<double> added_inertia;
  std::vector<dvec3> self_collision_push;  ///< [vertex_count] VBD: displacement by self-collision so far [m]
  std::vector<double> mobility;  ///< [vertex_count] 1 / ((1 + dt air drag) mass) [1/kg], 0 if pinned
  /// XPBD, for each law [element_count]: impulses times dt so far [kg m].
  elements::PerLaw<Pushes, elements::SweptLaws> pushed;
  std::vector<int> colliders_met;  ///< [vertex_count] VBD: colliders met at the last visit of the vertex
  std::vector<int> contacts;       ///< [vertex_count] contacts at the last count; 0 if pinned

  dvec3 now(std::size_t vertex) const { return x[vertex] + displacement[vertex]; }
};

/// PBD and XPBD: visits every element once, law by law and colour by colour.
void sweep_elements(SweepState& step);

/// VBD: moves every free vertex, colour by colour, towards the balance of its own forces by one Newton step.
/// A collider in the way stops the vertex.
void sweep_vertices(SweepState& step);

/// Applies self-collision, for all vertices from the displacements before the pass, and then colliders. Under
/// VBD a vertex's target moves by self-collision's push, so that the next sweep does not undo the push.
void contact_pass(SweepState& step);

/// VBD, for each cloth without pins in a scene without colliders: springs and self-collision only pass
/// momentum on, so the momentum that a cloth lacks after the sweeps is given back by one displacement of all
/// its vertices.
void balance_momentum(SweepState& step);

}  // namespace clothlab::reference
