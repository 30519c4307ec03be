// The largest eigenvalue of a symmetric 3x3 matrix, and its eigenvector.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

namespace clothlab::model {

struct Eigenpair {
  double value = 0;
  glm::dvec3 vector{1.0, 0.0, 0.0};  ///< of length 1
};

/// By Jacobi's rotations (Golub & Van Loan 2013, section 8.5). `matrix` must be symmetric and finite.
Eigenpair largest_eigenpair(glm::dmat3 matrix);

}  // namespace clothlab::model
