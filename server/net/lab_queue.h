// The lab's jobs in the order in which they were asked for, from the request to the last word about them.
// Only the service thread touches it; the jobs themselves run on the LabWorker's, one after another.
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
  /// What the queue needs of the server around it.
  struct Port {
    /// A message to a client, who may be gone.
    std::function<void(std::uint64_t client, const char* method, const json& params)> notify;
    std::function<void(const session::Ticket& ticket, json answer)> answer;
    /// Pauses a session if it plays; it answers with `held`.
    std::function<void(const std::string& session, std::uint64_t job)> hold;
    /// Lets it play on, if it was paused by `hold` and nobody has played, paused or stepped it since.
    std::function<void(const std::string& session)> release;
    /// Steps of all sessions so far: whether anything ran beside a job.
    std::function<std::uint64_t()> steps;
    /// What such a job found before, if that is known; and for the next one what it found with nothing
    /// stepping beside it.
    std::function<std::optional<lab::Outcome>(const scene::Document&, const lab::Job&)> known;
    std::function<void(const scene::Document&, const lab::Job&, const lab::Outcome&)> keep;
    /// What has come of `choose_for`.
    std::function<void(const std::string& session, SharedDocument measured, Result<lab::Choice> choice)>
        chosen;
    /// Calls `pump` soon.
    std::function<void()> wake;
  };
  /// A job that takes longer than `most_seconds` is stopped, and fails.
  LabQueue(Port port, LabWorker::Open open, int most_seconds);

  /// A job and the ticket to answer, or why not: too many wait. The caller then makes sure that `scene_taken`
  /// comes, or calls `withdraw`.
  std::variant<std::uint64_t, RpcError> admit(const session::Ticket& ticket, std::string session,
                                              lab::Job job, LabWishes wishes);
  void withdraw(std::uint64_t job) { entries_.erase(job); }
  /// A choice for a session whose scene has the method `auto`; an earlier one that has not ended is dropped.
  void choose_for(const std::string& session, SharedDocument document);
  /// The session is no more: what is to be chosen for it is dropped.
  void session_left(const std::string& session);
  /// What the asker saw when asking: the job is answered, and waits for its turn.
  void scene_taken(std::uint64_t job, SharedDocument document, std::uint64_t revision);
  /// Whether the session's jobs are of its present scene.
  void scene_changed(const std::string& session, const scene::Document& present);
  /// It was brought back after it failed: whoever waits for it to stand still need not.
  void session_replaced(const std::string& session);
  /// The session stands still now.
  void held(std::uint64_t job);

  /// A session plays and reaches `share` of the speed it should have: if its own job keeps it below 50 of 60
  /// frames, whoever asked for that is told once, and what can be done.
  void session_reaches(const std::string& session, double share, std::int64_t now);

  /// False: it had ended before; an error where the client has no such job.
  std::variant<bool, RpcError> cancel(std::uint64_t client, std::uint64_t job);
  /// The client's own, oldest first.
  json jobs(std::uint64_t client) const;
  /// What there is of a job so far, null where there is nothing; an error where the client has no such job.
  std::variant<SharedOutcome, RpcError> outcome(std::uint64_t client, std::uint64_t job) const;
  /// Its jobs end and are forgotten.
  void client_left(std::uint64_t client);

  /// Takes in what the worker has put out, tells who asked, and starts what is next. Now and then as `now`
  /// [us] passes: at least ten times a second while a job runs.
  void pump(std::int64_t now);

  /// Ends all jobs and waits for the one that runs; nothing may be asked of the queue after it.
  void stop();

  LabGauges gauges() const;

  static constexpr std::int64_t progress_period = 200'000, result_period = 500'000;  ///< [us] at least
  static constexpr double least_share = 50.0 / 60;
  static constexpr std::int64_t slow_before_said = 1'500'000;  ///< [us]

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
  void tell(LabEntry& entry, std::int64_t now);
  void send_result(LabEntry& entry, std::int64_t now);
  void forget_oldest(std::uint64_t client);

  Port port_;
  int most_seconds_;
  std::unique_ptr<LabWorker> worker_;
  std::map<std::uint64_t, LabEntry> entries_;  ///< by id, and so in the order in which they were asked for
  std::uint64_t last_id_ = 0;
  std::uint64_t current_ = 0;  ///< the job that has its turn (holding or running); 0: none
  std::uint64_t steps_seen_ = 0;
  LabGauges totals_;
};

}  // namespace clothlab::net
