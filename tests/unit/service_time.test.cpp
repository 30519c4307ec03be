#include "server/net/service_time.h"

#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "tests/catch.h"

using namespace clothlab;
using net::ServicePool;
using net::ServiceShare;
using net::ServiceTime;

namespace {
constexpr std::int64_t second = 1'000'000, ms = 1000;  // [us]
constexpr ServiceShare own{5'000, 5'000}, of_address{100'000, 50'000}, of_all{200'000, 50'000};

/// Clients that always want more, each request taking `cost` [us], served in turn for this long. Returns the
/// time that each was served [us].
std::vector<std::int64_t> served(std::deque<ServiceTime>& clients, std::int64_t cost, std::int64_t until) {
  std::vector<std::int64_t> taken(clients.size());
  for (std::int64_t now = 0; now < until; now += ms)
    for (std::size_t i = 0; i < clients.size(); ++i)
      if (clients[i].wait(now) == 0) {
        clients[i].spend(now, cost);
        taken[i] += cost;
      }
  return taken;
}

std::int64_t sum(const std::vector<std::int64_t>& taken) {
  std::int64_t all = 0;
  for (const std::int64_t one : taken) all += one;
  return all;
}
}  // namespace

TEST_CASE("clients of one address take their own shares and the address's, however many requests they have") {
  ServicePool pool(of_address, of_all);
  std::deque<ServiceTime> clients;
  for (int i = 0; i < 31; ++i) clients.emplace_back(pool, own, "10.0.0.1", 0);
  const std::int64_t taken = sum(served(clients, 200, 10 * second));
  const std::int64_t most = 31 * (10 * 5 * ms + 5 * ms) + 10 * 100 * ms + 50 * ms;
  CHECK(taken <= most + 32 * 200);  // the last request of each may go beyond
  CHECK(taken >= most * 9 / 10);    // and what is there is given
}

TEST_CASE("many addresses together take no more than all may") {
  ServicePool pool(of_address, of_all);
  std::deque<ServiceTime> clients;
  for (int i = 0; i < 20; ++i) clients.emplace_back(pool, own, "10.0.0." + std::to_string(i), 0);
  CHECK(sum(served(clients, 200, 10 * second)) <=
        20 * (10 * 5 * ms + 5 * ms) + 10 * 200 * ms + 50 * ms + 21 * 200);
}

TEST_CASE(
    "a client that asks for little is served at once beside others of its address that take all they can") {
  ServicePool pool(of_address, of_all);
  std::deque<ServiceTime> greedy;
  for (int i = 0; i < 30; ++i) greedy.emplace_back(pool, own, "10.0.0.1", 0);
  ServiceTime modest(pool, own, "10.0.0.1", 0);
  for (std::int64_t now = 0; now < 5 * second; now += ms) {
    for (ServiceTime& one : greedy)
      if (one.wait(now) == 0) one.spend(now, 200);
    if (now % (16 * ms) != 0) continue;  // an acknowledgement for each of 60 frames a second, of 20 us
    REQUIRE(modest.wait(now) == 0);
    modest.spend(now, 20);
  }
}

TEST_CASE("who has taken too much waits as long as it takes to gain that back, and not longer") {
  ServicePool pool(of_address, of_all);
  ServiceTime one(pool, own, "10.0.0.1", 0), other(pool, own, "10.0.0.1", 0);
  one.spend(0, 5 * ms);    // its own share
  one.spend(0, 250 * ms);  // 50 ms are the address's, 200 ms a debt, which is gained back in 2 s
  one.spend(0, 1 * ms);
  const std::int64_t wait = one.wait(0);
  CHECK(wait > 0);
  CHECK(wait <= 300);  // its own share gives it something again
  CHECK(one.wait(wait) == 0);
  CHECK(other.wait(0) == 0);
  CHECK(pool.wait("10.0.0.1", 0) >= 2 * second);
  CHECK(pool.wait("10.0.0.2", 0) >= 1 * second);  // of all, 50 ms are there and 200 ms a second come
  CHECK(pool.wait("10.0.0.2", 1'100 * ms) == 0);
}

TEST_CASE("an address that has gained all back is forgotten, and starts as a new one does") {
  ServicePool pool(of_address, of_all);
  pool.spend("10.0.0.1", 0, 60 * ms);
  CHECK(pool.wait("10.0.0.1", 0) > 0);
  pool.spend("10.0.0.2", 10 * second, 1);
  CHECK(pool.wait("10.0.0.1", 10 * second) == 0);
}
