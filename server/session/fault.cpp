#include "server/session/fault.h"

#include <array>
#include <atomic>
#include <charconv>
#include <cstdlib>
#include <new>
#include <stdexcept>

namespace clothlab::session {

namespace {

constexpr std::array<const char*, 4> names{"exception", "no-memory", "change-fails", "context-lost"};

struct Plan {
  std::string kind, session;
  std::uint64_t steps = 0;
};

/// The fault in CLOTHLAB_FAULT, "KIND:SESSION:STEPS"; no fault if it is not set or not of this form.
Plan plan() {
  const char* text = std::getenv("CLOTHLAB_FAULT");
  if (!text) return {};
  const std::string all = text;
  const std::size_t first = all.find(':'), second = all.find(':', first + 1);
  if (first == std::string::npos || second == std::string::npos) return {};
  Plan plan{all.substr(0, first), all.substr(first + 1, second - first - 1), 0};
  std::from_chars(all.data() + second + 1, all.data() + all.size(), plan.steps);
  return plan;
}

}  // namespace

bool fault_due(Fault fault, const std::string& session, std::uint64_t steps) {
  static const Plan planned = plan();
  static std::atomic<bool> met{false};
  return planned.kind == names[static_cast<std::size_t>(fault)] && planned.session == session &&
         steps >= planned.steps && !met.exchange(true);
}

void provoke_fault(const std::string& session, std::uint64_t steps) {
  if (fault_due(Fault::exception, session, steps)) throw std::runtime_error("a fault on purpose");
  if (fault_due(Fault::no_memory, session, steps)) throw std::bad_alloc();
}

}  // namespace clothlab::session
