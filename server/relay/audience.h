// Who watches a session through relays, and which frames are due for them. Pure arithmetic: the caller passes
// the time `now` [us].
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "server/relay/wire.h"

namespace clothlab::relay {

class Audience {
 public:
  /// Takes in a relay's want. Returns the forms that this relay did not want before: it needs a frame of each
  /// at once.
  std::array<bool, form_count> heard(const Want& want, std::int64_t now);
  /// Forgets relays whose lease has ended. True: some were.
  bool forget_silent(std::int64_t now);

  bool empty() const { return relays_.empty(); }
  /// Of all relays; one that wants frames and tells of no viewer counts as one.
  int viewers() const;
  const Rates& rates() const { return rates_; }

  /// True once for each frame of this form that is to be sent: it is another one than the last, and the rate
  /// allows it. Frames that are not due are not lost: asked again later, the newest one is.
  bool due(stream::Form form, std::uint32_t sequence, std::int64_t now);

 private:
  struct Relay {
    Rates rates{};
    int viewers = 0;
    std::int64_t until = 0;
  };
  struct Lane {
    bool sent_any = false;
    std::uint32_t last = 0;
    std::int64_t next = 0;
  };
  void sum_up();

  std::map<std::string, Relay> relays_;
  Rates rates_{};
  std::array<Lane, form_count> lanes_{};
};

}  // namespace clothlab::relay
