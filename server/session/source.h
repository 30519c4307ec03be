// What a room shows: a session that runs in this process, or one that a bus brings from another.
#pragma once

#include <functional>
#include <utility>

#include "server/session/exchange.h"

namespace clothlab::session {

class Source {
 public:
  /// `wake` is called after each new event or frame; it must not block.
  explicit Source(std::function<void()> wake) : exchange_(std::move(wake)) {}
  virtual ~Source() = default;
  Source(const Source&) = delete;
  Source& operator=(const Source&) = delete;

  Exchange& exchange() { return exchange_; }
  const Exchange& exchange() const { return exchange_; }
  /// False: what makes the events is stuck.
  virtual bool beats() const = 0;

 protected:
  Exchange exchange_;
};

}  // namespace clothlab::session
