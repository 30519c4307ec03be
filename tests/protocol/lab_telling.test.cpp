// The messages of the lab to the clients that asked for jobs, and when they are sent.
#include "tests/protocol/lab_stage.h"

using namespace clothlab;
using namespace clothlab::test;

TEST_CASE("a job is stale while what it measures is not what the scene is: its looks do not count") {
  Lab lab;
  const std::uint64_t chart = lab.ask(1), simplify = lab.ask(2, lab::SimplifyRequest{});
  const auto stale = [&](std::uint64_t client) { return lab.queue.jobs(client)[0]["stale"].get<bool>(); };
  lab.queue.scene_changed("main", seed_with("/cloths/0/color=\"#123456\""));
  CHECK_FALSE(stale(1));
  CHECK_FALSE(stale(2));
  lab.queue.scene_changed("main", seed_with("/solver/dt=0.0005"));
  CHECK_FALSE(stale(1));  // a chart uses time steps of its own
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

TEST_CASE("a client whose job slows the session below 50 of 60 frames is told so once") {
  Lab lab;
  const std::uint64_t job = lab.ask(1);
  REQUIRE(lab.until([&] { return lab.jobs.started == 1; }));
  const auto notices = [&] {
    return std::count_if(lab.messages.begin(), lab.messages.end(),
                         [](const Message& message) { return message.method == "notice"; });
  };
  const auto reaches = [&](const char* session, double share, double seconds) {
    static std::int64_t now = now_us();
    for (int i = 0; i < 10 * seconds; ++i) lab.queue.speed_reported(session, share, now += 100'000);
  };
  reaches("main", 0.84, 10);
  reaches("other", 0.2, 10);
  reaches("main", 0.5, 1);  // too short to count
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
    "a result measured while nothing else ran answers the same request at once, unless a fresh one is "
    "wanted") {
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

TEST_CASE(
    "however much a job reports, its asker hears of it at most 5 and 2 times a second, and the end at once") {
  Lab lab;
  lab.jobs.talks = true;
  const std::uint64_t job = lab.ask(1);
  REQUIRE(lab.until([&] { return lab.jobs.started == 1; }));
  const std::int64_t begun = lab.now;
  const std::size_t before = lab.messages.size();
  for (std::int64_t time = 10'000; time <= 2'000'000; time += 10'000) {
    // At each of these times there is something new to send.
    for (const int seen = lab.jobs.reports; lab.jobs.reports < seen + 2;) std::this_thread::yield();
    lab.pump(begun + time);
  }
  const auto paced = [&](const char* method, std::int64_t period) {
    std::size_t count = 0;
    std::int64_t last = begun - 10 * period;
    for (std::size_t i = before; i < lab.messages.size(); ++i) {
      if (lab.messages[i].method != method) continue;
      CHECK(lab.messages[i].at - last >= period);
      last = lab.messages[i].at;
      ++count;
    }
    return count;
  };
  CHECK(paced("lab.progress", LabQueue::progress_period) >= 9);
  CHECK(paced("lab.result", LabQueue::result_period) >= 3);
  CHECK(lab.last_result(job)["state"] == "running");
  lab.jobs.may_end = true;
  REQUIRE(lab.reaches(1, job, "finished"));
  CHECK(lab.last_result(job)["state"] == "finished");
}

TEST_CASE("a job's result is kept until its client has had as many newer ones as the server keeps") {
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
