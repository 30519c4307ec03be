// The lab's queue and its worker, with jobs made for the test instead of measurements.
#pragma once

#include <algorithm>
#include <atomic>
#include <map>
#include <stdexcept>
#include <thread>

#include "server/net/lab_queue.h"
#include "server/net/limits.h"
#include "tests/catch.h"

namespace clothlab::test {

using net::json;
using net::LabQueue;
using session::now_us;

struct Message {
  std::uint64_t client = 0;
  std::string method;
  json params;
  std::int64_t at = 0;  ///< the queue's time when it was sent [us]
};

/// Made-up jobs of a test; they check their stop token every millisecond.
struct Jobs {
  std::atomic<bool> may_end{false};
  std::atomic<int> started{0}, ended{0}, opened{0};
  std::atomic<int> reports{0};  ///< partial results and progress messages so far, of all jobs
  std::atomic<bool> fails_to_open{false}, throws{false}, talks{false}, hands_over{false};

  Result<lab::Outcome> run(const lab::Job& job, const lab::Control<lab::Outcome>& control) {
    ++started;
    if (throws) throw std::runtime_error("the job fell over");
    while (!may_end && !control.stop.stop_requested()) {
      if (talks) report(control);
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    ++ended;
    const bool complete = !control.stop.stop_requested();
    if (!complete && !hands_over) return lab::cancelled;
    if (std::holds_alternative<lab::ChooseRequest>(job)) return lab::Outcome(choice(job));
    return lab::Outcome(chart(complete));
  }

 private:
  static lab::Chart chart(bool complete) {
    lab::Chart chart;
    chart.complete = complete;
    return chart;
  }
  static lab::Choice choice(const lab::Job& job) {
    lab::Choice choice;
    choice.tolerance = std::get<lab::ChooseRequest>(job).tolerance;
    return choice;
  }
  void report(const lab::Control<lab::Outcome>& control) {
    ++reports;
    control.progress({0.001 * reports, 1, "report " + std::to_string(reports.load())});
    control.arrived(chart(false));
  }
};

/// The seed scene with one assignment.
inline scene::Document seed_with(const std::string& assignment) {
  Result<scene::Document> document = scene::set_value(*scene::load_preset("seed"), assignment);
  REQUIRE(document);
  return *document;
}

struct Lab {
  Jobs jobs;
  std::vector<Message> messages;
  std::int64_t now = now_us();          ///< the time of the last pump [us]
  std::map<std::string, json> answers;  ///< by the id of the request
  std::vector<std::uint64_t> holds;
  int releases = 0;
  std::optional<lab::Outcome> known;
  std::vector<std::pair<std::string, Result<lab::Choice>>> chosen;  ///< for sessions whose method is auto
  std::uint64_t steps = 0;
  net::SharedDocument seed = std::make_shared<const scene::Document>(*scene::load_preset("seed"));
  LabQueue queue{port(),
                 [this]() -> Result<net::LabWorker::Run> {
                   ++jobs.opened;
                   if (jobs.fails_to_open) return Error{"OpenGL", "nothing there", "install it"};
                   return net::LabWorker::Run(
                       [this](const scene::Document&, const lab::Job& job,
                              const lab::Control<lab::Outcome>& control) { return jobs.run(job, control); });
                 },
                 net::Limits().lab_seconds};

  LabQueue::Port port() {
    return {.notify =
                [this](std::uint64_t client, const char* method, const json& params) {
                  messages.push_back({client, method, params, now});
                },
            .answer = [this](const session::Ticket& ticket,
                             const json& answer) { answers[ticket.id->get<std::string>()] = answer; },
            .hold = [this](const std::string&, std::uint64_t job) { holds.push_back(job); },
            .release = [this](const std::string&) { ++releases; },
            .steps = [this] { return steps; },
            .known = [this](const scene::Document&, const lab::Job&) { return known; },
            .keep = [this](const scene::Document&, const lab::Job&,
                           const lab::Outcome& outcome) { known = outcome; },
            .chosen = [this](const std::string& session, const net::SharedDocument&,
                             const Result<lab::Choice>& choice) { chosen.emplace_back(session, choice); },
            .wake = [] {}};
  }

  /// Asks for a job, as a session that answers at once.
  std::uint64_t ask(std::uint64_t client, lab::Job job = lab::ChartRequest{}, net::LabWishes wishes = {},
                    const std::string& request = "request") {
    const auto admitted = queue.admit({client, json(request)}, "main", std::move(job), wishes);
    REQUIRE(std::holds_alternative<std::uint64_t>(admitted));
    const std::uint64_t id = std::get<std::uint64_t>(admitted);
    queue.scene_taken(id, seed, 1);
    return id;
  }

  /// Asks for a choice, as a session whose scene is the seed with this assignment and the method auto.
  void choose_for(const std::string& session, const std::string& assignment) {
    queue.choose_for(session, std::make_shared<const scene::Document>(seed_with(assignment)));
  }

  void pump(std::int64_t time) {
    now = time;
    queue.pump(now);
  }
  template <class Predicate>
  bool until(Predicate predicate) {
    for (const std::int64_t end = now_us() + 10'000'000; now_us() < end;) {
      pump(now_us());
      if (predicate()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return false;
  }
  std::string state(std::uint64_t client, std::uint64_t job) const {
    for (const json& item : queue.jobs(client))
      if (item["job"] == job) return item["state"];
    return "unknown";
  }
  bool reaches(std::uint64_t client, std::uint64_t job, const std::string& wanted) {
    return until([&] { return state(client, job) == wanted; });
  }
  std::vector<Message> sent(const std::string& method, std::uint64_t job) const {
    std::vector<Message> found;
    for (const Message& message : messages)
      if (message.method == method && message.params["job"] == job) found.push_back(message);
    return found;
  }
  json last_result(std::uint64_t job) const {
    const std::vector<Message> results = sent("lab.result", job);
    return results.empty() ? json() : results.back().params;
  }
};

}  // namespace clothlab::test
