// The lab's queue: the order of jobs, who may ask for what, and how jobs end.
#include "tests/protocol/lab_stage.h"

using namespace clothlab;
using namespace clothlab::test;

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
  CHECK(lab.jobs.started == 1);  // the job that waited never ran
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
    lab.queue.held(job);  // the session may answer late
    lab.queue.pump(now_us());
    CHECK(lab.jobs.started == (cancel_held ? before : before + 1));
    CHECK(lab.releases == (cancel_held ? 2 : 1));
  }
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

TEST_CASE("a job that takes longer than any may is stopped and says so") {
  Lab lab;
  const std::uint64_t job = lab.ask(1);
  REQUIRE(lab.until([&] { return lab.jobs.started == 1; }));
  lab.queue.pump(now_us() + static_cast<std::int64_t>(net::Limits().lab_seconds * 1e6) + 1'000'000);
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

TEST_CASE("the method of a session with auto is chosen once, without messages to clients") {
  Lab lab;
  lab.choose_for("main", "/solver/tolerance=0.02");
  REQUIRE(lab.until([&] { return lab.jobs.started == 1; }));
  CHECK(lab.chosen.empty());
  lab.jobs.may_end = true;
  REQUIRE(lab.until([&] { return !lab.chosen.empty(); }));
  CHECK(lab.chosen[0].first == "main");
  REQUIRE(lab.chosen[0].second);
  CHECK(lab.chosen[0].second->tolerance == 0.02);
  CHECK(lab.messages.empty());
  // The same request is answered from the cache now.
  lab.choose_for("other", "/solver/tolerance=0.02");
  CHECK(lab.chosen.size() == 2);
  CHECK(lab.chosen.back().first == "other");
  CHECK(lab.jobs.started == 1);
}

TEST_CASE(
    "a choice for a session whose scene has changed since makes way for the next one, running or waiting") {
  for (const bool runs : {true, false}) {
    Lab lab;
    if (!runs) lab.ask(1);
    lab.choose_for("main", "/solver/tolerance=0.02");
    REQUIRE(lab.until([&] { return lab.jobs.started == 1; }));
    lab.choose_for("other", "/solver/tolerance=0.03");
    lab.choose_for("main", "/solver/tolerance=0.04");
    lab.jobs.may_end = true;
    REQUIRE(lab.until([&] { return lab.chosen.size() == 2; }));
    const auto tolerance = [&](std::size_t i) { return lab.chosen[i].second->tolerance; };
    CHECK(tolerance(0) == 0.03);
    CHECK(tolerance(1) == 0.04);
    CHECK(lab.chosen[1].first == "main");
    CHECK(lab.queue.gauges().cancelled == 1);
    CHECK(lab.queue.gauges().queued + lab.queue.gauges().running == 0);
  }
}

TEST_CASE("a session that is no more leaves no choice behind, but others' jobs") {
  Lab lab;
  lab.jobs.hands_over = true;
  lab.choose_for("main", "/solver/tolerance=0.02");
  const std::uint64_t job = lab.ask(1);
  REQUIRE(lab.until([&] { return lab.jobs.started == 1; }));
  lab.queue.session_left("main");
  REQUIRE(lab.reaches(1, job, "running"));
  CHECK(lab.jobs.ended == 1);
  lab.jobs.may_end = true;
  REQUIRE(lab.reaches(1, job, "finished"));
  CHECK(lab.chosen.empty());
}

TEST_CASE("a choice that fails is told to its session with the reason") {
  Lab lab;
  lab.jobs.throws = true;
  lab.choose_for("main", "/solver/tolerance=0.02");
  REQUIRE(lab.until([&] { return !lab.chosen.empty(); }));
  REQUIRE_FALSE(lab.chosen[0].second);
  CHECK(lab.chosen[0].second.error().what == "the job fell over");
}
