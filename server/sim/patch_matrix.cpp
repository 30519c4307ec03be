#include "server/sim/patch_matrix.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <utility>

namespace clothlab::sim {

namespace {

using Matrix = Eigen::MatrixXd;
using Group = model::Dissection::Group;
using Square = Eigen::Matrix<double, patch_unknowns, patch_unknowns>;

constexpr Eigen::Index unknowns(std::uint32_t patches) {
  return static_cast<Eigen::Index>(patches * patch_unknowns);
}

/// Sets `rows`, which holds those of the matrix, to those of the inverse factor, of which `inverse` has all
/// groups below this one. False if the matrix is not definite.
/// With A the rows left of the group's own square S, and V the inverse factor of the groups below:
/// X = A V^T, S - X X^T = L L^T, and the rows are L^-1 [-X V, 1].
bool invert(Matrix& rows, const Group& group, const std::vector<Group>& groups,
            const std::vector<Matrix>& inverse, const std::vector<std::uint32_t>& coupled) {
  const Eigen::Index size = rows.rows(), below = rows.cols() - size;
  Matrix x = Matrix::Zero(size, below);
  for (std::size_t k = inverse.size(); k-- > 0 && groups[k].begin >= group.first;) {
    const Group& lower = groups[k];
    const Eigen::Index at = unknowns(lower.begin - group.first);
    for (const std::uint32_t column : coupled) {
      if (column < lower.first || column >= lower.end) continue;
      x.middleCols(at, inverse[k].rows()).noalias() +=
          rows.middleCols<patch_unknowns>(unknowns(column - group.first)) *
          inverse[k].middleCols<patch_unknowns>(unknowns(column - lower.first)).transpose();
    }
  }
  Matrix own = rows.rightCols(size);
  if (below > 0) own.selfadjointView<Eigen::Lower>().rankUpdate(x, -1.0);
  for (Eigen::Index k = 0; k < size; ++k)
    if (own(k, k) == 0.0) own(k, k) = 1.0;
  const Eigen::LLT<Matrix> factor(own);
  if (factor.info() != Eigen::Success) return false;
  rows.rightCols(size).setIdentity();
  factor.matrixL().solveInPlace(rows.rightCols(size));
  if (below == 0) return rows.allFinite();
  factor.matrixL().solveInPlace(x);
  rows.leftCols(below).setZero();
  for (std::size_t k = inverse.size(); k-- > 0 && groups[k].begin >= group.first;) {
    const Group& lower = groups[k];
    rows.middleCols(unknowns(lower.first - group.first), inverse[k].cols()).noalias() -=
        x.middleCols(unknowns(lower.begin - group.first), inverse[k].rows()) * inverse[k];
  }
  return rows.allFinite();
}

}  // namespace

PatchMatrix::PatchMatrix(model::Dissection dissection) : dissection_(std::move(dissection)) {
  std::size_t blocks = 0;
  for (std::uint32_t k = 0; k < dissection_.groups.size(); ++k) {
    const Group& group = dissection_.groups[k];
    for (std::uint32_t row = group.begin; row < group.end; ++row) {
      group_of_.push_back(k);
      first_block_.push_back(blocks);
      blocks += group.end - group.first;
    }
  }
  blocks_.assign(blocks, PatchBlock{});
}

bool PatchMatrix::couples(std::uint32_t row, std::uint32_t column) const {
  const Group& group = dissection_.groups[group_of_[row]];
  return column >= group.first && column < group.end;
}

std::vector<std::vector<double>> PatchMatrix::inverse_factor() const {
  std::vector<Matrix> inverse;
  for (const Group& group : dissection_.groups) {
    Matrix rows(unknowns(group.end - group.begin), unknowns(group.end - group.first));
    std::vector<std::uint32_t> coupled;  // columns left of the group's own with an entry
    for (std::uint32_t column = group.first; column < group.end; ++column) {
      bool any = false;
      for (std::uint32_t row = group.begin; row < group.end; ++row) {
        const Square block = Eigen::Map<const Square>(blocks_[number(row, column)].data());
        rows.block<patch_unknowns, patch_unknowns>(unknowns(row - group.begin),
                                                   unknowns(column - group.first)) = block;
        any = any || !block.isZero(0.0);
      }
      if (any && column < group.begin) coupled.push_back(column);
    }
    if (!invert(rows, group, dissection_.groups, inverse, coupled)) return {};
    inverse.push_back(std::move(rows));
  }
  std::vector<std::vector<double>> numbers;
  for (const Matrix& rows : inverse) numbers.emplace_back(rows.data(), rows.data() + rows.size());
  return numbers;
}

}  // namespace clothlab::sim
