// Sparse matrices for the implicit methods and for static equilibrium, and the solution of linear systems
// with pinned vertices.
#pragma once

#include <Eigen/SparseCore>

#include "server/reference/reference.h"

namespace clothlab::reference {

using Matrix = Eigen::SparseMatrix<double>;

/// The factors of the matrices M, C and K in a system's matrix.
struct Shares {
  double mass, damping, stiffness;
};

/// Says whether the negative part of a compressed spring's stiffness, across its direction, is kept or
/// dropped (element_definite in shaders/elements/).
enum class Across { kept, dropped };

/// The matrix mass M + damping C(x) + stiffness K(x) of all vertices, [3 vertex_count]^2. C acts only along
/// the springs and leaves out that their directions turn.
Matrix system_matrix(const World& world, const std::vector<dvec3>& x, Shares shares, Across across);

/// Solves matrix * y = right_hand_side for the free vertices; pinned vertices have their values in `pinned`,
/// whose values at free vertices are ignored. Returns false if the matrix of the free vertices is not
/// positive definite.
bool solve_with_pins(const World& world, const Matrix& matrix, const std::vector<dvec3>& right_hand_side,
                     const std::vector<dvec3>& pinned, std::vector<dvec3>& y);

}  // namespace clothlab::reference
