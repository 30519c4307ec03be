#include "server/reference/system.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <tuple>

#include "shaders/elements/elements.h"

namespace clothlab::reference {

namespace {

using Triplets = std::vector<Eigen::Triplet<double>>;
using Eigen::Index;

Eigen::Map<const Eigen::VectorXd> flat(const std::vector<dvec3>& vectors) {
  return {&vectors[0].x, static_cast<Index>(3 * vectors.size())};
}

/// Adds along n n^T + across (I - n n^T) as a spring between vertices a and b sees it.
void add_spring(Triplets& triplets, Index a, Index b, const dvec3& n, double along, double across) {
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      const double value = (along - across) * n[row] * n[column] + (row == column ? across : 0.0);
      for (const auto& [i, j, sign] : {std::tuple{a, a, 1.0}, {b, b, 1.0}, {a, b, -1.0}, {b, a, -1.0}})
        triplets.emplace_back(3 * i + row, 3 * j + column, sign * value);
    }
  }
}

}  // namespace

Matrix system_matrix(const World& world, const std::vector<dvec3>& x, Shares shares, Across kept) {
  const model::Model& model = world.model;
  Triplets triplets;
  triplets.reserve(36 * model.springs.size() + 3 * x.size());
  for (std::size_t i = 0; i < x.size(); ++i)
    for (int axis = 0; axis < 3; ++axis)
      triplets.emplace_back(3 * static_cast<Index>(i) + axis, 3 * static_cast<Index>(i) + axis,
                            shares.mass * model.mass[i]);
  for (const model::Spring& spring : model.springs) {
    const scene::Springs& material = world.scene.cloths[spring.cloth].material;
    dvec3 n;
    double along, across;
    elements::spring_hessian(x[spring.a], x[spring.b], spring.rest_length,
                             model::stiffness(material, spring.kind), n, along, across);
    if (kept == Across::dropped) across = std::max(across, 0.0);
    add_spring(triplets, spring.a, spring.b, n, shares.stiffness * along + shares.damping * material.damping,
               shares.stiffness * across);
  }
  const auto size = static_cast<Index>(3 * x.size());
  Matrix matrix(size, size);
  matrix.setFromTriplets(triplets.begin(), triplets.end());
  return matrix;
}

bool solve_with_pins(const World& world, const Matrix& matrix, const std::vector<dvec3>& right_hand_side,
                     const std::vector<dvec3>& pinned, std::vector<dvec3>& y) {
  // The known values go to the right-hand side; their rows and columns become those of the unit matrix.
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
