// Keeps an address from guessing tokens: so many wrong ones a minute, and as many at once. Beyond that none
// of it is looked at, right or wrong. Pure arithmetic on given times [us].
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>

#include "server/net/pacing.h"

namespace clothlab::net {

class TokenGuard {
 public:
  explicit TokenGuard(int wrong_a_minute) : most_(wrong_a_minute) {}

  /// Until a token of this address is looked at [s], rounded up; 0: it is now.
  int wait(const std::string& address, std::int64_t now) const;
  /// One was looked at, and is wrong.
  void was_wrong(const std::string& address, std::int64_t now);
  /// Addresses it knows: those that may not yet send all their wrong ones at once again.
  std::size_t count() const { return left_.size(); }

 private:
  double most_;
  std::map<std::string, TokenBucket> left_;
  std::int64_t forget_at_ = 0;
};

/// What is said instead of looking at a token.
std::string not_looked_at(int seconds);

}  // namespace clothlab::net
