// One job of the lab as its asker sees it: where it stands, of which scene it is, what is told about it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "server/net/json_rpc.h"
#include "server/net/lab_worker.h"
#include "server/session/exchange.h"

namespace clothlab::net {

struct LabWishes {
  bool pause = false;  ///< the session stands still while the job runs
  bool fresh = false;  ///< measured again, even if the outcome is known
};

struct LabEntry {
  /// asked: its session has not told the scene yet; holding: it waits for its session to stand still.
  enum class State { asked, queued, holding, running, finished, cancelled, failed };

  std::uint64_t id = 0;
  session::Ticket ticket;  ///< asker 0: has left, or nobody has asked
  bool for_auto = false;   ///< asked for by the session itself, whose method is `auto`
  std::string session;
  lab::Job job;
  LabWishes wishes;
  State state = State::asked;
  SharedDocument document;
  std::uint64_t revision = 0;
  bool cached = false, stale = false, cancelling = false, overdue = false;
  bool beside = false;  ///< something stepped while it ran
  int ahead = 0;        ///< jobs before it
  lab::Progress progress;
  SharedOutcome outcome;  ///< so far
  std::optional<Error> error;
  std::int64_t began = 0, slow_since = 0;  ///< [us]
  bool said_slow = false;
  bool progress_due = false, result_due = false;
  std::int64_t progress_sent = 0, result_sent = 0;  ///< [us]

  bool ended() const { return state >= State::finished; }
  bool waits() const { return state < State::running; }
  /// Whether the job would find something else if `present` were its scene.
  bool stale_if(const scene::Scene& present) const;

  /// As a row of lab.jobs.
  json summary() const;
  /// What lab.progress and lab.result say of it.
  json progress_message() const, result_message() const;
  /// What the log says of a job that has ended after so many seconds.
  void log_end(double seconds) const;
};

/// As clients are told it: what comes before running is all "queued" to them.
const char* name(LabEntry::State state);

}  // namespace clothlab::net
