#include "server/sim/last_good.h"

#include <algorithm>
#include <glm/vec4.hpp>
#include <iterator>
#include <utility>

namespace clothlab::sim {

LastGood::LastGood(std::uint32_t vertex_count) : bytes_(vertex_count * sizeof(glm::vec4)) {
  good_ = {gl::Buffer(bytes_), gl::Buffer(bytes_), {}};
}

void LastGood::put_aside(const StateBuffers& state, double time, std::uint64_t step) {
  Copy copy;
  if (free_.empty()) {
    copy = {gl::Buffer(bytes_), gl::Buffer(bytes_), {}};
  } else {
    copy = std::move(free_.back());
    free_.pop_back();
  }
  state.save(copy.position, copy.velocity);
  copy.when = {time, step};
  aside_.push_back(std::move(copy));
}

void LastGood::keep(std::uint64_t step) {
  for (std::size_t k = aside_.size(); k-- > 0;) {  // the newest, should there be two
    if (aside_[k].when.step != step) continue;
    std::swap(aside_[k], good_);
    return;
  }
}

void LastGood::free_before(std::uint64_t step) {
  const auto first = std::stable_partition(aside_.begin(), aside_.end(),
                                           [&](const Copy& copy) { return copy.when.step >= step; });
  std::move(first, aside_.end(), std::back_inserter(free_));
  aside_.erase(first, aside_.end());
}

LastGood::When LastGood::restore(StateBuffers& state) {
  std::move(aside_.begin(), aside_.end(), std::back_inserter(free_));
  aside_.clear();
  state.load(good_.position, good_.velocity);
  return good_.when;
}

}  // namespace clothlab::sim
