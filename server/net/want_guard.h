// How many requests of relays a session answers: each relay's own, whatever others send. Pure arithmetic: the
// caller passes the time `now` [us].
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "server/net/pacing.h"

namespace clothlab::net {

class WantGuard {
 public:
  explicit WantGuard(std::int64_t now);
  /// True if a request that is to be answered at `reply` may be read. A relay asks once a second, and soon
  /// again when something changes; one that is not read comes again.
  bool take(const std::string& reply, std::int64_t now);
  /// True if so many bytes may be answered now.
  bool take_bytes(std::size_t bytes, std::int64_t now);

 private:
  struct Asker {
    TokenBucket requests;
    std::int64_t last;  ///< when the last one came [us]
  };
  std::map<std::string, Asker> askers_;
  TokenBucket strangers_, all_, kilobytes_;
  std::int64_t forget_at_;
};

}  // namespace clothlab::net
