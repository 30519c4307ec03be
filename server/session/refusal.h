// Why a session refuses a command, and what to do about it. Each protocol turns a refusal into its own error
// codes.
#pragma once

#include <cstdint>
#include <string>
#include <utility>

#include "server/base/result.h"

namespace clothlab::session {

struct Refusal {
  enum class Reason {
    invalid_value,   ///< `error`: where (a JSON Pointer), what was found there, and what is allowed
    other_revision,  ///< the request was made for another revision of the scene than `revision`
    over_limit,      ///< `error` says of what there is too much
    nothing_there,   ///< there is nothing to undo or redo
    given_up,        ///< the change was given up while it was built; `error` says why
    diverged,        ///< the simulation has blown up, and waits for a change
    failed           ///< the session could not do it; `error` says why
  };
  Reason reason = Reason::failed;
  Error error;
  std::uint64_t revision = 0;  ///< the scene's present revision; for `other_revision` only
};

inline Refusal invalid_value(Error error) {
  return {Refusal::Reason::invalid_value, std::move(error)};
}

/// A number that counts one of `count` things, and none of them. `allowed`: e.g. "a cloth of the scene:
/// cloth".
inline Refusal no_such(std::string where, std::uint32_t number, const std::string& allowed,
                       std::size_t count) {
  return invalid_value(
      {std::move(where), std::to_string(number), allowed + " 0 to " + std::to_string(count - 1)});
}

}  // namespace clothlab::session
