// A scene with fewer vertices that means the same cloth: same extents, same mass, same stiffness of the sheet
// in its plane.
//
// Of n x m vertices on a rectangle W x H, spacing a x b, strained by e along the columns, each of n columns
// of m - 1 structural springs k stores k (b e)^2 / 2 a spring: as one spring for the whole sheet, k n / (m -
// 1). Kept is that number, which is also what a hung sheet's stretch depends on. Bend springs reach over two
// cells: 4 k n (m - 2) / (m - 1)^2. Both kinds have the same k along rows and columns, so where these differ
// k is the geometric mean of what each wants. A shear angle stretches both diagonals of every cell:
// G = 2 k a b / (a^2 + b^2). On square cells of a fine grid all three say that k stays what it is. Damping
// follows the structural springs. Out of the plane bend springs resist by an energy of k a^4 times the fourth
// power of the curvature: what they do there is stiffer on a coarser mesh.
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "server/scene/document.h"

namespace clothlab::lab {

/// Vertices along a line of `count` with 1/`factor` of its resolution: (count - 1) / factor + 1, rounded, at
/// least 2.
int coarser_count(int count, int factor);

/// Every grid of the scene with 1/`factor` of its resolution, for `factor` 2 or more; triangle meshes stay as
/// they are. Error: what has no counterpart on the coarser mesh (its JSON Pointer), or why nothing can be
/// coarser.
Result<scene::Document> coarsen(const scene::Document& document, int factor);

/// Where the vertices of `fine` [vertex of fine] are on a state of `coarse` [vertex of coarse] [m], which
/// `coarsen` made of it: bilinear between the four around them.
std::vector<glm::dvec3> at_fine_vertices(const scene::Scene& fine, const scene::Scene& coarse,
                                         const std::vector<glm::vec3>& position);

}  // namespace clothlab::lab
