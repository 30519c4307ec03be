#include "server/session/helper_threads.h"

#include <mutex>
#include <thread>

#include "server/base/priority.h"

namespace clothlab::session {

namespace {

void make_once(std::once_flag& made, int nice, std::optional<int> gpu, gl::HelperThreads threads) {
  std::call_once(made, [&] {
    std::thread([&] {
      lower_priority(nice);
      (void)gl::Context::create(gpu, threads);
    }).join();
  });
}

}  // namespace

void make_helper_threads(std::optional<int> gpu, gl::HelperThreads threads) {
  static std::once_flag of_sessions, of_lab;
  if (threads == gl::HelperThreads::sessions) make_once(of_sessions, 5, gpu, threads);
  if (threads == gl::HelperThreads::lab) make_once(of_lab, 19, gpu, threads);
}

}  // namespace clothlab::session
