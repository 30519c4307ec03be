// Keeps an address from guessing tokens: it may send a number of wrong tokens a minute, and as many at once.
// Beyond that no token from the address is checked, right or wrong. Pure arithmetic: the caller passes the
// time `now` [us].
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>

#include "server/net/pacing.h"

namespace clothlab::net {

class TokenGuard {
 public:
  explicit TokenGuard(int wrong_a_minute) : wrong_a_minute_(wrong_a_minute) {}

  /// Seconds to wait before a token from this address is checked again, rounded up; 0: none.
  int wait(const std::string& address, std::int64_t now) const;
  /// Counts a token from this address that was checked and is wrong.
  void was_wrong(const std::string& address, std::int64_t now);
  /// Number of addresses remembered: an address is forgotten once it may send all its wrong tokens again.
  std::size_t count() const { return allowance_.size(); }

 private:
  double wrong_a_minute_;
  std::map<std::string, TokenBucket> allowance_;
  std::int64_t forget_at_ = 0;
};

/// The message that refuses a token without checking it; `seconds` is the time to wait.
std::string token_wait_message(int seconds);

}  // namespace clothlab::net
