// The limits that keep one client from slowing the clients of other sessions. `hello` announces those that a
// client can meet.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "server/scene/document.h"
#include "server/scene/ranges.h"
#include "server/session/limits.h"

namespace clothlab::net {

/// The limits that the flags of `clothlab serve` set, one flag each.
struct Limits {
  int sessions = 8;
  int clients = 64;                                             ///< WebSocket connections; beyond: 503
  int clients_per_address = 32;                                 ///< of these from one address; beyond: 503
  int message_bytes = static_cast<int>(scene::max_json_bytes);  ///< of one message; beyond: closed with 1009
  int message_rate = 2000;  ///< messages a second, twice that in a burst; beyond: closed with 1008
  int json_depth = static_cast<int>(scene::max_json_depth);
  session::Limits scene;
  int lab_seconds = 1800;   ///< time that a lab job may take [s]; beyond: it fails
  int header_seconds = 10;  ///< time from connecting to the end of the request's headers [s], TLS included
  int auth_seconds = 5;     ///< a client without a role is closed with 1008 after this time [s]
  int wrong_tokens = 10;    ///< a minute from one address, as many at once; beyond: no token is checked
  int idle_seconds = 60;    ///< a connection that sends nothing, not even pong, is closed after this [s]
};

/// A message counts once for each unit of this many bytes that it begins.
inline constexpr int message_unit_bytes = 256;
/// The number of messages that may come at once.
inline int burst_of(const Limits& limits) {
  return 2 * limits.message_rate;
}

/// A client that takes nothing of an answer, or asks for nothing more, for this long is closed [s].
inline int silence_seconds(const Limits& limits) {
  return std::min(30, limits.idle_seconds);
}

inline constexpr int max_unadmitted_bytes = 4096;  ///< of a message from a client without a role
inline constexpr std::size_t max_unsent_text_bytes =
    4 * 1024 * 1024;  ///< of text waiting for a client; beyond: 1008
inline constexpr std::size_t max_answers_ahead_bytes =
    256 * 1024;  ///< of that text; beyond: nothing is read from the client
/// A client's answers that it has not read count in the server's memory in units of this many bytes.
inline constexpr std::size_t unread_unit_bytes = 16 * 1024;
inline constexpr std::size_t most_whole_bytes = 256 * 1024;  ///< of a message that is written at once
inline constexpr std::size_t piece_bytes = 64 * 1024;        ///< of a longer one, written at a time
inline constexpr double min_rate = 0.1, max_rate = 120;      ///< frames a second a viewer may ask for
inline constexpr int max_in_flight = 8;                      ///< unacknowledged frames a viewer may ask for
inline constexpr std::int64_t max_steps = 1'000'000;         ///< steps of one sim.step
inline constexpr int max_hand = 9;                           ///< a client's hands are numbers from 0 to this
inline constexpr int max_lab_jobs = 8, max_lab_jobs_a_client = 2;   ///< waiting jobs; beyond: -32002
inline constexpr int max_lab_outcomes_a_client = 8;                 ///< newest results kept for lab.export
inline constexpr double min_lab_time = 0.01, max_lab_time = 60;     ///< time that a job simulates [s]
inline constexpr double min_lab_budget = 1, max_lab_budget = 1200;  ///< wall time for a chart [s]
inline constexpr int min_comparison_rate = 1, max_comparison_rate = 60;  ///< moments a simulated second
inline constexpr std::int64_t max_moment = 60 * 60;                      ///< number of the last one
inline constexpr std::size_t max_moments_bytes = 256 << 10;  ///< of positions in an answer of lab.moments
inline constexpr int max_comparisons = 4;  ///< of all clients whose positions are kept; one of each client
inline constexpr int max_snapshot_side = 4096;  ///< [pixels]
inline constexpr std::size_t max_exports = 8;   ///< pictures and meshes that wait or are made; beyond: 503
/// HTTP's patience with what is made for a request, beside others on a busy machine, and with who reads
/// nothing [s].
inline constexpr int making_patience = 120, http_patience = 30;
/// Unsent bytes that the kernel may hold for a client; few, because a newer frame can no longer replace a
/// frame among them.
inline constexpr int unsent_kernel_bytes = 64 * 1024;

// Close codes of RFC 6455.
inline constexpr int close_protocol = 1002, close_policy = 1008, close_too_big = 1009, close_internal = 1011;
// And of the registry of IANA.
inline constexpr int close_restart = 1012, close_try_again = 1013;

}  // namespace clothlab::net
