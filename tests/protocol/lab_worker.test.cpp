// The thread the lab measures on, as the server sets it up.
#include <sys/resource.h>
#include <unistd.h>

#include <filesystem>
#include <map>
#include <set>
#include <thread>

#include "server/gl/context.h"
#include "server/net/lab_worker.h"
#include "tests/catch.h"

using namespace clothlab;

namespace {

std::set<int> threads() {
  std::set<int> found;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/task"))
    found.insert(std::stoi(entry.path().filename().string()));
  return found;
}

int niceness(int thread) {
  return getpriority(PRIO_PROCESS, static_cast<id_t>(thread));
}

}  // namespace

TEST_CASE("the lab's thread and those of its OpenGL have the lowest priority, the sessions' keep theirs") {
  Result<std::unique_ptr<gl::Context>> session = gl::Context::create();
  REQUIRE(session);
  std::map<int, int> before;  // thread, niceness: Mesa has a thread of low priority itself
  for (const int thread : threads()) before[thread] = niceness(thread);
  std::thread([&] {
    const Result<net::LabWorker::Run> lab = net::open_lab(std::nullopt);
    REQUIRE(lab);
    std::size_t added = 0;
    for (const int thread : threads()) {
      const auto known = before.find(thread);
      CHECK(niceness(thread) == (known == before.end() ? 19 : known->second));
      added += known == before.end() ? 1u : 0u;
    }
    // Software OpenGL computes on threads besides the one that asks it to, and these are the lab's alone.
    if ((*session)->device().software) CHECK(added > 1);
  }).join();
}
