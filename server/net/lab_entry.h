// One job of the lab in the server's queue: its state, the scene it measures, and the messages about it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "server/net/json_rpc.h"
#include "server/net/lab_worker.h"
#include "server/session/exchange.h"

namespace clothlab::net {

struct LabWishes {
  bool pause = false;  ///< pause the session while the job runs
  bool fresh = false;  ///< measure again, even if the cache has the result
};

struct LabEntry {
  /// asked: the session has not handed over its scene yet; holding: the job waits for the session to pause.
  enum class State { asked, queued, holding, running, finished, cancelled, failed };

  std::uint64_t id = 0;
  session::Ticket ticket;  ///< asker 0: the client has left, or the session asked
  bool for_auto = false;   ///< the session itself asked, as its method is `auto`
  std::string session;
  lab::Job job;
  LabWishes wishes;
  State state = State::asked;
  SharedDocument document;
  std::uint64_t revision = 0;
  bool cached = false, stale = false, cancelling = false, overdue = false;
  bool disturbed = false;  ///< a session stepped while the job ran, so its times may be too long
  int ahead = 0;           ///< jobs before this one in the queue, the running one included
  lab::Progress progress;
  SharedOutcome outcome;  ///< the results so far; null: none yet
  std::optional<Error> error;
  std::int64_t began = 0, slow_since = 0;  ///< [us]; 0: it has not begun, or is not slow
  bool slow_notice_sent = false;
  bool progress_due = false, result_due = false;
  std::int64_t progress_sent = 0, result_sent = 0;  ///< [us]

  bool ended() const { return state >= State::finished; }
  bool waits() const { return state < State::running; }
  /// True if the job might give another result for the scene `present`.
  bool stale_if(const scene::Scene& present) const;

  /// The job's row in the answer to lab.jobs.
  json summary() const;
  /// The parameters of lab.progress and of lab.result for this job.
  json progress_message() const, result_message() const;
  /// Logs the end of the job, which ran for `seconds` [s].
  void log_end(double seconds) const;
};

/// The state's name for clients: every state before `running` is "queued".
const char* name(LabEntry::State state);

}  // namespace clothlab::net
