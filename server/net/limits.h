// The bounds that keep one client from costing the others anything, those of its session aside. `hello`
// announces the ones a client can meet.
#pragma once

#include <cstddef>
#include <cstdint>

#include "server/scene/document.h"
#include "server/scene/ranges.h"
#include "server/session/limits.h"

namespace clothlab::net {

/// What whoever starts the server may set: one flag of `clothlab serve` each.
struct Limits {
  int sessions = 8;
  int clients = 64;                                             ///< WebSocket connections; beyond: 503
  int clients_per_address = 32;                                 ///< of them; as many again for plain HTTP
  int message_bytes = static_cast<int>(scene::max_json_bytes);  ///< larger: closed with 1009
  int message_rate = 2000;  ///< messages a second, twice that in a burst; beyond: a flood, closed with 1008
  int json_depth = static_cast<int>(scene::max_json_depth);
  session::Limits scene;
  int lab_seconds = 1800;   ///< a job may take; beyond: it fails
  int header_seconds = 10;  ///< from connecting to the end of the request's headers, TLS included
  int auth_seconds = 5;     ///< a client without a role is closed with 1008 after this
  int wrong_tokens = 10;    ///< a minute from one address, as many at once; beyond: none is looked at
  int idle_seconds = 60;    ///< a connection that says nothing, not even pong, is closed after this
};

/// A message counts once for each of these begun.
inline constexpr int message_unit_bytes = 256;
/// Messages that may come at once.
inline int burst_of(const Limits& limits) {
  return 2 * limits.message_rate;
}

inline constexpr int max_unadmitted_bytes = 4096;  ///< of a message before its sender has a role
inline constexpr std::size_t max_unsent_text_bytes =
    4 * 1024 * 1024;                                     ///< control text a client may let pile up
inline constexpr double min_rate = 0.1, max_rate = 120;  ///< frames a second a viewer may ask for
inline constexpr int max_in_flight = 8;                  ///< unacknowledged frames a viewer may ask for
inline constexpr std::int64_t max_steps = 1'000'000;     ///< of one sim.step
inline constexpr int max_lab_jobs = 8, max_lab_jobs_a_client = 2;   ///< that wait; beyond: -32002
inline constexpr int max_lab_outcomes_a_client = 8;                 ///< kept for lab.export, the newest
inline constexpr double min_lab_time = 0.01, max_lab_time = 60;     ///< simulated by a job [s]
inline constexpr double min_lab_budget = 1, max_lab_budget = 1200;  ///< of a chart [s]
inline constexpr int max_snapshot_side = 4096;                      ///< [pixels]
inline constexpr std::size_t max_exports = 8;  ///< pictures and meshes that wait or are made; beyond: 503
/// Unsent bytes the kernel may hold for a client: what lies there can no longer be replaced by something
/// newer.
inline constexpr int unsent_kernel_bytes = 64 * 1024;

// Close codes of RFC 6455.
inline constexpr int close_protocol = 1002, close_policy = 1008, close_too_big = 1009, close_internal = 1011;

}  // namespace clothlab::net
