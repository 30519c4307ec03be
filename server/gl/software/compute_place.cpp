#include <algorithm>
#include <array>
#include <mutex>
#include <utility>

#include "server/gl/software/displays.h"

namespace clothlab::gl {

namespace {

/// The part of one core's time that a scene in real time takes, by the estimate, above which it moves to the
/// helper threads and below which it comes back. Estimates are right within a factor of about two.
constexpr double to_leave = 0.8, to_return = 0.4;

constexpr std::array without_helpers{HelperThreads::none, HelperThreads::none_too};

/// The parts of a core's time that the scenes of each display take together, in the whole process.
std::mutex claims;
std::array<double, 4> claimed{};  // for each HelperThreads

double& claimed_on(HelperThreads threads) {
  return claimed[static_cast<std::size_t>(threads)];
}

void add(HelperThreads threads, double share) {
  claimed_on(threads) = std::max(0.0, claimed_on(threads) + share);
}

HelperThreads best_for(double share) {
  if (share > to_leave) return HelperThreads::sessions;
  return *std::min_element(without_helpers.begin(), without_helpers.end(),
                           [](auto one, auto other) { return claimed_on(one) < claimed_on(other); });
}

}  // namespace

ComputePlace::ComputePlace(HelperThreads threads, double share) : threads_(threads), share_(share) {
  add(threads, share);
}

ComputePlace::ComputePlace(ComputePlace&& other) noexcept
    : threads_(other.threads_), share_(std::exchange(other.share_, 0.0)) {}

ComputePlace& ComputePlace::operator=(ComputePlace&& other) noexcept {
  std::swap(threads_, other.threads_);
  std::swap(share_, other.share_);
  return *this;
}

ComputePlace::~ComputePlace() {
  const std::lock_guard lock(claims);
  add(threads_, -share_);
}

ComputePlace ComputePlace::claim(double share) {
  software::check_software("a place to compute");
  const std::lock_guard lock(claims);
  return {best_for(share), share};
}

bool ComputePlace::stays(double share) {
  const std::lock_guard lock(claims);
  if (threads_ == HelperThreads::sessions ? share <= to_return : share > to_leave) return false;
  add(threads_, share - share_);
  share_ = share;
  return true;
}

}  // namespace clothlab::gl
