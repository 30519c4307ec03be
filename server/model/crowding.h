// How many others a neighbour search has to look at for each vertex, found before it is made.
#pragma once

#include <glm/vec3.hpp>
#include <vector>

namespace clothlab::model {

/// The mean, over a sample of the vertices, of how many others lie in the eight cells, `cell` [m] wide, of a
/// regular grid that are nearest to the vertex. Takes a sort of all vertices.
double crowding(const std::vector<glm::dvec3>& positions, double cell);

}  // namespace clothlab::model
