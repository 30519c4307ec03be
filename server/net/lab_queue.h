// The lab's jobs in the order of their requests, from the request to the last message about the job. Only the
// service thread touches the queue; the jobs run on the LabWorker's thread, one after another.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <variant>

#include "server/net/lab_entry.h"
#include "server/net/lab_worker.h"
#include "server/net/metrics.h"

namespace clothlab::net {

class LabQueue {
 public:
  /// The functions of the server that the queue calls.
  struct Port {
    /// Sends a notification to a client, if the client is still connected.
    std::function<void(std::uint64_t client, const char* method, const json& params)> notify;
    std::function<void(const session::Ticket& ticket, json answer)> answer;
    /// Pauses a session if it plays; then the server calls `LabQueue::held`.
    std::function<void(const std::string& session, std::uint64_t job)> hold;
    /// Lets a session play on that `hold` paused, unless a client has played, paused or stepped it since.
    std::function<void(const std::string& session)> release;
    /// The steps of all sessions so far, which show whether a session stepped while a job ran.
    std::function<std::uint64_t()> steps;
    /// `known` returns the cached result of such a job, if there is one. `keep` caches a result; it is only
    /// called if no session stepped while the job ran.
    std::function<std::optional<lab::Outcome>(const scene::Document&, const lab::Job&)> known;
    std::function<void(const scene::Document&, const lab::Job&, const lab::Outcome&)> keep;
    /// Gives a session the choice made by `choose_for` for the document `measured`, or the error.
    std::function<void(const std::string& session, SharedDocument measured, Result<lab::Choice> choice)>
        chosen;
    /// Makes the service thread call `pump` soon; any thread may call it.
    std::function<void()> wake;
  };
  /// A job that takes longer than `most_seconds` [s] is stopped, and fails.
  LabQueue(Port port, LabWorker::Open open, int most_seconds);

  /// Adds a job and returns its id, or an error if too many jobs wait. The caller must then get `scene_taken`
  /// called, which answers `ticket`, or call `withdraw`.
  std::variant<std::uint64_t, RpcError> admit(const session::Ticket& ticket, std::string session,
                                              lab::Job job, LabWishes wishes);
  void withdraw(std::uint64_t job) { entries_.erase(job); }
  /// Makes the lab choose a method for a session whose scene has the method `auto`. An earlier choice for the
  /// session that has not ended is dropped.
  void choose_for(const std::string& session, SharedDocument document);
  /// The session is closed: the choice that is being made for it is dropped.
  void session_left(const std::string& session);
  /// Gives a job the scene that its client saw when asking. The client is answered, and the job waits for its
  /// turn, unless the cache has its result.
  void scene_taken(std::uint64_t job, SharedDocument document, std::uint64_t revision);
  /// The session's scene is now `present`: updates which of the session's jobs are stale, of another scene.
  void scene_changed(const std::string& session, const scene::Document& present);
  /// The session was brought back after it failed: a job that waits for it to pause begins at once.
  void session_replaced(const std::string& session);
  /// The job's session stands still now, so the job begins.
  void held(std::uint64_t job);

  /// A session that plays reaches `share` of its set speed. If the running job was asked for in that session
  /// and `share` stays below `least_share` for `slow_notice_delay`, the job's client gets one notice.
  void speed_reported(const std::string& session, double share, std::int64_t now);

  /// Cancels a job. False: the job had ended before. Error: the client has no such job.
  std::variant<bool, RpcError> cancel(std::uint64_t client, std::uint64_t job);
  /// The client's own jobs, oldest first.
  json jobs(std::uint64_t client) const;
  /// The results of a job so far, null if there are none. Error: the client has no such job.
  std::variant<SharedOutcome, RpcError> outcome(std::uint64_t client, std::uint64_t job) const;
  /// The client has left or is no operator any more: its jobs end and are forgotten.
  void client_left(std::uint64_t client);

  /// Takes in what the worker has put out, tells the clients and starts the next job. To be called at least
  /// ten times a second while a job runs; `now` is the time [us].
  void pump(std::int64_t now);

  /// Ends all jobs and waits until the running one has stopped. No job may be added after it.
  void stop();

  LabGauges gauges() const;

  /// The least time between two lab.progress, and between two lab.result, of one job [us].
  static constexpr std::int64_t progress_period = 200'000, result_period = 500'000;
  static constexpr double least_share = 50.0 / 60;              ///< of a session's set speed
  static constexpr std::int64_t slow_notice_delay = 1'500'000;  ///< time until the notice [us]

 private:
  const LabEntry* find(std::uint64_t client, std::uint64_t job) const;
  void follow_running(std::int64_t now);
  void end_cancelled(std::int64_t now);
  void start_next(std::int64_t now);
  void begin(LabEntry& entry, std::int64_t now);
  bool answer_from_cache(LabEntry& entry);
  void finish(LabEntry& entry, Result<lab::Outcome> outcome, std::int64_t now);
  void close(LabEntry& entry, LabEntry::State state, std::int64_t now);
  void count_ahead();
  void send_due_messages(LabEntry& entry, std::int64_t now);
  void send_result(LabEntry& entry, std::int64_t now);
  void forget_oldest(std::uint64_t client);
  /// Makes room for the positions of another comparison: the client's earlier ones go, and the oldest of all.
  void forget_comparisons(std::uint64_t client);

  Port port_;
  int most_seconds_;
  std::unique_ptr<LabWorker> worker_;
  std::map<std::uint64_t, LabEntry> entries_;  ///< by id, which is the order of their requests
  std::uint64_t last_id_ = 0;
  std::uint64_t current_ = 0;  ///< the job that has its turn (holding or running); 0: none
  std::uint64_t steps_seen_ = 0;
  LabGauges totals_;
};

}  // namespace clothlab::net
