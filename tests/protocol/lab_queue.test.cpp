// The lab's queue and its worker, with jobs made for the test instead of measurements.
#include "server/net/lab_queue.h"

#include <algorithm>
#include <atomic>
#include <map>
#include <stdexcept>
#include <thread>

#include "server/net/limits.h"
#include "tests/catch.h"

using namespace clothlab;
using net::json;
using net::LabQueue;
using net::now_us;

namespace {

struct Message {
  std::uint64_t client = 0;
  std::string method;
  json params;
  std::int64_t at = 0;
};

/// What the jobs of a test do; they look at their stop token every millisecond.
struct Jobs {
  std::atomic<bool> may_end{false};
  std::atomic<int> started{0}, ended{0}, opened{0};
  std::atomic<int> reports{0};  ///< partial results and progress so far, of all jobs
  std::atomic<bool> fails_to_open{false}, throws{false}, talks{false}, hands_over{false};

  Result<lab::Outcome> run(const lab::Control<lab::Outcome>& control) {
    ++started;
    if (throws) throw std::runtime_error("the job fell over");
    while (!may_end && !control.stop.stop_requested()) {
      if (talks) report(control);
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    ++ended;
    if (!control.stop.stop_requested()) return lab::Outcome(chart(true));
    if (hands_over) return lab::Outcome(chart(false));
    return lab::cancelled;
  }

 private:
  static lab::Chart chart(bool complete) {
    lab::Chart chart;
    chart.complete = complete;
    return chart;
  }
  void report(const lab::Control<lab::Outcome>& control) {
    ++reports;
    control.progress({0.001 * reports, 1, "report " + std::to_string(reports.load())});
    control.arrived(chart(false));
  }
};

struct Lab {
  Jobs jobs;
  std::vector<Message> messages;
  std::map<std::string, json> answers;  ///< by the request's id
  std::vector<std::uint64_t> holds;
  int releases = 0;
  std::optional<lab::Outcome> known;
  std::uint64_t steps = 0;
  net::SharedDocument seed = std::make_shared<const scene::Document>(*scene::load_preset("seed"));
  LabQueue queue{port(), [this]() -> Result<net::LabWorker::Run> {
                   ++jobs.opened;
                   if (jobs.fails_to_open) return Error{"OpenGL", "nothing there", "install it"};
                   return net::LabWorker::Run(
                       [this](const scene::Document&, const lab::Job&,
                              const lab::Control<lab::Outcome>& control) { return jobs.run(control); });
                 }};

  LabQueue::Port port() {
    return {.notify =
                [this](std::uint64_t client, const char* method, const json& params) {
                  messages.push_back({client, method, params, now_us()});
                },
            .answer = [this](const net::Ticket& ticket,
                             const json& answer) { answers[ticket.id->get<std::string>()] = answer; },
            .hold = [this](const std::string&, std::uint64_t job) { holds.push_back(job); },
            .release = [this](const std::string&) { ++releases; },
            .steps = [this] { return steps; },
            .known = [this](const scene::Document&, const lab::Job&) { return known; },
            .keep = [this](const scene::Document&, const lab::Job&,
                           const lab::Outcome& outcome) { known = outcome; },
            .chosen = {},
            .wake = [] {}};
  }

  /// As a session that answers at once.
  std::uint64_t ask(std::uint64_t client, lab::Job job = lab::ChartRequest{}, LabQueue::Wishes wishes = {},
                    const std::string& request = "request") {
    const auto admitted = queue.admit({client, json(request)}, "main", std::move(job), wishes);
    REQUIRE(std::holds_alternative<std::uint64_t>(admitted));
    const std::uint64_t id = std::get<std::uint64_t>(admitted);
    queue.scene_taken(id, seed, 1);
    return id;
  }

  template <class Predicate>
  bool until(Predicate predicate) {
    for (const std::int64_t end = now_us() + 10'000'000; now_us() < end;) {
      queue.pump(now_us());
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

/// The seed with one value of it changed.
scene::Document seed_with(const std::string& assignment) {
  Result<scene::Document> document = scene::set_value(*scene::load_preset("seed"), assignment);
  REQUIRE(document);
  return *document;
}

}  // namespace

TEST_CASE("jobs of the lab run one at a time as they were asked for, and those that wait hear how long") {
  Lab lab;
  const std::uint64_t first = lab.ask(1, lab::ChartRequest{}, {}, "a"),
                      second = lab.ask(2, lab::ChooseRequest{}, {}, "b"),
                      third = lab.ask(1, lab::MapRequest{}, {}, "c");
  CHECK(lab.answers["a"] == json{{"job", first}, {"ahead", 0}, {"cached", false}});
  CHECK(lab.answers["b"] == json{{"job", second}, {"ahead", 1}, {"cached", false}});
  CHECK(lab.answers["c"] == json{{"job", third}, {"ahead", 2}, {"cached", false}});
  REQUIRE(lab.reaches(1, first, "running"));
  REQUIRE(lab.until([&] { return lab.jobs.started == 1; }));
  CHECK(lab.state(2, second) == "queued");
  CHECK(lab.queue.gauges().queued == 2);
  CHECK(lab.queue.gauges().running == 1);
  CHECK(std::get<bool>(lab.queue.cancel(1, first)));
  REQUIRE(lab.reaches(2, second, "running"));
  CHECK(lab.state(1, third) == "queued");
  CHECK(lab.until([&] {
    const std::vector<Message> progress = lab.sent("lab.progress", third);
    return !progress.empty() && progress.back().params["ahead"] == 1;
  }));
  lab.jobs.may_end = true;
  REQUIRE(lab.reaches(1, third, "finished"));
  CHECK(lab.state(2, second) == "finished");
  CHECK(lab.last_result(second)["kind"] == "choose");
  CHECK(lab.jobs.opened == 1);
}

TEST_CASE(
    "a job that is cancelled, waiting or running, ends with a last result and makes room for the next") {
  Lab lab;
  const std::uint64_t runs = lab.ask(1), waits = lab.ask(1);
  REQUIRE(lab.until([&] { return lab.jobs.started == 1; }));
  CHECK(std::get<bool>(lab.queue.cancel(1, waits)));
  REQUIRE(lab.reaches(1, waits, "cancelled"));
  CHECK(lab.last_result(waits)["state"] == "cancelled");
  CHECK(lab.state(1, runs) == "running");
  CHECK(std::get<bool>(lab.queue.cancel(1, runs)));
  REQUIRE(lab.reaches(1, runs, "cancelled"));
  CHECK(lab.last_result(runs)["state"] == "cancelled");
  CHECK(lab.jobs.started == 1);  // the one that waited never ran
  CHECK_FALSE(std::get<bool>(lab.queue.cancel(1, runs)));
  lab.jobs.may_end = true;
  CHECK(lab.reaches(1, lab.ask(1), "finished"));
  CHECK(lab.queue.gauges().cancelled == 2);
}

TEST_CASE("a job that hands over what it has when it is stopped is cancelled all the same") {
  Lab lab;
  lab.jobs.hands_over = true;
  const std::uint64_t job = lab.ask(1);
  REQUIRE(lab.until([&] { return lab.jobs.started == 1; }));
  CHECK(std::get<bool>(lab.queue.cancel(1, job)));
  REQUIRE(lab.reaches(1, job, "cancelled"));
  CHECK_FALSE(lab.last_result(job)["result"].is_null());
}

TEST_CASE("a job belongs to who asked for it: others can neither cancel nor see nor export it") {
  Lab lab;
  const std::uint64_t job = lab.ask(1);
  CHECK(std::get<net::RpcError>(lab.queue.cancel(2, job)).code == net::error_invalid_params);
  CHECK(std::get<net::RpcError>(lab.queue.outcome(2, job)).code == net::error_invalid_params);
  CHECK(lab.queue.jobs(2).empty());
  CHECK(lab.queue.jobs(1).size() == 1);
}

TEST_CASE("only so many jobs may wait, of one client and of all") {
  Lab lab;
  lab.ask(1);
  REQUIRE(lab.until([&] { return lab.jobs.started == 1; }));
  const auto refused = [&](std::uint64_t client) {
    const auto admitted = lab.queue.admit({client, json("x")}, "main", lab::ChartRequest{}, {});
    const auto* error = std::get_if<net::RpcError>(&admitted);
    return error && error->code == net::error_over_limit;
  };
  for (int i = 0; i < net::max_lab_jobs_a_client; ++i) lab.ask(1);
  CHECK(refused(1));
  std::uint64_t client = 1;
  for (int waiting = net::max_lab_jobs_a_client; waiting < net::max_lab_jobs; ++waiting) lab.ask(++client);
  CHECK(refused(++client));
  lab.queue.client_left(1);
  CHECK_FALSE(refused(client));
}

TEST_CASE("a client that leaves leaves no job behind") {
  Lab lab;
  lab.ask(1);
  const std::uint64_t waits = lab.ask(1), other = lab.ask(2);
  REQUIRE(lab.until([&] { return lab.jobs.started == 1; }));
  const std::size_t before = lab.messages.size();
  lab.queue.client_left(1);
  REQUIRE(lab.until([&] { return lab.jobs.ended == 1; }));
  REQUIRE(lab.reaches(2, other, "running"));
  CHECK(lab.queue.jobs(1).empty());
  CHECK(lab.queue.gauges().queued == 0);
  CHECK(lab.sent("lab.result", waits).empty());
  for (std::size_t i = before; i < lab.messages.size(); ++i) CHECK(lab.messages[i].client == 2);
  lab.jobs.may_end = true;
  CHECK(lab.reaches(2, other, "finished"));
  CHECK(lab.jobs.started == 2);
}

TEST_CASE("a request whose asker leaves before its session has told the scene is forgotten") {
  Lab lab;
  const auto admitted = lab.queue.admit({1, json("x")}, "main", lab::ChartRequest{}, {});
  lab.queue.client_left(1);
  lab.queue.scene_taken(std::get<std::uint64_t>(admitted), lab.seed, 1);
  lab.queue.pump(now_us());
  CHECK(lab.answers.empty());
  CHECK(lab.jobs.started == 0);
}

TEST_CASE("a job is stale while what it measures is not what the scene is: its looks do not count") {
  Lab lab;
  const std::uint64_t chart = lab.ask(1), simplify = lab.ask(2, lab::SimplifyRequest{});
  const auto stale = [&](std::uint64_t client) { return lab.queue.jobs(client)[0]["stale"].get<bool>(); };
  lab.queue.scene_changed("main", seed_with("/cloths/0/color=\"#123456\""));
  CHECK_FALSE(stale(1));
  CHECK_FALSE(stale(2));
  lab.queue.scene_changed("main", seed_with("/solver/dt=0.0005"));
  CHECK_FALSE(stale(1));  // a chart goes through time steps of its own
  CHECK(stale(2));
  lab.queue.scene_changed("other", seed_with("/gravity/1=-1"));
  CHECK_FALSE(stale(1));
  lab.queue.scene_changed("main", seed_with("/gravity/1=-1"));
  CHECK(stale(1));
  REQUIRE(lab.until([&] { return !lab.sent("lab.progress", chart).empty(); }));
  CHECK(lab.sent("lab.progress", chart).back().params["stale"] == true);
  lab.queue.scene_changed("main", *lab.seed);
  CHECK_FALSE(stale(1));
  CHECK_FALSE(stale(2));
  lab.queue.scene_changed("main", seed_with("/gravity/1=-1"));
  lab.jobs.may_end = true;
  REQUIRE(lab.reaches(2, simplify, "finished"));
  CHECK(lab.last_result(simplify)["stale"] == true);
}

TEST_CASE(
    "a job that wants the session paused starts when it stands still, and lets it play on however it ends") {
  Lab lab;
  for (const bool cancel_held : {false, true}) {
    const std::uint64_t job = lab.ask(1, lab::ChartRequest{}, {true, false});
    REQUIRE(lab.until([&] { return !lab.holds.empty() && lab.holds.back() == job; }));
    const int before = lab.jobs.started;
    CHECK(lab.state(1, job) == "queued");
    if (!cancel_held) {
      lab.queue.held(job);
      REQUIRE(lab.until([&] { return lab.jobs.started == before + 1; }));
    }
    CHECK(lab.releases == (cancel_held ? 1 : 0));
    CHECK(std::get<bool>(lab.queue.cancel(1, job)));
    REQUIRE(lab.reaches(1, job, "cancelled"));
    lab.queue.held(job);  // the session's word may come late
    lab.queue.pump(now_us());
    CHECK(lab.jobs.started == (cancel_held ? before : before + 1));
    CHECK(lab.releases == (cancel_held ? 2 : 1));
  }
}

TEST_CASE("a result says whether anything was stepped beside its job") {
  for (const bool beside : {false, true}) {
    Lab lab;
    lab.steps = 100;
    const std::uint64_t job = lab.ask(1);
    REQUIRE(lab.until([&] { return lab.jobs.started == 1; }));
    if (beside) lab.steps += 1;
    lab.queue.pump(now_us());
    lab.jobs.may_end = true;
    REQUIRE(lab.reaches(1, job, "finished"));
    CHECK(lab.last_result(job)["beside"] == beside);
    CHECK(lab.known.has_value() == !beside);
  }
}

TEST_CASE("who asked for a job that slows the session below 50 of 60 frames is told so, once") {
  Lab lab;
  const std::uint64_t job = lab.ask(1);
  REQUIRE(lab.until([&] { return lab.jobs.started == 1; }));
  const auto notices = [&] {
    return std::count_if(lab.messages.begin(), lab.messages.end(),
                         [](const Message& message) { return message.method == "notice"; });
  };
  const auto reaches = [&](const char* session, double share, double seconds) {
    static std::int64_t now = now_us();
    for (int i = 0; i < 10 * seconds; ++i) lab.queue.session_reaches(session, share, now += 100'000);
  };
  reaches("main", 0.84, 10);
  reaches("other", 0.2, 10);
  reaches("main", 0.5, 1);  // a hiccup
  reaches("main", 0.9, 1);
  CHECK(notices() == 0);
  reaches("main", 0.5, 10);
  REQUIRE(notices() == 1);
  CHECK(lab.messages.back().params["text"].get<std::string>().find("50 %") != std::string::npos);
  CHECK(std::get<bool>(lab.queue.cancel(1, job)));
  REQUIRE(lab.reaches(1, job, "cancelled"));
  reaches("main", 0.5, 10);
  CHECK(notices() == 1);
}

TEST_CASE(
    "what was measured with nothing beside it answers the same request at once, unless it is to be fresh") {
  Lab lab;
  lab.jobs.may_end = true;
  REQUIRE(lab.reaches(1, lab.ask(1), "finished"));
  CHECK(lab.last_result(1)["cached"] == false);
  const std::uint64_t again = lab.ask(1, lab::ChartRequest{}, {}, "again");
  CHECK(lab.answers["again"] == json{{"job", again}, {"ahead", 0}, {"cached", true}});
  CHECK(lab.last_result(again)["state"] == "finished");
  CHECK(lab.last_result(again)["cached"] == true);
  CHECK(lab.jobs.started == 1);
  REQUIRE(lab.reaches(1, lab.ask(1, lab::ChartRequest{}, {false, true}), "finished"));
  CHECK(lab.jobs.started == 2);
}

TEST_CASE("a job that throws and a lab without OpenGL fail with the reason, and the lab lives on") {
  Lab lab;
  lab.jobs.fails_to_open = true;
  const std::uint64_t first = lab.ask(1);
  REQUIRE(lab.reaches(1, first, "failed"));
  CHECK(lab.last_result(first)["error"] ==
        json{{"path", "OpenGL"}, {"found", "nothing there"}, {"allowed", "install it"}});
  lab.jobs.fails_to_open = false;
  lab.jobs.throws = true;
  const std::uint64_t second = lab.ask(1);
  REQUIRE(lab.reaches(1, second, "failed"));
  CHECK(lab.last_result(second)["error"]["found"] == "the job fell over");
  lab.jobs.throws = false;
  lab.jobs.may_end = true;
  CHECK(lab.reaches(1, lab.ask(1), "finished"));
}

TEST_CASE(
    "however much a job reports, its asker hears of it at most 5 and 2 times a second, and the end at once") {
  Lab lab;
  lab.jobs.talks = true;
  const std::uint64_t job = lab.ask(1);
  const std::int64_t begun = now_us();
  REQUIRE(lab.until([&] { return now_us() - begun > 2'100'000; }));
  CHECK(lab.jobs.reports > 100);
  const auto paced = [&](const char* method, std::int64_t period) {
    const std::vector<Message> sent = lab.sent(method, job);
    for (std::size_t i = 1; i < sent.size(); ++i) CHECK(sent[i].at - sent[i - 1].at > period - 20'000);
    return sent.size();
  };
  CHECK(paced("lab.progress", LabQueue::progress_period) >= 5);
  CHECK(paced("lab.result", LabQueue::result_period) >= 3);
  CHECK(lab.last_result(job)["state"] == "running");
  lab.jobs.may_end = true;
  REQUIRE(lab.reaches(1, job, "finished"));
  CHECK(lab.last_result(job)["state"] == "finished");
}

TEST_CASE("what a job found can be had until its asker has had as many newer ones as are kept") {
  Lab lab;
  lab.jobs.may_end = true;
  const std::uint64_t oldest = lab.ask(1);
  REQUIRE(lab.reaches(1, oldest, "finished"));
  std::uint64_t newest = oldest;
  for (int i = 1; i < net::max_lab_outcomes_a_client; ++i)
    REQUIRE(lab.reaches(1, newest = lab.ask(1), "finished"));
  CHECK(std::get<net::SharedOutcome>(lab.queue.outcome(1, oldest)));
  REQUIRE(lab.reaches(1, newest = lab.ask(1), "finished"));
  CHECK(std::holds_alternative<net::RpcError>(lab.queue.outcome(1, oldest)));
  CHECK(std::get<net::SharedOutcome>(lab.queue.outcome(1, newest)));
}

TEST_CASE("a job that takes longer than any may is stopped and says so") {
  Lab lab;
  const std::uint64_t job = lab.ask(1);
  REQUIRE(lab.until([&] { return lab.jobs.started == 1; }));
  lab.queue.pump(now_us() + static_cast<std::int64_t>(net::max_lab_seconds * 1e6) + 1'000'000);
  REQUIRE(lab.reaches(1, job, "failed"));
  CHECK(lab.last_result(job)["error"]["found"].get<std::string>().find("it took more than") == 0);
}

TEST_CASE("a server that ends stops the job that runs and waits for it") {
  auto lab = std::make_unique<Lab>();
  lab->ask(1);
  REQUIRE(lab->until([&] { return lab->jobs.started == 1; }));
  const std::int64_t begun = now_us();
  lab->queue.stop();
  CHECK(lab->jobs.ended == 1);
  CHECK(now_us() - begun < 500'000);
}
