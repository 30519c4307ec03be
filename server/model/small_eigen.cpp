#include "server/model/small_eigen.h"

#include <cmath>

namespace clothlab::model {

namespace {

/// Rotates the axes p and q so that matrix[p][q] becomes 0, and applies the same rotation to `axes`.
void rotate(glm::dmat3& matrix, glm::dmat3& axes, int p, int q) {
  const double off = matrix[p][q];
  if (off == 0.0) return;
  const double tau = (matrix[q][q] - matrix[p][p]) / (2.0 * off);
  const double t = std::copysign(1.0, tau) / (std::abs(tau) + std::hypot(1.0, tau));
  const double c = 1.0 / std::hypot(1.0, t), s = t * c;
  glm::dmat3 turn(1.0);
  turn[p][p] = turn[q][q] = c;
  turn[q][p] = s;
  turn[p][q] = -s;
  matrix = glm::transpose(turn) * matrix * turn;
  matrix[p][q] = matrix[q][p] = 0.0;
  axes = axes * turn;
}

}  // namespace

Eigenpair largest_eigenpair(glm::dmat3 matrix) {
  glm::dmat3 axes(1.0);
  // Convergence is quadratic: a handful of sweeps reaches the last digit.
  for (int sweep = 0; sweep < 12; ++sweep) {
    if (matrix[0][1] == 0.0 && matrix[0][2] == 0.0 && matrix[1][2] == 0.0) break;
    rotate(matrix, axes, 0, 1);
    rotate(matrix, axes, 0, 2);
    rotate(matrix, axes, 1, 2);
  }
  int largest = 0;
  for (int i = 1; i < 3; ++i)
    if (matrix[i][i] > matrix[largest][largest]) largest = i;
  return {matrix[largest][largest], axes[largest]};
}

}  // namespace clothlab::model
