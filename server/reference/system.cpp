#include "server/reference/system.h"

#include <Eigen/SparseCholesky>
#include <algorithm>

#include "shaders/elements/elements.h"

namespace clothlab::reference {

namespace {

using Triplets = std::vector<Eigen::Triplet<double>>;
using Eigen::Index;

Eigen::Map<const Eigen::VectorXd> flat(const std::vector<dvec3>& vectors) {
  return {&vectors[0].x, static_cast<Index>(3 * vectors.size())};
}

/// Adds an element's matrix: the response of each corner to a unit move of every corner along each axis.
template <class Law>
void add_element(Triplets& triplets, const model::Element<Law>& element, const std::vector<dvec3>& x,
                 Shares shares, Across across) {
  for (std::size_t row = 0; row < element.corners; ++row) {
    auto hessian = element_hessian(law_at(element, row), edges(element, row, x));
    if (across == Across::dropped) hessian = element_definite(hessian);
    for (std::size_t column = 0; column < element.corners; ++column)
      for (int axis = 0; axis < 3; ++axis) {
        dvec3 along(0.0);
        along[axis] = 1.0;
        const auto moves = edges(element, row, [&](std::uint32_t other) {
          const dvec3 there = other == element.vertices[column] ? along : dvec3(0.0);
          return (row == column ? along : dvec3(0.0)) - there;
        });
        const dvec3 felt = shares.stiffness * matrix_product(stiffness_matrix(hessian), moves) +
                           shares.damping * matrix_product(damping_matrix(hessian), moves);
        for (int to = 0; to < 3; ++to)
          triplets.emplace_back(3 * static_cast<Index>(element.vertices[row]) + to,
                                3 * static_cast<Index>(element.vertices[column]) + axis, felt[to]);
      }
  }
}

}  // namespace

Matrix system_matrix(const World& world, const std::vector<dvec3>& x, Shares shares, Across across) {
  const model::Model& model = world.model;
  Triplets triplets;
  for (std::size_t i = 0; i < x.size(); ++i)
    for (int axis = 0; axis < 3; ++axis)
      triplets.emplace_back(3 * static_cast<Index>(i) + axis, 3 * static_cast<Index>(i) + axis,
                            shares.mass * model.mass[i]);
  model::each_element(model.elements,
                      [&](const auto& element) { add_element(triplets, element, x, shares, across); });
  const auto size = static_cast<Index>(3 * x.size());
  Matrix matrix(size, size);
  matrix.setFromTriplets(triplets.begin(), triplets.end());
  return matrix;
}

bool solve_with_pins(const World& world, const Matrix& matrix, const std::vector<dvec3>& right_hand_side,
                     const std::vector<dvec3>& pinned, std::vector<dvec3>& y) {
  // The known values move to the right-hand side; their rows and columns become those of the unit matrix.
  std::vector<dvec3> known = pinned;
  for (std::size_t i = 0; i < known.size(); ++i)
    if (!world.pinned(i)) known[i] = dvec3(0.0);
  Eigen::VectorXd b = flat(right_hand_side) - matrix * flat(known);
  Matrix reduced = matrix;
  const auto held = [&](Index row) { return world.pinned(static_cast<std::size_t>(row / 3)); };
  reduced.prune(
      [&](Index row, Index column, double) { return row == column || (!held(row) && !held(column)); });
  for (Index row = 0; row < reduced.rows(); ++row) {
    if (!held(row)) continue;
    reduced.coeffRef(row, row) = 1.0;
    b[row] = flat(known)[row];
  }
  const Eigen::SimplicialLDLT<Matrix> factors(reduced);
  if (factors.info() != Eigen::Success || !(factors.vectorD().minCoeff() > 0.0)) return false;
  const Eigen::VectorXd solution = factors.solve(b);
  y.resize(known.size());
  for (std::size_t i = 0; i < y.size(); ++i)
    for (int axis = 0; axis < 3; ++axis) y[i][axis] = solution[3 * static_cast<Index>(i) + axis];
  return true;
}

}  // namespace clothlab::reference
