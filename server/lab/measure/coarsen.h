// Makes a scene with fewer vertices that describes the same cloth: same extents, same mass, same stiffness of
// the sheet in its plane.
//
// Take n x m vertices on a rectangle W x H, in cells of a x b, and strain the sheet by e along the columns.
// Each of the n columns has m - 1 structural springs of stiffness k [N/m]; each stores k (b e)^2 / 2. The
// whole sheet then acts as one spring of stiffness k n / (m - 1). This number is kept; the stretch of a
// hanging sheet depends on it, too. Bend springs reach over two cells and give 4 k n (m - 2) / (m - 1)^2.
// Rows and columns share one k for each kind; if they need different k, the geometric mean is taken. A shear
// angle stretches both diagonals of every cell and gives the shear stiffness G = 2 k a b / (a^2 + b^2). On
// square cells of a fine grid all three rules leave k unchanged. Damping is scaled like the structural
// springs. Out of the plane, bend springs store an energy of k a^4 times the fourth power of the curvature,
// so that they are stiffer there on a coarser mesh.
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "server/scene/document.h"

namespace clothlab::lab {

/// The number of vertices that a line of `count` vertices has at 1/`factor` of its resolution:
/// (count - 1) / factor + 1, rounded, at least 2.
int coarser_count(int count, int factor);

/// The scene with every grid at 1/`factor` of its resolution, for `factor` 2 or more; triangle meshes stay
/// unchanged. Error: the JSON Pointer of a pin, weight or start that has no counterpart on the coarser mesh,
/// or why no mesh can be made coarser.
Result<scene::Document> coarsen(const scene::Document& document, int factor);

/// The positions of the vertices of `fine` on the state `position` [vertex of coarse] [m] of the scene
/// `coarse`, which `coarsen` made from `fine`: [vertex of fine] [m], bilinear between the four vertices
/// around each.
std::vector<glm::dvec3> at_fine_vertices(const scene::Scene& fine, const scene::Scene& coarse,
                                         const std::vector<glm::vec3>& position);

}  // namespace clothlab::lab
