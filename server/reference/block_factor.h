// A symmetric matrix of 3x3 blocks, one row and one column of blocks for each free vertex, and its Cholesky
// factor: multifrontal, in the order of a nested dissection (Duff & Reid 1983; George 1973), with Eigen's
// dense kernels for the fronts. Eigen's SimplicialLDLT works entry by entry.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <stop_token>
#include <vector>

#include "server/model/dissection.h"
#include "server/reference/vectors.h"

namespace clothlab::reference {

class BlockFactor {
 public:
  /// The pattern: `neighbours[i]` are the parts that share a block with part i, in both directions. `places`
  /// [part] say which parts are near each other.
  BlockFactor(const std::vector<std::vector<std::uint32_t>>& neighbours, const Vectors& places);

  /// A block in the lower triangle of the matrix in its order.
  struct Slot {
    std::size_t block = 0;
    bool transposed = false;  ///< true: it is the block of the column's part and the row's part
  };
  Slot slot(std::uint32_t row, std::uint32_t column) const;

  void clear();
  Eigen::Matrix3d& block(std::size_t number) { return blocks_[number]; }

  enum class Outcome { done, indefinite, stopped };
  /// Factors the matrix as its blocks are now.
  Outcome factor(const std::stop_token& stop);
  /// Replaces b [3 part + axis] by the solution of matrix * y = b with the last factor.
  void solve(Eigen::VectorXd& b) const;

 private:
  /// A group of the dissection: its own columns, and the rows below them.
  struct Front {
    std::uint32_t begin = 0, end = 0;   ///< its own places
    std::vector<std::uint32_t> below;   ///< places of the rows below, rising
    std::vector<std::size_t> children;  ///< fronts whose update it takes up
    Eigen::MatrixXd panel;              ///< the factor's columns
  };

  void list_blocks(const std::vector<std::vector<std::uint32_t>>& neighbours);
  void list_rows();
  void gather(const Front& front, const std::vector<Eigen::MatrixXd>& updates, Eigen::MatrixXd& dense);

  std::vector<std::uint32_t> place_;     ///< [part]
  std::vector<std::size_t> first_;       ///< [place + 1] its column's first block; the first is its own
  std::vector<std::uint32_t> row_;       ///< [block] the place of its row
  std::vector<Eigen::Matrix3d> blocks_;  ///< [block]
  std::vector<Front> fronts_;            ///< each after its children
  std::vector<std::uint32_t> local_;     ///< [place] row in the front that is gathered
};

}  // namespace clothlab::reference
