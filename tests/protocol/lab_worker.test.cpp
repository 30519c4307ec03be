// The threads beside the sessions' own, as the server sets them up.
#include <sys/resource.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <stop_token>
#include <string>
#include <thread>

#include "server/base/priority.h"
#include "server/gl/context.h"
#include "server/net/lab_worker.h"
#include "server/session/exporter.h"
#include "tests/catch.h"

using namespace clothlab;

namespace {

std::set<int> threads() {
  std::set<int> found;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/task"))
    found.insert(std::stoi(entry.path().filename().string()));
  return found;
}

/// Draws a picture like the exporter, on a thread that may end before its OpenGL's threads.
void draw() {
  Result<scene::Document> document = scene::load_preset("seed");
  REQUIRE(document);
  session::Moment moment;
  moment.positions.assign(625, glm::vec3(0.5f));
  moment.document = std::make_shared<const scene::Document>(std::move(*document));
  std::thread([&] {
    lower_priority(10);
    REQUIRE(session::make_export(std::nullopt, moment, {session::Export::Kind::picture, 64, 48}));
  }).join();
}

int niceness(int thread) {
  return getpriority(PRIO_PROCESS, static_cast<id_t>(thread));
}

/// Mesa's thread that writes its cache of shaders lowers its own priority, once it runs.
bool writes_shader_cache(int thread) {
  std::ifstream file("/proc/self/task/" + std::to_string(thread) + "/comm");
  std::string name;
  std::getline(file, name);
  return name.find("disk$") != std::string::npos;
}

}  // namespace

TEST_CASE("the lab's thread and those of its OpenGL have the lowest priority, the others keep theirs") {
  gl::compute_without_helper_threads();
  Result<std::unique_ptr<gl::Context>> session = gl::Context::create();
  REQUIRE(session);
  std::map<int, int> of_session;  // thread -> niceness
  for (const int thread : threads()) of_session[thread] = niceness(thread);
  draw();  // pictures share the lab's threads, and may be the first to need them
  for (const int side : {25, 128, 25, 128}) {  // the lab computes itself, then on helper threads
    Result<scene::Document> document = scene::load_preset("seed");
    REQUIRE(document);
    document->scene.cloths[0].mesh = scene::Grid{side, side, 1.0, 1.0};
    document->scene.cloths[0].pins.clear();
    std::thread([&] {
      const Result<net::LabWorker::Run> lab = net::open_lab(std::nullopt);
      REQUIRE(lab);
      std::stop_source stop;
      std::size_t added = 0;
      lab::Control<lab::Outcome> control;
      control.stop = stop.get_token();
      control.progress = [&](const lab::Progress&) {
        if (stop.stop_requested()) return;
        stop.request_stop();
        for (const int thread : threads()) {
          if (writes_shader_cache(thread)) continue;
          const auto known = of_session.find(thread);
          CHECK(niceness(thread) == (known == of_session.end() ? 19 : known->second));
          added += known == of_session.end() ? 1u : 0u;
        }
        CHECK(gl::computes_on_calling_thread() == (side == 25));
      };
      CHECK(!(*lab)(*document, lab::MapRequest{}, control));
      // Software OpenGL computes on threads besides the one that calls it.
      if ((*session)->device().software) CHECK(added > (side == 25 ? 0 : 1));
    }).join();
  }
}
