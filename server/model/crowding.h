// Estimates the cost of a neighbour search before it is made: how many other vertices it examines per vertex.
#pragma once

#include <glm/vec3.hpp>
#include <vector>

namespace clothlab::model {

/// The mean number of other vertices in the eight cells nearest to a vertex, in a regular grid with cells
/// `cell` [m] wide. The mean is over at most 1000 of the vertices. Sorts all vertices by cell.
double crowding(const std::vector<glm::dvec3>& positions, double cell);

}  // namespace clothlab::model
