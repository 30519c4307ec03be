#include "server/session/compute_place.h"

#include <algorithm>
#include <array>
#include <mutex>
#include <utility>

#include "server/sim/cost.h"

namespace clothlab::session {

namespace {

using gl::HelperThreads;

/// The part of one core's time that a scene in real time takes, by the estimate, above which it moves to the
/// helper threads and below which it comes back. Estimates are right within a factor of about two.
constexpr double to_leave = 0.8, to_return = 0.4;

constexpr std::array without_helpers{HelperThreads::none, HelperThreads::none_too};

/// The parts of a core's time that the scenes of each display take together, in the whole process.
std::mutex mutex;
std::array<double, 4> claimed{};  // for each HelperThreads

double& claimed_on(HelperThreads threads) {
  return claimed[static_cast<std::size_t>(threads)];
}

void add(HelperThreads threads, double share) {
  claimed_on(threads) = std::max(0.0, claimed_on(threads) + share);
}

double share_of(const scene::Scene& scene) {
  return sim::expected_step_seconds(scene) / scene.solver.dt;
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
  const std::lock_guard lock(mutex);
  add(threads_, -share_);
}

ComputePlace ComputePlace::claim(const scene::Scene& scene) {
  const std::lock_guard lock(mutex);
  const double share = share_of(scene);
  return {best_for(share), share};
}

bool ComputePlace::stays(const scene::Scene& scene) {
  const std::lock_guard lock(mutex);
  const double share = share_of(scene);
  if (threads_ == HelperThreads::sessions ? share <= to_return : share > to_leave) return false;
  add(threads_, share - share_);
  share_ = share;
  return true;
}

}  // namespace clothlab::session
