#include "server/reference/block_factor.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <numeric>
#include <span>

namespace clothlab::reference {

namespace {

using Eigen::Index;

/// Sorts the parts so that either half of them, of any half, lies together: they are halved across the
/// longest extent of their places.
void sort_by_place(std::span<std::uint32_t> parts, const Vectors& places) {
  if (parts.size() < 2) return;
  glm::dvec3 low = places[parts[0]], high = low;
  for (const std::uint32_t part : parts) {
    low = glm::min(low, places[part]);
    high = glm::max(high, places[part]);
  }
  const glm::dvec3 extent = high - low;
  const int axis = extent.x >= std::max(extent.y, extent.z) ? 0 : extent.y >= extent.z ? 1 : 2;
  const std::size_t half = parts.size() / 2;
  const auto before = [&](std::uint32_t a, std::uint32_t b) {
    return places[a][axis] < places[b][axis] || (places[a][axis] == places[b][axis] && a < b);
  };
  std::nth_element(parts.begin(), parts.begin() + static_cast<std::ptrdiff_t>(half), parts.end(), before);
  sort_by_place(parts.first(half), places);
  sort_by_place(parts.subspan(half), places);
}

}  // namespace

BlockFactor::BlockFactor(const std::vector<std::vector<std::uint32_t>>& neighbours, const Vectors& places) {
  const std::size_t count = neighbours.size();
  std::vector<std::uint32_t> sorted(count), number(count);
  std::iota(sorted.begin(), sorted.end(), 0);
  sort_by_place(sorted, places);
  for (std::uint32_t k = 0; k < count; ++k) number[sorted[k]] = k;
  std::vector<std::vector<std::uint32_t>> renumbered(count);
  for (std::size_t part = 0; part < count; ++part)
    for (const std::uint32_t other : neighbours[part]) renumbered[number[part]].push_back(number[other]);
  const model::Dissection dissection = model::dissect(renumbered);
  place_.resize(count);
  for (std::size_t part = 0; part < count; ++part) place_[part] = dissection.places[number[part]];
  for (std::size_t k = 0; k < dissection.groups.size(); ++k) {
    const model::Dissection::Group& group = dissection.groups[k];
    fronts_.push_back({group.begin, group.end, {}, {}, {}});
    if (group.parent >= 0) fronts_[k].children.reserve(2);
  }
  for (std::size_t k = 0; k < fronts_.size(); ++k)
    if (dissection.groups[k].parent >= 0)
      fronts_[static_cast<std::size_t>(dissection.groups[k].parent)].children.push_back(k);
  list_blocks(neighbours);
  list_rows();
}

void BlockFactor::list_blocks(const std::vector<std::vector<std::uint32_t>>& neighbours) {
  std::vector<std::vector<std::uint32_t>> columns(neighbours.size());
  for (std::size_t part = 0; part < neighbours.size(); ++part) {
    std::vector<std::uint32_t>& column = columns[place_[part]];
    column.push_back(place_[part]);
    for (const std::uint32_t other : neighbours[part])
      if (place_[other] > place_[part]) column.push_back(place_[other]);
    std::sort(column.begin(), column.end());
  }
  first_.push_back(0);
  for (const std::vector<std::uint32_t>& column : columns) {
    row_.insert(row_.end(), column.begin(), column.end());
    first_.push_back(row_.size());
  }
  blocks_.resize(row_.size());
  clear();
}

void BlockFactor::list_rows() {
  local_.assign(place_.size(), 0);
  for (Front& front : fronts_) {
    std::vector<std::uint32_t>& below = front.below;
    for (std::size_t k = first_[front.begin]; k < first_[front.end]; ++k) below.push_back(row_[k]);
    for (const std::size_t child : front.children)
      below.insert(below.end(), fronts_[child].below.begin(), fronts_[child].below.end());
    std::sort(below.begin(), below.end());
    below.erase(std::unique(below.begin(), below.end()), below.end());
    std::erase_if(below, [&](std::uint32_t place) { return place < front.end; });
  }
}

BlockFactor::Slot BlockFactor::slot(std::uint32_t row, std::uint32_t column) const {
  const std::uint32_t low = std::min(place_[row], place_[column]),
                      high = std::max(place_[row], place_[column]);
  const auto begin = row_.begin() + static_cast<std::ptrdiff_t>(first_[low]),
             end = row_.begin() + static_cast<std::ptrdiff_t>(first_[low + 1]);
  const auto found = std::lower_bound(begin, end, high);
  return {static_cast<std::size_t>(found - row_.begin()), place_[row] < place_[column]};
}

void BlockFactor::clear() {
  std::fill(blocks_.begin(), blocks_.end(), Eigen::Matrix3d(Eigen::Matrix3d::Zero()));
}

void BlockFactor::gather(const Front& front, const std::vector<Eigen::MatrixXd>& updates,
                         Eigen::MatrixXd& dense) {
  const std::uint32_t own = front.end - front.begin;
  for (std::uint32_t place = front.begin; place < front.end; ++place) local_[place] = place - front.begin;
  for (std::size_t k = 0; k < front.below.size(); ++k)
    local_[front.below[k]] = own + static_cast<std::uint32_t>(k);
  const auto size = static_cast<Index>(3 * (own + front.below.size()));
  dense.setZero(size, size);
  for (std::uint32_t column = front.begin; column < front.end; ++column)
    for (std::size_t k = first_[column]; k < first_[column + 1]; ++k)
      dense.block<3, 3>(3 * static_cast<Index>(local_[row_[k]]), 3 * static_cast<Index>(local_[column])) =
          blocks_[k];
  for (const std::size_t child : front.children) {
    const std::vector<std::uint32_t>& rows = fronts_[child].below;
    const Eigen::MatrixXd& update = updates[child];
    for (std::size_t column = 0; column < rows.size(); ++column)
      for (std::size_t row = column; row < rows.size(); ++row)
        dense.block<3, 3>(3 * static_cast<Index>(local_[rows[row]]),
                          3 * static_cast<Index>(local_[rows[column]])) +=
            update.block<3, 3>(3 * static_cast<Index>(row), 3 * static_cast<Index>(column));
  }
}

BlockFactor::Outcome BlockFactor::factor(const std::stop_token& stop) {
  std::vector<Eigen::MatrixXd> updates(fronts_.size());
  Eigen::MatrixXd dense;
  for (std::size_t number = 0; number < fronts_.size(); ++number) {
    if (stop.stop_requested()) return Outcome::stopped;
    Front& front = fronts_[number];
    gather(front, updates, dense);
    for (const std::size_t child : front.children) updates[child].resize(0, 0);
    const Index own = 3 * static_cast<Index>(front.end - front.begin), below = dense.rows() - own;
    Eigen::Ref<Eigen::MatrixXd> pivot = dense.topLeftCorner(own, own);
    const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factored(pivot);
    if (factored.info() != Eigen::Success) return Outcome::indefinite;
    if (below > 0) {
      auto side = dense.bottomLeftCorner(below, own);
      pivot.triangularView<Eigen::Lower>().transpose().solveInPlace<Eigen::OnTheRight>(side);
      auto rest = dense.bottomRightCorner(below, below);
      rest.selfadjointView<Eigen::Lower>().rankUpdate(side, -1.0);
      updates[number] = rest;
    }
    front.panel = dense.leftCols(own);
  }
  return Outcome::done;
}

void BlockFactor::solve(Eigen::VectorXd& b) const {
  Eigen::VectorXd y(b.size()), part;
  for (std::size_t i = 0; i < place_.size(); ++i)
    y.segment<3>(3 * static_cast<Index>(place_[i])) = b.segment<3>(3 * static_cast<Index>(i));
  for (const Front& front : fronts_) {
    const Index own = front.panel.cols(), below = front.panel.rows() - own;
    auto mine = y.segment(3 * static_cast<Index>(front.begin), own);
    front.panel.topRows(own).triangularView<Eigen::Lower>().solveInPlace(mine);
    part.noalias() = front.panel.bottomRows(below) * mine;
    for (std::size_t k = 0; k < front.below.size(); ++k)
      y.segment<3>(3 * static_cast<Index>(front.below[k])) -= part.segment<3>(3 * static_cast<Index>(k));
  }
  for (auto front = fronts_.rbegin(); front != fronts_.rend(); ++front) {
    const Index own = front->panel.cols(), below = front->panel.rows() - own;
    part.resize(below);
    for (std::size_t k = 0; k < front->below.size(); ++k)
      part.segment<3>(3 * static_cast<Index>(k)) = y.segment<3>(3 * static_cast<Index>(front->below[k]));
    auto mine = y.segment(3 * static_cast<Index>(front->begin), own);
    mine.noalias() -= front->panel.bottomRows(below).transpose() * part;
    front->panel.topRows(own).triangularView<Eigen::Lower>().transpose().solveInPlace(mine);
  }
  for (std::size_t i = 0; i < place_.size(); ++i)
    b.segment<3>(3 * static_cast<Index>(i)) = y.segment<3>(3 * static_cast<Index>(place_[i]));
}

}  // namespace clothlab::reference
