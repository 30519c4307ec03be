// How much a step of a method that iterates may leave unsolved: what counts as solved (convergence.h), and
// where Newton's method may end (implicit_euler.cpp).
#pragma once

#include "server/model/model.h"
#include "server/scene/scene.h"

namespace clothlab::sim {

/// The most that a step may leave [m], as the root of the mean square over the free vertices.
double allowed_error(const model::Model& model, scene::Method method, double dt);

}  // namespace clothlab::sim
