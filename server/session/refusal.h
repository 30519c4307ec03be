// Why a session does not do what it was asked for, and what to do about it. Each protocol has codes of its
// own for that.
#pragma once

#include <cstdint>
#include <utility>

#include "server/base/result.h"

namespace clothlab::session {

struct Refusal {
  enum class Reason {
    invalid_value,   ///< `error.where` is a JSON Pointer, and the rest says what was found there and what is
                     ///< allowed
    other_revision,  ///< the request was made for another revision of the scene than `revision`
    diverged,        ///< the simulation has blown up, and waits for a change
    failed           ///< the session could not do it
  };
  Reason reason = Reason::failed;
  Error error;
  std::uint64_t revision = 0;  ///< the scene's, where that is the reason
};

inline Refusal invalid_value(Error error) {
  return {Refusal::Reason::invalid_value, std::move(error)};
}

}  // namespace clothlab::session
