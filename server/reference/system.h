// The sparse matrices of the implicit methods and of static equilibrium, and the linear systems with pinned
// vertices.
#pragma once

#include <Eigen/SparseCore>

#include "server/reference/reference.h"

namespace clothlab::reference {

using Matrix = Eigen::SparseMatrix<double>;

/// The shares of each matrix in a system.
struct Shares {
  double mass, damping, stiffness;
};

/// What becomes of the part of a compressed spring's stiffness that is negative
/// (element_definite in shaders/elements/).
enum class Across { kept, dropped };

/// mass M + damping C(x) + stiffness K(x), of all vertices. [3 vertex_count]^2. C leaves out how the springs'
/// directions turn: along them only.
Matrix system_matrix(const World& world, const std::vector<dvec3>& x, Shares shares, Across across);

/// Solves matrix * y = right_hand_side for the free vertices, those pinned having the values given in
/// `pinned` (its values at free vertices do not count). Returns false where the matrix is not positive
/// definite.
bool solve_with_pins(const World& world, const Matrix& matrix, const std::vector<dvec3>& right_hand_side,
                     const std::vector<dvec3>& pinned, std::vector<dvec3>& y);

}  // namespace clothlab::reference
